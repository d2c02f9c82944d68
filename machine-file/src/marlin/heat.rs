//! Heaters and fans.

use super::toml_of;
use super::work::Work;
use crate::translation::Kind;
use crate::translation::draft::rounded;
use corehbot::connectors::BoardConnectors;

/// Heaters, with their commands for PID and their words in M306.
const HEATERS: [(&str, &str, &str); 3] = [("hotend", "M301", ""), ("bed", "M304", "E-1 "), ("chamber", "M309", "E-2 ")];

/// Translates all heaters.
pub(super) fn heat(work: &mut Work<'_>, board: Option<&'static BoardConnectors>) {
    for (heater, pid, of_model) in HEATERS {
        let has_model = model(work, heater, of_model);
        let control = match (has_model, work.value(pid, "P")) {
            (true, _) => "model",
            (false, Some(_)) => "pid",
            (false, None) => continue,
        };
        let key = |leaf: &str| format!("heaters.{heater}.{leaf}");
        work.lines.set(&key("control"), control.into(), if has_model { "M306" } else { pid });
        let power = if has_model { "" } else { ", power" };
        let what = format!("true when output, sensor, thermistor{power} and most of {heater} are filled in");
        work.fill_in(&[(key("is_fitted"), false.into())], &what);
    }
    if board.is_none_or(|board| !board.fans.is_empty()) {
        work.open.push("fans.fan0.role and so on: which output cools the part, the hotend and the board".to_owned());
    }
}

/// Marlin's model of a heater (M306); returns whether there is one.
///
/// R is the rate at which the sensor follows its block, so its inverse is a lag; F is the loss with the fan, and A
/// without (`Temperature::get_pid_output_hotend` in `temperature.cpp`).
fn model(work: &mut Work<'_>, heater: &str, of: &str) -> bool {
    let mut words = ["P", "C", "A", "R", "L", "H", "F"].map(|word| work.number("M306", &format!("{of}{word}")));
    let is_said = words.iter().any(Option::is_some);
    let [power, capacity, loss, rate, lag, filament, with_fan] = &mut words;
    for (word, leaf) in
        [(&*power, "power"), (&*capacity, "model.capacity"), (&*loss, "model.loss"), (&*lag, "model.heater_lag")]
    {
        if let Some((entry, number)) = *word {
            work.take_number(entry, &format!("heaters.{heater}.{leaf}"), number);
        }
    }
    match *rate {
        Some((entry, rate)) if rate > 0.0 => {
            work.take_number(entry, &format!("heaters.{heater}.model.sensor_lag"), rounded(1.0 / rate));
            if lag.is_none() {
                work.say(entry, Kind::Approximated, "heater_lag is a lag of its own here: M303 finds both");
            }
        }
        Some((entry, _)) => work.say(entry, Kind::Decide, "no rate: run M303"),
        None => {}
    }
    if let (Some((entry, with_fan)), Some((_, loss))) = (*with_fan, *loss) {
        let path = format!("heaters.{heater}.model.fan_loss");
        work.take_number(entry, &path, rounded((with_fan - loss).max(0.0)));
    }
    if let Some((entry, heat)) = *filament {
        match work.lines.number("thermal.filament") {
            Some(first) if toml_of(first) == toml_of(heat) => work.say(entry, Kind::Taken, "thermal.filament"),
            _ => work.take_number(entry, "thermal.filament", heat),
        }
    }
    is_said
}
