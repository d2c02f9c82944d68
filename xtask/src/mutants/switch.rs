//! The switch of the mutants: which of them runs. `cargo xtask mutants` puts this file into its copy of the core.

extern crate std;

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use std::io::Write as _;

/// The number of the mutant that runs; larger ones are states.
static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
/// No mutant runs.
const OFF: u32 = u32::MAX / 2;
/// No mutant runs, and those that the program comes to are written to a file.
const RECORDS: u32 = u32::MAX - 2;
/// The variables of the environment are not read yet.
const UNREAD: u32 = u32::MAX - 1;

/// The mutants that the program has come to.
static REACHED: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];

/// The number of the change to make, of the changes from `first` on; `u32::MAX` leaves the code as it is. The compiler
/// never makes a change.
#[inline(always)]
pub const fn which(first: u32, count: u32) -> u32 {
    core::intrinsics::const_eval_select((first, count), none, ask)
}

const fn none(_: u32, _: u32) -> u32 {
    u32::MAX
}

#[inline]
fn ask(first: u32, count: u32) -> u32 {
    let active = ACTIVE.load(Relaxed);
    if active >= RECORDS {
        return record(first, count);
    }
    let change = active.wrapping_sub(first);
    if change < count { change } else { u32::MAX }
}

#[cold]
fn record(first: u32, count: u32) -> u32 {
    if ACTIVE.load(Relaxed) == UNREAD {
        let number = std::env::var("MUTANT").ok().and_then(|number| number.parse().ok());
        let active = if std::env::var_os("MUTANTS_REACHED").is_some() { RECORDS } else { number.unwrap_or(OFF) };
        ACTIVE.store(active, Relaxed);
        return ask(first, count);
    }
    let reached = &REACHED[first as usize];
    if !reached.load(Relaxed)
        && !reached.swap(true, Relaxed)
        && let Some(path) = std::env::var_os("MUTANTS_REACHED")
    {
        let mut file = std::fs::OpenOptions::new().append(true).create(true).open(path).unwrap();
        file.write_all(std::format!("{first}\n").as_bytes()).unwrap();
    }
    u32::MAX
}
