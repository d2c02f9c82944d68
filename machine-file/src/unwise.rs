//! Legal but doubtful values of a machine.

use super::Machine;
use corehbot::connectors::Heater;
use corehbot::kinematics::{Mechanism, direction};
use corehbot::motion::advance_window;
use corehbot::motors::Motor;
use corehbot::settings::{FanRole, HeaterModel, HeaterSettings, HomedAxis, Plausible, Settings};
use corehbot::units::Watts;
use corehbot_twin::math::square;
use std::collections::BTreeMap;

/// Current that a TMC2209 on a module bears without a fan, in mA (root mean square): 2 A at the peak of the sine. In
/// its switches of 170 mOhm each that is 1.4 W, on 15 x 20 mm. The 2 A (root mean square) of its datasheet (rev 1.09,
/// features) want a large board below it.
const MODULE_MA: u16 = 1414;

/// Steps a second of all motors together that the Octopus keeps up: docs/explanation/performance.md,
/// `octopus_sustained_motor_steps_per_s`.
const STEPS_A_SECOND: f64 = 1.8e6;

/// The currents of all fitted motors, each with its table: the motor's own, or its group's.
fn currents(s: &Settings) -> BTreeMap<String, u16> {
    let current = |motor: Motor| match s.drivers.own(motor).current_ma {
        0 => (s.driver_group(motor).1.to_owned(), s.driver_of(motor).current_ma),
        own => (format!("drivers.{}", s.name_of(motor)), own),
    };
    s.mechanism.fitted().iter().map(current).collect()
}

/// The warnings, each with the key that would change it.
pub(super) fn warnings(machine: &Machine) -> Vec<(String, String)> {
    let s = &machine.settings;
    let mut found = Vec::new();
    let mut warn = |key: &str, text: String| found.push((key.to_owned(), text));
    for (table, current) in currents(s) {
        if current > MODULE_MA {
            let key = format!("{table}.current_ma");
            let text = format!("{key} = {current}: above {MODULE_MA} mA a TMC2209 on a module needs a fan");
            warn(&key, text);
        }
    }
    if u64::from(s.patience_ms) >= (s.lookahead_time.to_num::<f64>() * 1000.0) as u64 {
        let text = format!(
            "patience_ms = {}: not below lookahead_time = {} s, so a line that is lost costs a stop",
            s.patience_ms, s.lookahead_time
        );
        warn("patience_ms", text);
    }
    let line = line_acceleration(s);
    if line < s.print_acceleration.to_num::<f64>() {
        let text = format!(
            "advance.time = {}: a line of 0.4 x 0.2 mm is accelerated at {line:.0} of print_acceleration = {} mm/s2, \
            for the \
             extruder has {} mm/s and {} mm/s2",
            s.advance.time, s.print_acceleration, s.axes.e.max_speed, s.axes.e.max_acceleration
        );
        warn("advance.time", text);
    }
    let steps = steps_a_second(s);
    if steps > STEPS_A_SECOND {
        let text = format!(
            "at full speed all motors together make {:.2} million steps/s; the Octopus keeps up {:.1} million",
            steps / 1e6,
            STEPS_A_SECOND / 1e6,
        );
        warn("axes.x.steps_per_mm", text);
    }
    for (axis, plug) in [("x", s.wiring.endstops.x), ("y", s.wiring.endstops.y), ("z", s.wiring.endstops.z)] {
        if plug.is_normally_open {
            let key = format!("endstops.{axis}");
            warn(&key, format!("{key}: a switch that closes when it is pressed is not noticed if its wire breaks"));
        }
    }
    let sides = [
        ("width", s.bed.left, s.bed.width, s.reach(HomedAxis::X), 'X'),
        ("depth", s.bed.front, s.bed.depth, s.reach(HomedAxis::Y), 'Y'),
    ];
    for (side, from, size, reach, axis) in sides {
        if from < reach.least || from + size > reach.most {
            let (key, to) = (format!("bed.{side}"), from + size);
            let text = format!(
                "{key} = {size}: the bed lies from {axis}{from} to {axis}{to}, and the tool reaches {axis}{} to \
                {axis}{}",
                reach.least, reach.most
            );
            warn(&key, text);
        }
    }
    for motor in s.mechanism.fitted().iter() {
        let (name, connector) = (s.name_of(motor), s.wiring.of(motor).connector);
        let key = format!("motors.{name}");
        if connector.is_none() {
            warn(&key, format!("motor {name} has no connector and will not turn"));
        }
        if machine.board.is_some_and(|board| board.debug_sockets.contains(&connector)) {
            let text = format!(
                "{key}: {connector} has a line of the debug port; while the board runs this machine, a debug probe \
                connects only under reset, and there is no log"
            );
            warn(&key, text);
        }
    }
    for heater in Heater::ALL {
        let HeaterSettings { is_fitted, power, model, .. } = *s.thermal.heater(heater);
        let plausible = Plausible::of(heater, power);
        for key in plausible.beyond(power, &model).filter(|_| is_fitted) {
            let (key, text) = implausible(heater, key, &plausible, power, &model);
            warn(&key, text);
        }
    }
    let [chamber, ..] = s.thermal.sensors;
    if chamber.is_fitted && s.thermal.heaters.chamber.is_fitted {
        let text = "the chamber's heater has a sensor of its own, which M105 reports; this one stays silent";
        warn("sensors.chamber.is_fitted", text.to_owned());
    }
    if let (Some(_), Some(motor), false) = (machine.board, s.mechanism.extruder(), s.thermal.heaters.hotend.is_fitted) {
        let text =
            format!("an extruder ({}) without a hotend: heating is ignored, and filament moves cold", s.name_of(motor));
        warn("heaters.hotend.is_fitted", text);
    }
    if s.thermal.heaters.hotend.is_fitted && !s.thermal.fans.iter().any(|fan| fan.role == FanRole::Hotend) {
        warn("heaters.hotend.is_fitted", "no fan has the role hotend, so nothing cools the cold end".to_owned());
    }
    if let Some(board) = machine.board {
        let shared = s.fan_frequencies(board);
        for (fan, plug) in s.fans.iter().enumerate().filter(|(_, plug)| plug.frequency > 0) {
            let timer = board.fans.get(fan).copied().flatten();
            let others: Vec<_> = (0..shared.len())
                .filter(|other| board.fans.get(*other).copied().flatten() == timer && s.fans[*other].frequency == 0)
                .map(|other| format!("fan{other}"))
                .collect();
            if timer.is_some() && !others.is_empty() {
                let key = format!("fans.fan{fan}.frequency");
                let text = format!(
                    "{} share the timer of fan{fan}, so they have its {} Hz",
                    others.join(", "),
                    plug.frequency
                );
                warn(&key, text);
            }
        }
    }
    found
}

/// The warning about a number of a heater's model that no such heater has.
fn implausible(
    heater: Heater,
    key: &str,
    plausible: &Plausible,
    power: Watts,
    model: &HeaterModel,
) -> (String, String) {
    let HeaterModel { capacity, loss, fan_loss, heater_lag, sensor_lag, ptc: _ } = *model;
    let whole = plausible.whole_loss(loss);
    let of = |least: f64, most: f64, unit: &str| format!("{} to {} {unit}", rounded(least), rounded(most));
    let (value, legal) = match key {
        "power" => (power.to_num(), of(plausible.power.least.to_num(), plausible.power.most.to_num(), "W")),
        "model.capacity" => {
            (capacity.to_num::<f64>(), of(plausible.capacity.least.to_num(), plausible.capacity.most.to_num(), "J/K"))
        }
        "model.loss" => (loss.to_num(), of(plausible.loss.least.to_num(), plausible.loss.most.to_num(), "W/K")),
        "model.fan_loss" => (fan_loss.to_num(), of(0.0, (whole.most - loss.min(whole.most)).to_num(), "W/K")),
        "model.heater_lag" => (heater_lag.to_num(), of(plausible.lag.least.to_num(), plausible.lag.most.to_num(), "s")),
        _ => (sensor_lag.to_num(), of(plausible.lag.least.to_num(), plausible.lag.most.to_num(), "s")),
    };
    let name = heater.name();
    let path = format!("heaters.{name}.{key}");
    let watts = if key == "power" { String::new() } else { format!(" of {} W", rounded(power.to_num())) };
    let text = format!("{path} = {}: a {name}{watts} has {legal}; M303 finds out what it is", rounded(value));
    (path, text)
}

/// Three digits, as far as there are any.
fn rounded(value: f64) -> f64 {
    let digits = if value.abs() >= 100.0 { 1.0 } else { 1000.0 };
    (value * digits).round() / digits
}

/// The greatest acceleration in mm/s2 for the extruder with its pressure advance, in a line of 0.4 x 0.2 mm from
/// filament of 1.75 mm (docs/explanation/shaping.md#what-the-extruder-bears).
fn line_acceleration(s: &Settings) -> f64 {
    let ratio = 0.4 * 0.2 / (square(1.75) * std::f64::consts::FRAC_PI_4);
    let (time, window): (f64, f64) = (s.advance.time.to_num(), advance_window(s).to_num());
    let (speed, acceleration): (f64, f64) = (s.axes.e.max_speed.to_num(), s.axes.e.max_acceleration.to_num());
    let by_speed = 0.75 * speed / (time * ratio);
    by_speed.min(acceleration / (ratio * (1.0 + 2.0 * time / window)))
}

/// The most steps of all motors in a second, along any axis or diagonal, with the extruder at its own limit.
fn steps_a_second(s: &Settings) -> f64 {
    let Mechanism { rows } = s.mechanism;
    let resolution = Motor::ALL.map(|motor| s.steps_per_mm(motor).to_num::<f64>());
    let [x, y, z, e] = [s.axes.x, s.axes.y, s.axes.z, s.axes.e].map(|axis| axis.max_speed.to_num::<f64>());
    let ways = || [-1.0, 0.0, 1.0].into_iter();
    let mut most: f64 = 0.0;
    for v in ways().flat_map(|a| ways().flat_map(move |b| ways().map(move |c| [a * x, b * y, c * z]))) {
        let turns =
            rows.map(|row| direction(row).iter().zip(v).map(|(times, v)| f64::from(*times) * v).sum::<f64>().abs());
        let xy = rows.iter().zip(turns).filter(|(row, _)| row[0] != 0 || row[1] != 0).map(|(_, v)| v);
        // A belt motor has a limit of its own, and the whole move is slowed to it.
        let slowed = (s.motor_max_speed.to_num::<f64>() / xy.fold(0.0, f64::max)).min(1.0);
        most = most.max(turns.iter().zip(resolution).map(|(v, steps)| v * steps * slowed).sum());
    }
    let extruders = rows.iter().zip(resolution).filter(|(row, _)| row[3] != 0).map(|(_, steps)| e * steps);
    most + extruders.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    fn keys(text: &str) -> Vec<String> {
        warnings(&parse(text).unwrap()).into_iter().map(|(key, _)| key).collect()
    }

    #[test]
    fn the_prototype_is_wise() {
        assert_eq!(keys(""), [""; 0]);
        assert_eq!(keys("board = \"octopus\"\n[heaters.hotend]\nis_fitted = true"), [""; 0]);
    }

    #[test]
    fn an_advance_that_slows_lines_down_is_told() {
        assert_eq!(keys("[advance]\ntime = 0.6"), [""; 0]);
        assert_eq!(keys("[advance]\ntime = 0.9"), ["advance.time"]);
        let text = &warnings(&parse("print_acceleration = 5000\n[advance]\ntime = 0.9").unwrap())[0].1;
        assert!(text.contains("at 2004 of print_acceleration = 5000 mm/s2"), "{text}");
    }

    #[test]
    fn too_much_current_is_told_of_drivers_that_there_are() {
        assert_eq!(keys("[drivers.z]\ncurrent_ma = 1415\n[drivers.e]\ncurrent_ma = 1414"), ["drivers.z.current_ma"]);
        // Each motor by its own current.
        assert_eq!(keys("[drivers.z]\ncurrent_ma = 1415\n[drivers.z1]\ncurrent_ma = 900"), ["drivers.z.current_ma"]);
        assert_eq!(keys("[drivers.z1]\ncurrent_ma = 1415"), ["drivers.z1.current_ma"]);
        let both = "[drivers.z]\ncurrent_ma = 1415\n[drivers.z1]\ncurrent_ma = 900\n[drivers.z2]\ncurrent_ma = 800";
        assert_eq!(keys(both), [""; 0], "no motor has the group's");
    }

    #[test]
    fn a_bed_that_the_tool_does_not_reach_is_told() {
        assert_eq!(keys("[bed]\nleft = -1\nwidth = 390"), ["bed.width"]);
        assert_eq!(keys("[bed]\nfront = 0.5"), ["bed.depth"]);
        assert_eq!(keys("[axes.x]\nlength = 300\n[bed]\nwidth = 301\ndepth = 500"), ["bed.width", "bed.depth"]);
        assert_eq!(keys("[bed]\nleft = 5\nwidth = 385"), [""; 0]);
        let wide = "[axes.x]\nmin = -60\nlength = 290\n[bed]\n";
        assert_eq!(keys(wide), [""; 0], "the reach");
        assert_eq!(keys(&format!("{wide}left = -60\nwidth = 290")), [""; 0]);
        assert_eq!(keys(&format!("{wide}left = 0\nwidth = 231")), ["bed.width"]);
    }

    #[test]
    fn a_model_that_no_such_heater_has_is_told() {
        let hotend = |rest: &str| format!("[heaters.hotend]\nis_fitted = true\n{rest}");
        let capacity = hotend("[heaters.hotend.model]\ncapacity = 200");
        assert_eq!(keys(&capacity), ["heaters.hotend.model.capacity"]);
        let told = warnings(&parse(&capacity).unwrap()).remove(0).1;
        assert!(told.contains("= 200: a hotend of 40 W has 1 to 66.6"), "{told}");
        assert!(keys(&hotend("power = 1")).contains(&"heaters.hotend.power".into()));
        assert_eq!(keys(&capacity.replace("true", "false")), [""; 0], "there is none");
        assert_eq!(
            keys("[heaters.bed]\nis_fitted = true\npower = 220\n[heaters.bed.model]\ncapacity = 5500\nloss = 2"),
            [""; 0]
        );
    }

    #[test]
    fn the_prototype_makes_steps_as_by_hand() {
        // Four belt motors along x or y make 4 x 300 x 80, more than the two of a diagonal at 450; z and e add to that.
        let by_hand = 4.0 * 300.0 * 80.0 + 2.0 * 20.0 * 800.0 + 80.0 * 400.0;
        let s = Settings::prototype();
        assert!((steps_a_second(&s) - by_hand).abs() < 1.0, "{} {by_hand}", steps_a_second(&s));
    }

    #[test]
    fn too_many_steps_are_told() {
        let axis = "{ steps_per_mm = 1600 }";
        let fast = format!("motor_max_speed = 300\n[axes]\nx = {axis}\ny = {axis}");
        assert_eq!(keys(&fast), ["axes.x.steps_per_mm"]);
    }

    #[test]
    fn switches_that_close_motors_without_a_socket_and_a_hotend_without_a_fan_are_told() {
        assert_eq!(keys("[endstops]\ny = \"!Y-STOP\""), ["endstops.y"]);
        assert_eq!(keys("board = \"nucleo\""), ["motors.z1", "motors.z2", "motors.e0", "heaters.hotend.is_fitted"]);
        let hot = "[heaters.hotend]\nis_fitted = true\n";
        let last = format!("{hot}[motors]\ne0 = \"M7\"");
        let last = last.as_str();
        assert_eq!((keys(&format!("board = \"octopus\"\n{last}")), keys(last)), (vec!["motors.e0".into()], vec![]));
        let hot = "[heaters.hotend]\nis_fitted = true\n[fans.fan1]\nrole = \"commanded\"";
        assert_eq!(keys(hot), ["heaters.hotend.is_fitted"]);
    }
}
