//! Plain settings: the numbers that rows of `crate::settings` have a letter for. [`rules`](super::rules) has the rules
//! of some codes.

use super::plain_words::PlainWords;
use super::rules::{Ending, Rule};
use crate::gcode::{Number, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::use_home_offsets;
use crate::machine::ports::PortSet;
use crate::machine::reports::setting::Setting;
use crate::machine::reports::settings_report::report_setting;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::states::{States, tell_clamps};
use crate::port::Wake;
use crate::settings::Settings;
use crate::settings::plain::{Owner, condition};
use crate::settings::rows::Value;

/// M113: the time between two busy messages.
const KEEPALIVE: u16 = 113;

/// All values of a line if each is legal, otherwise none; without values a report.
pub(in crate::machine) async fn set_plain<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let States { modal, clamps, notices, .. } = states;
    let words = &PlainWords::read(command);
    let (owner, rule) = (condition(words.code).owner, Rule::of(words.code));
    if let Some(line) = (rule.refuses)(&main_loop.settings) {
        return Ok(Answer::Line(line));
    }
    if owner != Owner::Motors {
        // The open line ends, whether values are legal or not.
        main_loop.live_settings();
    }
    if words.numbers.iter().all(Option::is_none) {
        let code = words.code;
        main_loop.tell(|to, facts| match code {
            // Marlin's words, which are no line of M503 (M113.cpp).
            KEEPALIVE => to.say(text!("echo:M113 S{}", facts.settings.keepalive_s)),
            code => report_setting(to, Setting::Plain(code), facts.settings),
        });
        return Ok(Answer::Said);
    }
    let Some(mut wanted) = with_values(&main_loop.settings, words, &rule, modal, clamps) else {
        return Ok(Answer::Nothing);
    };
    match (rule.ends)(words, &mut wanted, notices) {
        Ending::Done => {}
        Ending::Remark(remark) => main_loop.say(text!("{remark}")),
        Ending::Refusal(refusal) => {
            tell_clamps(main_loop, clamps);
            main_loop.say(text!("{refusal}"));
            return Ok(Answer::Said);
        }
    }
    match owner {
        Owner::Readers => main_loop.live_settings().set_plain(&wanted),
        Owner::Origins => use_home_offsets(main_loop, wanted.home_offsets()),
        Owner::Heaters => *main_loop.heat_settings() = wanted.thermal,
        // In a replay of M503 nothing rests for the offset that it has.
        Owner::Probe if wanted.probe.offset == main_loop.settings.probe.offset => {}
        Owner::Motors | Owner::Probe => {
            main_loop.finish().await?;
            main_loop.use_settings(&wanted).await?;
        }
    }
    Ok(Answer::Nothing)
}

/// The settings with the values of a line, if each is legal.
fn with_values(
    now: &Settings,
    words: &PlainWords,
    rule: &Rule,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Option<Settings> {
    let (mut wanted, mut are_taken) = (*now, true);
    (rule.begins)(words, &mut wanted, modal, clamps);
    wanted.visit_code(words.code, &mut |word, field| {
        let Some(Some(number)) = words.numbers.get(word.place) else { return };
        let old = if let Value::Number(old) = field.get() { Some(old) } else { None };
        let part = usize::from(word.key.part);
        let legal = (rule.legal)(now, part, word.key.row.legal(part));
        let is_zero = *number == Number::ZERO && legal.holds(0);
        let value = if is_zero { Some(0) } else { clamps.setting(modal, word, *number, legal, old) };
        are_taken &= value.is_some_and(|bits| field.set(&Value::Number(bits)));
    });
    (are_taken && !clamps.refuses_line()).then_some(wanted)
}
