//! The board answers: firmware, machine, and a fault from before.

use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;
use crate::config::machine_said;

const OTHER: Failure = Failure {
    what: "another firmware answers.",
    cure: "flash the image of this project (docs/tutorial/first-flash.md), or name another port.",
};
const NO_MACHINE: Failure =
    Failure { what: "the board has no machine.", cure: "corehbot config send M.toml PORT, then reset the board." };
const DIFFERS: Failure = Failure {
    what: "it was built otherwise than the board's.",
    cure: "corehbot config send M.toml PORT, then reset the board and do this step again.",
};
const FAULT: Failure = Failure {
    what: "is from before this session.",
    cure: "read what it names; docs/reference/errors.md has its cure. A reset forgets it.",
};

pub(super) const FAILURES: &[&Failure] = &[&OTHER, &NO_MACHINE, &DIFFERS, &FAULT];

/// A failure without which nothing can go on.
fn fatal(failure: &Failure, part: &str) -> StepError {
    let problem = failure.of(part);
    StepError::Unfit(format!("{} Cure: {}", problem.what, problem.cure))
}

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    // A line that another program has begun ends here.
    guide.board.drain(&guide.owner)?;
    let heard = match guide.ask("M115") {
        // It was starting, and has not heard the question: a bootloader takes a second or two.
        Err(StepError::Restarted(_)) => {
            guide.board.drain(&guide.owner)?;
            guide.ask("M115")?
        }
        heard => heard?,
    };
    let name = heard.iter().find_map(|line| line.strip_prefix("FIRMWARE_NAME:"));
    let build = name.filter(|name| name.starts_with("CoreH-bot"));
    let build = build.ok_or_else(|| fatal(&OTHER, name.unwrap_or("M115")))?;
    guide.build = build.split(" SOURCE_CODE_URL").next().unwrap_or(build).to_owned();
    let heard = guide.ask("MACHINE_GET")?;
    guide.machine = machine_said(&heard).map_err(|error| fatal(&NO_MACHINE, &format!("{error:#}")))?;
    let machine = &guide.machine;
    let motors: Vec<_> = machine.mechanism.fitted().iter().map(|motor| machine.name_of(motor).to_string()).collect();
    found.note(format!("firmware {}", guide.build));
    found.note(format!("machine {}, motors {}", machine.name, motors.join(" ")));
    let heaters: Vec<_> = guide.heaters().into_iter().map(corehbot::connectors::Heater::name).collect();
    found.note(if heaters.is_empty() { "no heaters".to_owned() } else { format!("heaters {}", heaters.join(" ")) });
    if guide.file.is_some_and(|file| !file.is_built_as(&guide.machine)) {
        found.problems.push(DIFFERS.of("the machine of the file"));
    }
    let heard = guide.ask("M122")?;
    let fault = heard.iter().find_map(|line| line.strip_prefix("echo:fault: ")).filter(|fault| *fault != "none");
    if let Some(fault) = fault {
        found.problems.push(FAULT.of(fault));
    }
    Ok(found)
}
