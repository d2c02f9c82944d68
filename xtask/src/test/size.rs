//! Checks the images against the budgets of `build/contents.rs` and `build/step_path.rs`, and for forbidden contents.

use crate::build;
use crate::verdict::Verdict;
use anyhow::Result;

/// Weighs and examines every image that the step before has built.
pub fn check() -> Result<Verdict> {
    Ok(Verdict::Passed(build::examine_all()?))
}
