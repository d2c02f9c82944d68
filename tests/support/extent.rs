//! How much of a long test runs: a part that finds the same, or all of it by `cargo xtask test --all`.

/// Whether all of it runs.
pub fn is_all() -> bool {
    std::env::var_os("COREHBOT_ALL").is_some()
}
