//! The result of a step of `cargo xtask test`.

use std::time::Duration;

/// The result of a step. A step that cannot even be carried out is an error, which counts as one failure.
pub enum Verdict {
    /// All is well.
    Passed(String),
    /// Numbers of passed and failed tests.
    Tested { passed: u32, failed: u32, remark: String, times: Times },
    /// It could not be done here, and why.
    Skipped(String),
}

/// Names of tests, and the processors' time that each took; empty if it was not looked at.
pub type Times = Vec<(String, Duration)>;
