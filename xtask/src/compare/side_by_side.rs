//! Work done side by side, by as many threads as CI has processors.

use anyhow::Result;
use std::sync::{Mutex, PoisonError};

const PARALLEL: usize = 2;

/// Does all `work`, the last of it first, and names the failures. `each` does one piece and returns its name, for the
/// message about a failure.
pub fn all<T: Send>(
    work: Vec<T>,
    name: impl Fn(&T) -> String + Sync,
    each: impl Fn(&T) -> Result<()> + Sync,
) -> Vec<String> {
    let queue = Mutex::new(work);
    let failures = Mutex::new(Vec::new());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).pop();
    std::thread::scope(|scope| {
        for _ in 0..PARALLEL {
            scope.spawn(|| {
                while let Some(piece) = next() {
                    if let Err(error) = each(&piece) {
                        println!("{}: FAILED: {error:#}", name(&piece));
                        failures.lock().unwrap_or_else(PoisonError::into_inner).push(name(&piece));
                    }
                }
            });
        }
    });
    failures.into_inner().unwrap_or_else(PoisonError::into_inner)
}
