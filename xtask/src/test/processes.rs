//! Tests of this computer, each in a process of its own. The emulator maps and unmaps memory all the time, for which the
//! threads of one process wait for each other: they take a fifth more.

use super::{Verdict, side_by_side};
use anyhow::{Context as _, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// How test programs are run.
struct Setting<'a> {
    folder: &'a Path,
    variables: &'a [(&'static str, PathBuf)],
}

impl Setting<'_> {
    fn call(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.folder).envs(self.variables.iter().map(|(name, value)| (name, value)));
        command
    }
}

/// One test.
struct Test {
    program: PathBuf,
    name: String,
}

/// Builds the tests that a call of cargo names, which has `--no-run` in it, and runs them in `folder` with these
/// variables of the environment.
pub fn run(mut build: Command, folder: &Path, variables: &[(&'static str, PathBuf)]) -> Result<Verdict> {
    let setting = Setting { folder, variables };
    let output = build.arg("--message-format=json").stdout(Stdio::piped()).stderr(Stdio::inherit()).output()?;
    ensure!(output.status.success(), "the tests do not build");
    let mut tests = Vec::new();
    for program in programs(&String::from_utf8_lossy(&output.stdout))? {
        tests.extend(tests_of(&program, &setting)?);
    }
    ensure!(!tests.is_empty(), "there are no tests");
    // In the same order each time, by name.
    tests.sort_by(|a, b| b.name.cmp(&a.name));
    let all = u32::try_from(tests.len())?;
    let failures = side_by_side::all(tests, |test| test.name.clone(), |test| one(test, &setting));
    let failed = u32::try_from(failures.len())?;
    let passed = all - failed;
    Ok(Verdict::Tested { passed, failed, remark: format!("{passed} tests passed, {failed} failed") })
}

/// The test programs among what cargo says that it has made.
fn programs(messages: &str) -> Result<Vec<PathBuf>> {
    let mut programs = Vec::new();
    for line in messages.lines() {
        let message: serde_json::Value = serde_json::from_str(line).with_context(|| format!("cargo says: {line}"))?;
        if message["profile"]["test"] == true
            && let Some(program) = message["executable"].as_str()
        {
            programs.push(PathBuf::from(program));
        }
    }
    Ok(programs)
}

fn tests_of(program: &Path, setting: &Setting) -> Result<Vec<Test>> {
    let output = setting.call(program).args(["--list", "--format", "terse"]).output()?;
    ensure!(output.status.success(), "{} cannot list its tests", program.display());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let names = text.lines().filter_map(|line| line.strip_suffix(": test"));
    Ok(names.map(|name| Test { program: program.to_owned(), name: name.to_owned() }).collect())
}

fn one(test: &Test, setting: &Setting) -> Result<()> {
    let output = setting.call(&test.program).arg("--exact").arg(&test.name).output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    // A name that is no test's passes too.
    if output.status.success() && text.contains("test result: ok. 1 passed") {
        println!("test {} ... ok", test.name);
        Ok(())
    } else {
        bail!("{}{}", text, String::from_utf8_lossy(&output.stderr))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_programs_are_distinguished_from_what_else_is_built() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","profile":{"test":true},"executable":"/t/lib-1"}"#,
            "\n",
            r#"{"reason":"compiler-artifact","profile":{"test":false},"executable":"/t/corehbot"}"#,
            "\n",
            r#"{"reason":"compiler-artifact","profile":{"test":true},"executable":null}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#,
        );
        assert_eq!(programs(messages).unwrap(), [PathBuf::from("/t/lib-1")]);
        assert!(programs("warning").is_err());
    }
}
