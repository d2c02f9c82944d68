//! The tests that take most of the processors' time.
//!
//! The stable test harness tells no times. It runs each test in a thread of the test's name, of which Linux keeps 15
//! bytes, and says when the test has ended. So a thread of that name that has gone by then was the test. Threads that a
//! test begins get its 15 bytes too, and count for it, and so do the programs that it begins. Threads that outlive it,
//! as rayon's do, have a line of their own. Two tests of the same 15 bytes that end between two looks count as one.

use crate::processor;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two looks at the threads. What a test takes after the last look at it is lost.
const LOOK: Duration = Duration::from_millis(50);

/// The bytes of a thread's name that Linux keeps (`TASK_COMM_LEN` without the zero at its end).
const KEPT: usize = 15;

/// The running threads, by process and thread.
type Threads = BTreeMap<(u32, u32), Thread>;

/// A thread's name, as Linux keeps it, and the time that it has taken; or that a program of its has taken.
#[derive(Clone)]
struct Thread {
    name: String,
    taken: Duration,
}

/// The threads of test programs, and what the harness said.
#[derive(Default)]
pub struct Slowest {
    running: Threads,
    /// They have ended, and no test has yet.
    gone: Vec<Thread>,
    /// Tests that have ended since the last look. Those before had not lost their threads by then.
    ended: Vec<String>,
    ended_before: Vec<String>,
    tests: BTreeMap<String, Duration>,
}

impl Slowest {
    /// Takes a line of the harness.
    pub fn hear(&mut self, line: &str) {
        let name = line.strip_prefix("test ").and_then(|rest| rest.split_once(" ... "));
        self.ended.extend(name.map(|(name, _)| name.trim_end_matches(" - should panic").to_owned()));
    }

    /// Takes all threads as they are now.
    fn see(&mut self, threads: Threads) {
        let before = std::mem::replace(&mut self.running, threads);
        self.gone.extend(before.into_iter().filter(|(id, _)| !self.running.contains_key(id)).map(|(_, thread)| thread));
        let ended = std::mem::take(&mut self.ended);
        for test in ended.iter().chain(&self.ended_before) {
            let is_its = |thread: &Thread| thread.name == kept(test);
            let taken: Duration = self.gone.iter().filter(|thread| is_its(thread)).map(|thread| thread.taken).sum();
            self.gone.retain(|thread| !is_its(thread));
            *self.tests.entry(test.clone()).or_default() += taken;
        }
        self.ended_before = ended;
    }

    /// The tests and their time, the slowest first, and the sums of threads that no test waited for.
    pub fn list(mut self) -> Vec<(String, Duration)> {
        self.see(Threads::new());
        let names: BTreeSet<_> = self.tests.keys().map(|test| kept(test)).collect();
        let mut others = BTreeMap::<String, Duration>::new();
        for thread in self.gone.into_iter().filter(|thread| names.contains(&thread.name)) {
            *others.entry(format!("threads that outlived {}...", thread.name)).or_default() += thread.taken;
        }
        let mut all: Vec<_> = self.tests.into_iter().chain(others).collect();
        all.sort_by_key(|(_, taken)| std::cmp::Reverse(*taken));
        all
    }
}

/// A thread's name as Linux has it.
fn kept(name: &str) -> String {
    String::from_utf8_lossy(name.as_bytes().get(..KEPT).unwrap_or(name.as_bytes())).into_owned()
}

/// Looks at the threads of the programs that a cargo runs, until it has ended.
pub fn watch(cargo: u32, slowest: &Mutex<Slowest>, has_ended: &AtomicBool) {
    let mut programs = Vec::new();
    while !has_ended.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
        let mut threads: Threads = programs.iter().flat_map(|program| threads_of(*program)).collect();
        if threads.is_empty() {
            programs = children_of(cargo);
            threads = programs.iter().flat_map(|program| threads_of(*program)).collect();
        }
        slowest.lock().unwrap_or_else(PoisonError::into_inner).see(threads);
    }
}

/// The processes that a process has begun; none on systems without `/proc`.
fn children_of(parent: u32) -> Vec<u32> {
    let is_child = |id: &u32| {
        let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        processor::fields(&stat).and_then(|mut fields| fields.next()) == Some(f64::from(parent))
    };
    numbers("/proc").into_iter().filter(is_child).collect()
}

/// The threads of a process besides its first, and the programs that they have begun, with their names and their time.
fn threads_of(process: u32) -> Vec<((u32, u32), Thread)> {
    let folder = format!("/proc/{process}/task");
    let thread = |id: u32| {
        let stat = fs::read_to_string(format!("{folder}/{id}/stat")).ok()?;
        let name = stat.split_once('(')?.1.rsplit_once(')')?.0.to_owned();
        let programs = fs::read_to_string(format!("{folder}/{id}/children")).unwrap_or_default();
        let program = |program: u32| {
            Some(((process, program), Thread { name: name.clone(), taken: processor::of_process(program)? }))
        };
        let mut all: Vec<_> = programs.split_whitespace().flat_map(str::parse).filter_map(program).collect();
        all.push(((process, id), Thread { taken: processor::of_thread(&stat)?, name }));
        Some(all)
    };
    numbers(&folder).into_iter().filter(|id| *id != process).filter_map(thread).flatten().collect()
}

/// The names in a folder that are numbers.
fn numbers(folder: &str) -> Vec<u32> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::process::{Command, Stdio};

    fn threads(list: &[(u32, &str, u64)]) -> Threads {
        let thread = |name: &str, seconds| Thread { name: kept(name), taken: Duration::from_secs(seconds) };
        list.iter().map(|(id, name, seconds)| ((1, *id), thread(name, *seconds))).collect()
    }

    fn listed(slowest: Slowest) -> Vec<(String, u64)> {
        slowest.list().into_iter().map(|(name, taken)| (name, taken.as_secs())).collect()
    }

    #[test]
    fn a_test_has_the_time_of_the_thread_that_went_with_it() {
        let mut slowest = Slowest::default();
        slowest.see(threads(&[(1, "belt::phases::a_long_one", 3), (2, "belt::phases::another", 4), (3, "rustc", 9)]));
        slowest.see(threads(&[(2, "belt::phases::another", 5)]));
        slowest.hear("test belt::phases::a_long_one ... ok");
        slowest.see(threads(&[(2, "belt::phases::another", 6)]));
        slowest.hear("test belt::phases::another - should panic ... ok");
        slowest.hear("test result: ok. 2 passed; 0 failed");
        let expected = [("belt::phases::another", 6), ("belt::phases::a_long_one", 3)];
        assert_eq!(listed(slowest), expected.map(|(name, seconds)| (name.to_owned(), seconds)));
    }

    /// The harness may say that a test has ended before its thread has.
    #[test]
    fn a_thread_that_ends_after_its_test_counts_for_it() {
        let mut slowest = Slowest::default();
        slowest.see(threads(&[(1, "heat::f10", 3)]));
        slowest.hear("test heat::f10 ... ok");
        slowest.see(threads(&[(1, "heat::f10", 3)]));
        assert_eq!(listed(slowest), [("heat::f10".to_owned(), 3)]);
    }

    #[test]
    fn threads_that_no_test_waited_for_are_named_apart() {
        let mut slowest = Slowest::default();
        slowest.see(threads(&[(1, "heat_lives::a_day", 1), (2, "heat_lives::a_day", 50)]));
        slowest.hear("test heat_lives::a_day ... ok");
        slowest.see(threads(&[(2, "heat_lives::a_day", 60)]));
        slowest.see(threads(&[(2, "heat_lives::a_day", 70)]));
        slowest.see(threads(&[]));
        let expected = [("threads that outlived heat_lives::a_d...", 70), ("heat_lives::a_day", 1)];
        assert_eq!(listed(slowest), expected.map(|(name, seconds)| (name.to_owned(), seconds)));
    }

    #[test]
    fn times_of_a_thread_and_of_its_program_are_read_from_the_system() {
        let (this, folder) = (std::process::id(), Path::new("/proc/self/task"));
        if folder.exists() {
            let name = kept(std::thread::current().name().unwrap_or_default());
            let mut program = Command::new("cat").stdin(Stdio::piped()).spawn().unwrap();
            let threads = threads_of(this);
            program.kill().unwrap();
            program.wait().unwrap();
            let of_this: Vec<_> = threads.iter().filter(|(_, thread)| thread.name == name).collect();
            assert!(of_this.len() >= 2 && of_this.iter().any(|((_, id), _)| *id == program.id()));
        }
    }
}
