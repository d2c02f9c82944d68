//! The steps that are calls of cargo.

use super::slowest::{self, Slowest};
use crate::checkout::{self, cargo, run, words};
use crate::emulate::{self, WITH_PROCESSOR};
use crate::images;
use crate::page;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// The package of the emulator.
const EMULATOR: &str = "corehbot-emulator";

/// Formatting.
pub fn format() -> Result<Verdict> {
    run(cargo(["fmt", "--all", "--check"]))?;
    let mut binder = page::cargo_of_binder("fmt");
    binder.arg("--check");
    run(binder)?;
    Ok(Verdict::Passed(String::new()))
}

/// Lints, for this computer.
pub fn lint() -> Result<Verdict> {
    let mut check = cargo(["check", "--workspace", "--all-targets"]);
    check.args(WITH_PROCESSOR);
    run(lint_in_build(check))?;
    run(lint_in_build(page::build_binder()?))?;
    Ok(Verdict::Passed(String::new()))
}

/// The page, which has everything below the command inside, as WebAssembly.
pub fn build_page() -> Result<Verdict> {
    page::write(None)?;
    Ok(Verdict::Passed(String::new()))
}

/// Documentation, of the crates as they are linted: without the lints, cargo would check them once more for it.
pub fn document() -> Result<Verdict> {
    let mut command = lint_in_build(cargo(["doc", "--no-deps", "--workspace", "--exclude", EMULATOR]));
    command.env("RUSTDOCFLAGS", "-D warnings");
    run(command)?;
    Ok(Verdict::Passed(String::new()))
}

/// Core and boards, linted and built. A board that needed an allocator would not link, because there is none.
pub fn build_boards() -> Result<Verdict> {
    let boards = images::boards()?;
    let mut lint = images::for_boards("clippy")?;
    lint.args(["--package", "corehbot"]);
    boards.iter().for_each(|board| _ = lint.args(["--package", board]));
    lint.args(["--", "-D", "warnings"]);
    let lint = run(lint);
    // Each by itself, as it is released: together they would be built of crates with the features of all.
    let builds: Vec<_> = boards.iter().map(|board| images::build_image(board)).collect();
    lint?;
    builds.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(Verdict::Passed(boards.join(", ")))
}

/// The programs and tests for this computer.
pub fn build() -> Result<Verdict> {
    let mut tests = cargo(["test", "--workspace", "--no-run"]);
    tests.args(WITH_PROCESSOR);
    run(tests)?;
    checkout::build_command()?;
    Ok(Verdict::Passed(String::new()))
}

/// Tests on this computer, except the emulator's.
pub fn test() -> Result<Verdict> {
    count_tests(cargo(["test", "--workspace", "--exclude", EMULATOR, "--no-fail-fast"]))
}

/// Lints what is built: does what `cargo clippy` does (its `CLIPPY_ARGS`, each ended by that word).
fn lint_in_build(mut build: Command) -> Command {
    build.env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver");
    build.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__");
    build
}

/// The tests of the emulator, which run the images of the Octopus and of the Nucleo.
pub fn emulate() -> Result<Verdict> {
    let mut tests = emulate::cargo(["test"], &["--no-fail-fast"]);
    tests.env("COREHBOT_ELF", images::build_image(emulate::Board::Octopus.package())?);
    tests.env("COREHBOT_NUCLEO_ELF", images::build_image(emulate::Board::Nucleo.package())?);
    count_tests(tests)
}

/// Runs tests; their results are counted while they scroll by, and their time is looked at.
fn count_tests(mut command: Command) -> Result<Verdict> {
    let mut process = command.stdout(Stdio::piped()).spawn().context("cannot run cargo")?;
    let (slowest, has_ended) = (Mutex::new(Slowest::default()), AtomicBool::new(false));
    let (mut passed, mut failed) = (0, 0);
    let cargo = process.id();
    std::thread::scope(|scope| {
        scope.spawn(|| slowest::watch(cargo, &slowest, &has_ended));
        let lines = process.stdout.take().into_iter().flat_map(|stdout| BufReader::new(stdout).lines());
        let heard = lines.map_while(|line| {
            let line = line.ok()?;
            println!("{line}");
            passed += count(&line, "passed");
            failed += count(&line, "failed");
            slowest.lock().unwrap_or_else(PoisonError::into_inner).hear(&line);
            Some(())
        });
        heard.for_each(drop);
        has_ended.store(true, Ordering::Relaxed);
    });
    let status = process.wait()?;
    if !status.success() && failed == 0 {
        bail!("{}: {status}", words(&command));
    }
    let times = slowest.into_inner().unwrap_or_else(PoisonError::into_inner).list();
    Ok(Verdict::Tested { passed, failed, remark: format!("{passed} tests passed, {failed} failed"), times })
}

/// The number before `word` in a result line of the test harness.
fn count(line: &str, word: &str) -> u32 {
    let Some(result) = line.trim().strip_prefix("test result:") else {
        return 0;
    };
    let part = result.split([';', '.']).map(str::trim).find_map(|part| part.strip_suffix(word));
    part.and_then(|number| number.trim().parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkout::root;
    use std::collections::BTreeSet;

    /// The packages behind `cargo` for these arguments, with their features.
    fn features(packages: &[&str]) -> BTreeSet<String> {
        let mut tree = cargo(["tree", "--offline", "--prefix", "none", "--format", "{p} {f}"]);
        let output = tree.args(packages).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(|line| line.trim_end_matches(" (*)").replace(" (proc-macro)", "")).collect()
    }

    /// With other features the core, the simulator and the twin would be built more than once: for `cargo xtask`, for
    /// the tests and for the emulator, 4 minutes each on two cores.
    #[test]
    fn all_that_is_called_is_built_of_the_same_crates() {
        let whole = ["--workspace", "--edges", "normal,build,dev"];
        let all = features(&[&whole, &WITH_PROCESSOR[..1]].concat());
        let [xtask, command, emulator] = ["xtask", "corehbot-cli", EMULATOR].map(|name| format!("--package={name}"));
        let programs = "--edges=normal,build";
        // A plain `cargo test`, in the words of the workspace's manifest.
        let by_default = ["corehbot", "corehbot-cli", "corehbot-machine-file", "corehbot-report"];
        let by_default = by_default.map(|name| format!("--package={name}"));
        for built in [
            by_default.iter().map(String::as_str).chain(["--edges=normal,build,dev"]).collect(),
            vec![xtask.as_str(), programs],
            vec![xtask.as_str(), &command, programs],
            vec![emulator.as_str(), WITH_PROCESSOR[0], programs],
            vec![emulator.as_str(), WITH_PROCESSOR[0], "--edges=normal,build,dev"],
            [&whole[..], &["--exclude", EMULATOR]].concat(),
        ] {
            let lone: Vec<_> = features(&built).difference(&all).cloned().collect();
            assert!(lone.is_empty(), "{built:?}: the manifest needs a line for each: {lone:#?}");
        }
    }

    /// So a user's `cargo test --workspace` shares its crates too.
    #[test]
    fn without_the_processor_all_else_is_the_same() {
        let whole = ["--workspace", "--edges", "normal,build,dev"];
        let lone = &features(&whole) - &features(&[&whole, &WITH_PROCESSOR[..1]].concat());
        assert!(lone.iter().all(|crate_| crate_.starts_with(EMULATOR)), "{lone:#?}");
    }

    /// Otherwise `cargo xtask` and cargo by hand would build ring, and all that needs it, in turns.
    #[test]
    fn cargo_hears_nothing_of_this_programs_package() {
        assert!(std::env::var_os("CARGO_MANIFEST_DIR").is_some());
        let command = cargo(["build"]);
        let removed: BTreeSet<_> =
            command.get_envs().filter(|(_, value)| value.is_none()).map(|(name, _)| name).collect();
        assert!(
            ["CARGO_MANIFEST_DIR", "CARGO_PKG_NAME"].iter().all(|name| removed.contains(std::ffi::OsStr::new(name)))
        );
    }

    /// So all calls of it get the same treatment.
    #[test]
    fn cargo_is_called_in_one_place() {
        let mut folders = vec![root().join("xtask/src")];
        let mut callers = BTreeSet::new();
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if std::fs::read_to_string(&path).is_ok_and(|text| text.contains("\"cargo\"")) {
                    callers.insert(path.strip_prefix(root()).unwrap().to_owned());
                }
            }
        }
        assert_eq!(callers, BTreeSet::from(["xtask/src/checkout.rs".into()]));
    }

    #[test]
    fn the_harness_says_how_many_passed() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s";
        assert_eq!((count(line, "passed"), count(line, "failed")), (12, 3));
        assert_eq!(count("running 4 passed tests", "passed"), 0);
    }
}
