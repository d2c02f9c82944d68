//! The exchanges of `tests/protocol` on the board in QEMU; the simulator has them among its own tests.

use super::demand;
use crate::checkout::root;
use crate::images;
use crate::processor;
use crate::qemu::{BOARD, Job};
use crate::tools::{has_emulator, lack_of_emulator};
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::script::{Script, scripts};
use std::path::Path;

/// How patient the board is with a silent host, in ms of its own time. While it waits, that is some seconds of ours.
const PATIENCE_MS: u16 = 60;

/// Follows each script on a board that has just been switched on.
pub fn check() -> Result<Verdict> {
    if !has_emulator() {
        return Ok(Verdict::Skipped(lack_of_emulator()));
    }
    let image = images::build_image(BOARD)?;
    let mut passed = 0;
    let (mut failures, mut times) = (Vec::new(), Vec::new());
    for (name, text) in scripts(&root().join("tests/protocol")).context("cannot read the exchanges")? {
        let (followed, taken) = processor::timed(|| follow(&image, &text));
        times.push((format!("{name} in QEMU"), taken));
        match followed {
            Ok(()) => passed += 1,
            Err(error) => {
                println!("{name}: FAILED: {error:#}");
                failures.push(name);
            }
        }
    }
    let (demand, taken) = processor::timed(|| demand::check(&image));
    times.push(("the demand of a print in QEMU".to_owned(), taken));
    let demand = match demand {
        Ok(words) => {
            passed += 1;
            words
        }
        Err(error) => {
            println!("the demand of a print: FAILED: {error:#}");
            failures.push("the demand of a print".to_owned());
            String::new()
        }
    };
    let failed = u32::try_from(failures.len())?;
    let remark = if failed > 0 { format!("fail: {}", failures.join(", ")) } else { format!("exchanges; {demand}") };
    Ok(Verdict::Tested { passed, failed, remark, times })
}

fn follow(image: &Path, text: &str) -> Result<()> {
    let mut script = Script::new(text).map_err(anyhow::Error::msg)?;
    let settings = Settings::prototype();
    let job = Job { gcode: String::new(), settings, start: Some([Mm::ZERO; 3]), mesh: None, patience_ms: PATIENCE_MS };
    let end = job.converse(image, &mut script);
    match script.failure() {
        Some(failure) => bail!("{failure}"),
        None => end,
    }
}
