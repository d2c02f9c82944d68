//! M306: the model of a heater; with T it is tuned.
//!
//! A heater is controlled by its model or by PID. The model is the default; M301 or M304 with a gain selects PID
//! (`setup::rules`), and M306 with a number selects the model again. M503 says the one in use last
//! (`reports::heat_settings_report`).

use super::heater_settings::heater_of;
use super::heating::model_of;
use super::tuning::{TuningWords, tune};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::connectors::Heater;
use crate::gcode::Grammar;
use crate::machine::apart::apart;
use crate::machine::numbers::rate;
use crate::machine::reports::heat_settings_report::report_model;
use crate::machine::state::clamps::Clamps;
use crate::settings::{Control, Plausible, Range, ranges};
use crate::units::{Ratio, Seconds};
use core::pin::pin;

/// The letters of its numbers.
const NUMBERS: &[u8] = b"PCAFRLHK";

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[306])
    .works_if(|command| command.has(b'T'))
    .grammar(&Grammar::numbers(b"EPCAFRLHK"))
    .does("E P C A F R L H K", "model of a heater; T tunes; or reports")
    .examples(&[
        ("M306", &["echo:no heaters configured, ignored"]),
        ("M306 E-1 A3", &["echo:no heaters configured, ignored"]),
        ("M306 E5", &["echo:line ignored: E is 0 (hotend), -1 (bed) or -2 (chamber)"]),
    ]);

/// The reciprocal of the shortest legal time constant, in 1/s.
const FASTEST: Ratio = Ratio::const_from_int(10);

/// F is the whole loss with the part fan at full speed, as in Marlin. The legal range depends on the kind of heater and
/// on its power, which the same line may set. Without E it is the hotend's, and says so.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let heater = heater_of(command);
    if command.has(b'T') {
        let words = TuningWords { heater, target: None, cycles: None, applies: true };
        return apart(pin!(tune(main_loop, clamps, &words))).await;
    }
    Ok(set_model(main_loop, clamps, heater, command))
}

/// Sets what the words say of the model, or reports it.
fn set_model<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    heater: Option<Heater>,
    command: &TableCommand<'_>,
) -> Answer<'static> {
    let heater = match model_of(&main_loop.settings.thermal, heater) {
        Ok(heater) => heater,
        Err(line) => return Answer::Line(line),
    };
    // The open line ends, whether values are legal or not.
    main_loop.heat_settings();
    if NUMBERS.iter().all(|letter| command.number(*letter).is_none()) {
        main_loop.tell(|to, facts| report_model(to, heater, &facts.settings.thermal));
        return Answer::Said;
    }
    let mut wanted = main_loop.settings.thermal;
    let settings = wanted.heater_mut(heater);
    if let Some(number) = command.number(b'P') {
        clamps.near(["M306", "P"], number, Plausible::of(heater, settings.power).power, &mut settings.power);
    }
    let plausible = Plausible::of(heater, settings.power);
    let model = &mut settings.model;
    if let Some(number) = command.number(b'C') {
        clamps.near(["M306", "C"], number, plausible.capacity, &mut model.capacity);
    }
    if let Some(number) = command.number(b'A') {
        clamps.near(["M306", "A"], number, plausible.loss, &mut model.loss);
    }
    if let Some(number) = command.number(b'F') {
        let mut whole = model.loss.saturating_add(model.fan_loss);
        clamps.near(["M306", "F"], number, plausible.whole_loss(model.loss), &mut whole);
        model.fan_loss = whole.saturating_sub(model.loss);
    }
    if let Some(number) = command.number(b'R') {
        let old = rate(model.sensor_lag);
        let rates = Range { least: rate(plausible.lag.most), most: FASTEST };
        if let Some(rate) = clamps.near_of(["M306", "R"], number, rates, Some(old)) {
            model.sensor_lag = plausible.lag.clamp(reciprocal(rate));
        }
    }
    if let Some(number) = command.number(b'L') {
        clamps.near(["M306", "L"], number, plausible.lag, &mut model.heater_lag);
    }
    if let Some(number) = command.number(b'K') {
        clamps.near(["M306", "K"], number, ranges::PTC, &mut model.ptc);
    }
    // A new power alone may leave the other numbers outside their ranges.
    let is_plausible = plausible.beyond(settings.power, model).next().is_none();
    settings.control = Control::Model;
    if let Some(number) = command.number(b'H') {
        clamps.near(["M306", "H"], number, ranges::FILAMENT, &mut wanted.filament);
    }
    if clamps.refuses_line() {
        return Answer::Nothing;
    }
    if !is_plausible {
        return Answer::Line(packed!(
            "echo:M306 ignored: this model does not fit this power, set P, C, A, F, R and L in one line"
        ));
    }
    *main_loop.heat_settings() = wanted;
    main_loop.heat.baselines().forget(heater);
    if command.has(b'E') {
        Answer::Nothing
    } else {
        Answer::Line(packed!("echo:M306 without E is the hotend's (E0); E-1 is the bed, E-2 the chamber"))
    }
}

/// The time constant of a rate in 1/s.
fn reciprocal(rate: Ratio) -> Seconds {
    Seconds::from_bits(((1u64 << 40) / u64::from(rate.to_bits().max(1))).min(u64::from(u32::MAX)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_and_its_rate_read_back() {
        for ms in [20, 100, 1200, 5000, 20_000, 200_000] {
            let shown = rate(Seconds::from_num(f64::from(ms) / 1000.0));
            assert_eq!(rate(reciprocal(shown)), shown, "{ms}");
        }
    }
}
