//! A trial: tests run with a mutant until one of them fails.
//!
//! First each test runs without a mutant, and says which mutants it comes to. Only these can change its result.

use crate::mutants::copy::Mutant;
use anyhow::{Context as _, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// A test may take this many times the time that it takes without a mutant.
const PATIENCE: u32 = 5;

/// A test that takes longer is not tried with each mutant.
const LONGEST: Duration = Duration::from_millis(300);

/// KiB of memory that a test may take. A mutant may fill a list for ever.
const MEMORY: u32 = 4 << 20;

/// A program of tests.
pub struct Program {
    pub path: PathBuf,
    /// The folder that it runs in.
    pub folder: PathBuf,
    /// Begins of the names of its tests.
    pub wanted: Vec<String>,
}

/// A test that passes without a mutant.
pub struct Test<'p> {
    program: &'p Program,
    name: String,
    time: Duration,
    /// The sites that it comes to, by the numbers of their first mutants.
    sites: BTreeSet<u32>,
}

impl Program {
    /// The names of its tests.
    fn tests(&self) -> Result<Vec<String>> {
        let listed = Command::new(&self.path).args(["--list", "--format=terse"]).current_dir(&self.folder).output();
        let listed = listed.with_context(|| format!("cannot run {}", self.path.display()))?;
        let text = String::from_utf8_lossy(&listed.stdout);
        let names = text.lines().filter_map(|line| line.strip_suffix(": test"));
        let is_wanted = |name: &&str| self.wanted.iter().any(|begin| name.starts_with(begin));
        Ok(names.filter(is_wanted).map(str::to_owned).collect())
    }

    /// A command in a shell that runs a test with limits: the shell's last step gets the program as `"$0" "$@"`.
    fn command(&self, test: &str, most: Duration, step: &str) -> Command {
        let script = format!("ulimit -t {}; ulimit -v {MEMORY}; ulimit -c 0; {step}", most.as_secs() + 1);
        let mut command = Command::new("sh");
        command.args(["-c", &script]).arg(&self.path).args(["--exact", test, "--test-threads=1"]);
        command.current_dir(&self.folder);
        // The same cases in each run; a case that fails is neither made simpler nor written down.
        command.env("PROPTEST_RNG_SEED", "1").env("PROPTEST_MAX_SHRINK_ITERS", "0");
        command.env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// The processor's time that a test takes without a mutant, if it passes, and the sites that it comes to.
    fn first_run(&self, test: &str, path: &Path) -> Result<Option<(Duration, BTreeSet<u32>)>> {
        let step = "\"$0\" \"$@\" >/dev/null || exit 1; times";
        let mut command = self.command(test, LONGEST, step);
        let ran = command.env("MUTANTS_REACHED", path).stdout(Stdio::piped()).output().context("cannot run sh")?;
        let reached = std::fs::read_to_string(path).unwrap_or_default();
        _ = std::fs::remove_file(path);
        if !ran.status.success() {
            return Ok(None);
        }
        let time = time(&String::from_utf8_lossy(&ran.stdout)).context("sh tells no times")?;
        Ok(Some((time, reached.lines().filter_map(|line| line.parse().ok()).collect())))
    }

    /// Whether a test passes with a mutant.
    fn passes(&self, test: &str, mutant: u32, most: Duration) -> Result<bool> {
        let mut command = self.command(test, most, "exec \"$0\" \"$@\"");
        let mut process = command.env("MUTANT", mutant.to_string()).spawn().context("cannot run sh")?;
        let start = Instant::now();
        let mut pause = Duration::from_micros(200);
        loop {
            if let Some(status) = process.try_wait()? {
                return Ok(status.success());
            }
            // A test that waits for ever takes no time of the processor.
            if start.elapsed() > PATIENCE * (most + Duration::from_secs(10)) {
                process.kill()?;
                _ = process.wait()?;
                return Ok(false);
            }
            std::thread::sleep(pause);
            pause = (pause * 5 / 4).min(Duration::from_millis(20));
        }
    }
}

/// Runs each test without a mutant. The second list has tests that fail in the copy, or take too long.
pub fn tests<'p>(programs: &'p [Program], folder: &Path, jobs: usize) -> Result<(Vec<Test<'p>>, Vec<String>)> {
    let mut all = Vec::new();
    for program in programs {
        all.extend(program.tests()?.into_iter().map(|name| (program, name)));
    }
    let found = parallel(jobs, &all, |number, (program, name)| {
        program.first_run(name, &folder.join(format!("reached-{number}")))
    })?;
    let mut tests = Vec::new();
    let mut others = Vec::new();
    for ((program, name), run) in all.into_iter().zip(found) {
        match run {
            Some((_, sites)) if sites.is_empty() => {}
            Some((time, sites)) if time <= LONGEST => tests.push(Test { program, name, time, sites }),
            _ => others.push(name),
        }
    }
    Ok((tests, others))
}

/// The time of finished processes as `times` of a shell tells it, in a second line: `0m0.012s 0m0.004s`.
fn time(told: &str) -> Option<Duration> {
    let seconds = |word: &str| {
        let (minutes, seconds) = word.strip_suffix('s')?.split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    let words: Option<Vec<f64>> = told.lines().nth(1)?.split_whitespace().map(seconds).collect();
    Some(Duration::from_secs_f64(words?.iter().sum()))
}

/// The mutants that no test notices.
pub fn survivors<'m>(mutants: &'m [Mutant], tests: &[Test<'_>], jobs: usize) -> Result<Vec<&'m Mutant>> {
    // How many mutants of a file each test has noticed: the next mutant there is likely to be noticed by the same test.
    let noticed = Mutex::new(BTreeMap::<(&str, usize), u32>::new());
    let survives = parallel(jobs, mutants, |_, mutant| {
        let file = mutant.name.split(':').next().unwrap_or_default();
        let mut left: Vec<_> = (0..tests.len()).filter(|&test| tests[test].sites.contains(&mutant.site)).collect();
        {
            let noticed = noticed.lock().unwrap_or_else(|broken| broken.into_inner());
            let cost = |test: &usize| tests[*test].time / (1 + noticed.get(&(file, *test)).copied().unwrap_or(0));
            left.sort_by_key(cost);
        }
        for test in left {
            let Test { program, name, time, .. } = &tests[test];
            if !program.passes(name, mutant.number, *time * PATIENCE)? {
                let mut noticed = noticed.lock().unwrap_or_else(|broken| broken.into_inner());
                *noticed.entry((file, test)).or_default() += 1;
                return Ok(false);
            }
        }
        eprintln!("  survives: {}", mutant.name);
        Ok(true)
    })?;
    Ok(mutants.iter().zip(survives).filter(|(_, survives)| *survives).map(|(mutant, _)| mutant).collect())
}

/// Does the same with each item, in so many threads, and tells how far it is.
fn parallel<'i, I: Sync, O: Send>(
    jobs: usize,
    items: &'i [I],
    work: impl Fn(usize, &'i I) -> Result<O> + Sync,
) -> Result<Vec<O>> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let number = next.fetch_add(1, Relaxed);
            let Some(item) = items.get(number) else { return Ok(done) };
            if number.is_multiple_of(200) {
                eprintln!("  {number} of {}", items.len());
            }
            done.push((number, work(number, item)?));
        }
    };
    let lists = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|_| anyhow::bail!("a thread has panicked")))
            .collect::<Result<Vec<Vec<(usize, O)>>>>()
    })?;
    let mut all: Vec<_> = lists.into_iter().flatten().collect();
    all.sort_by_key(|(number, _)| *number);
    Ok(all.into_iter().map(|(_, output)| output).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_tells_the_time_of_what_it_ran() {
        assert_eq!(time("0m0.002s 0m0.001s\n1m0.250s 0m0.500s\n"), Some(Duration::from_millis(60_750)));
        assert_eq!(time("0m0.002s 0m0.001s\n"), None);
    }
}
