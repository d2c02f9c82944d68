//! Work done side by side, by as many threads as CI has processors.

use crate::verdict::Times;
use anyhow::Result;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

const PARALLEL: usize = 2;

/// Does all `work`, the last of it first. Returns the names of failures, and the processors' time of the other pieces,
/// which `each` says of one.
pub fn all<T: Send>(
    work: Vec<T>,
    name: impl Fn(&T) -> String + Sync,
    each: impl Fn(&T) -> Result<Duration> + Sync,
) -> (Vec<String>, Times) {
    let queue = Mutex::new(work);
    let (failures, times) = (Mutex::new(Vec::new()), Mutex::new(Times::new()));
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).pop();
    std::thread::scope(|scope| {
        for _ in 0..PARALLEL {
            scope.spawn(|| {
                while let Some(piece) = next() {
                    match each(&piece) {
                        Ok(taken) => times.lock().unwrap_or_else(PoisonError::into_inner).push((name(&piece), taken)),
                        Err(error) => {
                            println!("{}: FAILED: {error:#}", name(&piece));
                            failures.lock().unwrap_or_else(PoisonError::into_inner).push(name(&piece));
                        }
                    }
                }
            });
        }
    });
    let times = times.into_inner().unwrap_or_else(PoisonError::into_inner);
    (failures.into_inner().unwrap_or_else(PoisonError::into_inner), times)
}
