//! A machine as a machine file: what [`parse`](super::parse) reads back to the bit.

use super::quantity::{self as q, Kind};
use corehbot::connectors::ConnectorName;
use corehbot::motors::Motor;
use corehbot::settings::{
    AxisSettings, Belt, Control, CornerRule, DriverSettings, Endstop, FanRole, FanSettings, HeaterSettings, Homing,
    Settings, Shaper, ShaperKind, Thermistor,
};
use corehbot::units::{Celsius, Mm};
use fixed::traits::Fixed;
use toml::{Table, Value};

/// Decimals that are tried for the shortest number; a value has at most 32 bits after the point.
const MOST_DECIMALS: usize = 12;

/// The text of a machine file, with every key.
///
/// # Errors
/// If the text cannot be made, which no value of [`Settings`] brings about.
pub fn written(machine: &Settings) -> anyhow::Result<String> {
    let s = machine;
    let mut file = Table::new();
    file.insert("name".into(), s.name.as_str().into());
    let numbers = [
        ("motor_max_speed", number(s.motor_max_speed, &q::SPEED)),
        ("motor_max_acceleration", number(s.motor_max_acceleration, &q::ACCELERATION)),
        ("print_acceleration", number(s.print_acceleration, &q::ACCELERATION)),
        ("retract_acceleration", number(s.retract_acceleration, &q::ACCELERATION)),
        ("travel_acceleration", number(s.travel_acceleration, &q::ACCELERATION)),
        ("minimum_cruise_ratio", number(s.minimum_cruise_ratio, &q::CRUISE_RATIO)),
        ("extruder_jerk", number(s.extruder_jerk, &q::SPEED)),
        ("min_feed", number(s.min_feed, &q::LEAST_SPEED)),
        ("min_travel", number(s.min_travel, &q::LEAST_SPEED)),
        ("soft_endstops", s.soft_endstops.into()),
        ("require_homing", s.require_homing.into()),
        ("arc_tolerance", number(s.arc_tolerance, &q::TOLERANCE)),
        ("keepalive_s", whole(s.keepalive_s)),
        ("patience_ms", whole(s.patience_ms)),
        ("lookahead_time", number(s.lookahead_time, &q::LOOKAHEAD_TIME)),
        ("advanced_ok", s.advanced_ok.into()),
        ("baud", whole(s.baud)),
    ];
    file.extend(numbers.map(|(key, value)| (key.to_owned(), value)));
    file.insert("mechanism".into(), mechanism(s));
    let motors = Motor::ALL.into_iter().zip(s.wiring.motors);
    let motors = motors.map(|(motor, plug)| (motor.name().to_owned(), connector(plug.connector, plug.is_reversed)));
    file.insert("motors".into(), Value::Table(motors.collect()));
    let switches = &s.wiring.endstops;
    let switches = [("x", switches.x), ("y", switches.y), ("z", switches.z), ("probe", s.probe)];
    file.insert(
        "endstops".into(),
        table(switches.map(|(key, plug)| (key, connector(plug.connector, plug.is_normally_open)))),
    );
    file.insert("corner".into(), corner(s.corner));
    file.insert("shaper".into(), table([("x", shaper(&s.shapers.x)), ("y", shaper(&s.shapers.y))]));
    let window = s.advance.window.map_or_else(|| "auto".into(), |window| number(window, &q::ADVANCE_WINDOW));
    file.insert("advance".into(), table([("time", number(s.advance.time, &q::ADVANCE)), ("window", window)]));
    let a = &s.axes;
    file.insert("axes".into(), table([("x", axis(&a.x)), ("y", axis(&a.y)), ("z", axis(&a.z)), ("e", axis(&a.e))]));
    let b = &s.bed;
    file.insert(
        "bed".into(),
        table([
            ("width", number(b.width, &q::AXIS_LENGTH)),
            ("depth", number(b.depth, &q::AXIS_LENGTH)),
            ("left", number(b.left, &q::BED_EDGE)),
            ("front", number(b.front, &q::BED_EDGE)),
        ]),
    );
    let b = &s.belt;
    let phases = b.phases.iter().take_while(|phase| **phase < Belt::NO_PHASE).map(|phase| whole(*phase)).collect();
    file.insert(
        "belt".into(),
        table([
            ("closed", b.is_closed.into()),
            ("settling", whole(b.settling_ms)),
            ("max_speed", number(b.max_speed, &q::SPEED)),
            ("max_acceleration", number(b.max_acceleration, &q::ACCELERATION)),
            ("homing_advance", number(b.homing_advance, &q::HOMING_ADVANCE)),
            ("alignment", b.alignment.name().into()),
            ("preload", number(b.preload, &q::PRELOAD)),
            ("phases", Value::Array(phases)),
            ("limp_lift", number(b.limp_lift, &q::LIMP_LIFT)),
        ]),
    );
    let p = &s.pause;
    file.insert(
        "pause".into(),
        table([
            ("retract", number(p.retract, &q::PAUSE_RETRACT)),
            ("retract_speed", number(p.retract_speed, &q::SPEED)),
            ("unretract_speed", number(p.unretract_speed, &q::SPEED)),
            ("lift", number(p.lift, &q::PAUSE_LIFT)),
            ("park", p.park.into()),
            ("x", number(p.x, &q::BED_EDGE)),
            ("y", number(p.y, &q::BED_EDGE)),
            ("travel_speed", number(p.travel_speed, &q::SPEED)),
            ("heat_off_min", whole(p.heat_off_min)),
        ]),
    );
    file.insert("homing".into(), homing(s));
    let d = &s.drivers;
    file.insert("drivers".into(), table([("belt", driver(&d.belt)), ("z", driver(&d.z)), ("e", driver(&d.e))]));
    let t = &s.thermal;
    file.insert(
        "thermal".into(),
        table([
            ("min_extrude", number(t.min_extrude, &q::MIN_EXTRUDE)),
            ("hotend_fan_above", number(t.hotend_fan_above, &q::COLD_END)),
            ("fan_run_on_s", whole(t.fan_run_on_s)),
            ("idle_min", whole(t.idle_min)),
            ("filament", number(t.filament, &q::FILAMENT)),
        ]),
    );
    let heaters = [
        ("hotend", heater(&t.heaters.hotend, &q::HOTEND)),
        ("bed", heater(&t.heaters.bed, &q::BED)),
        ("chamber", heater(&t.heaters.chamber, &q::BED)),
    ];
    file.insert("heaters".into(), table(heaters));
    let fans = t.fans.iter().enumerate().map(|(number, settings)| (format!("fan{number}"), fan(settings)));
    file.insert("fans".into(), Value::Table(fans.collect()));
    Ok(toml::to_string(&file)?)
}

fn table<const N: usize>(entries: [(&str, Value); N]) -> Value {
    Value::Table(entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

fn whole(number: impl Into<i64>) -> Value {
    Value::Integer(number.into())
}

/// The shortest number that is read as this value.
fn number<T: Fixed>(value: T, kind: &Kind<T>) -> Value {
    let exact: f64 = value.to_num();
    let rounded = (0..=MOST_DECIMALS).filter_map(|decimals| format!("{exact:.decimals$}").parse::<f64>().ok());
    let shortest = rounded.into_iter().find(|number| (kind.convert)(*number) == value).unwrap_or(exact);
    if shortest.fract() == 0.0 { Value::Integer(shortest as i64) } else { Value::Float(shortest) }
}

/// The rows of the motors that are fitted.
fn mechanism(s: &Settings) -> Value {
    let fitted = s.mechanism.fitted();
    let rows = Motor::ALL.into_iter().zip(s.mechanism.rows).filter(|(motor, _)| fitted.has(*motor));
    Value::Table(rows.map(|(motor, row)| (motor.name().to_owned(), Value::Array(row.map(whole).to_vec()))).collect())
}

fn connector(name: ConnectorName, is_other_way: bool) -> Value {
    format!("{}{name}", if is_other_way { "!" } else { "" }).into()
}

fn corner(rule: CornerRule) -> Value {
    match rule {
        CornerRule::JunctionDeviation(d) => table([("junction_deviation", number(d, &q::TOLERANCE))]),
        CornerRule::SquareCorner(v) => table([("square_corner", number(v, &q::SPEED))]),
    }
}

fn shaper(s: &Shaper) -> Value {
    let kind = match s.kind {
        ShaperKind::None => "none",
        ShaperKind::Zv => "zv",
        ShaperKind::Zvd => "zvd",
        ShaperKind::Mzv => "mzv",
        ShaperKind::Ei => "ei",
        ShaperKind::TwoHumpEi => "2hump_ei",
    };
    table([
        ("kind", kind.into()),
        ("frequency", number(s.frequency, &q::FREQUENCY)),
        ("damping", number(s.damping, &q::DAMPING)),
        ("span", number(s.span, &q::BELT_SPAN)),
        ("motor_frequency", number(s.motor_frequency, &q::MOTOR_FREQUENCY)),
    ])
}

fn axis(a: &AxisSettings) -> Value {
    table([
        ("steps_per_mm", number(a.steps_per_mm, &q::RESOLUTION)),
        ("max_speed", number(a.max_speed, &q::SPEED)),
        ("max_acceleration", number(a.max_acceleration, &q::ACCELERATION)),
        ("length", number(a.length, &q::AXIS_LENGTH)),
    ])
}

fn homing(s: &Settings) -> Value {
    let order = s.homing_order.map(|axis| axis.letter().to_ascii_lowercase().to_string().into());
    let (h, e) = (&s.homing, &s.endstops);
    table([
        ("order", Value::Array(order.to_vec())),
        ("x", homed_axis(&h.x, e.x, s.axes.x.length)),
        ("y", homed_axis(&h.y, e.y, s.axes.y.length)),
        ("z", homed_axis(&h.z, e.z, s.axes.z.length)),
    ])
}

fn homed_axis(h: &Homing, endstop: Endstop, length: Mm) -> Value {
    table([
        ("fast", number(h.fast, &q::SPEED)),
        ("slow", number(h.slow, &q::SPEED)),
        ("back_off", number(h.back_off, &q::BACK_OFF)),
        ("end", endstop.end.name().into()),
        ("position", number(endstop.position, &q::endstop_position(endstop.end, length))),
    ])
}

fn driver(d: &DriverSettings) -> Value {
    table([
        ("current_ma", whole(d.current_ma)),
        ("hold_percent", whole(d.hold_percent)),
        ("microsteps", whole(d.microsteps)),
        ("stealth", d.stealth.into()),
        ("hybrid_threshold", number(d.hybrid_threshold, &q::LEAST_SPEED)),
        ("stall_threshold", whole(d.stall_threshold)),
    ])
}

fn heater(h: &HeaterSettings, target: &Kind<Celsius>) -> Value {
    let (m, p, g) = (&h.model, &h.pid, &h.guards);
    let control = match h.control {
        Control::Model => "model",
        Control::Pid => "pid",
    };
    let model = [
        ("capacity", number(m.capacity, &q::CAPACITY)),
        ("loss", number(m.loss, &q::LOSS)),
        ("fan_loss", number(m.fan_loss, &q::LEAST_LOSS)),
        ("heater_lag", number(m.heater_lag, &q::LAG)),
        ("sensor_lag", number(m.sensor_lag, &q::LAG)),
    ];
    let guards = [
        ("heating", number(g.heating, &q::HEATING)),
        ("lost", number(g.lost, &q::LOST)),
        ("lost_s", whole(g.lost_s)),
        ("off_rise", number(g.off_rise, &q::OFF_RISE)),
        ("overshoot", number(g.overshoot, &q::OVERSHOOT)),
    ];
    table([
        ("is_fitted", h.is_fitted.into()),
        ("output", h.output.name().into()),
        ("sensor", h.sensor.name().into()),
        ("thermistor", thermistor(h.thermistor)),
        ("most", number(h.most, target)),
        ("power", number(h.power, &q::POWER)),
        ("max_duty", number(h.max_duty, &q::MAX_DUTY)),
        ("period_ms", whole(h.period_ms)),
        ("control", control.into()),
        ("model", table(model)),
        ("pid", table([("p", p.p), ("i", p.i), ("d", p.d)].map(|(key, gain)| (key, number(gain, &q::GAIN))))),
        ("guards", table(guards)),
    ])
}

fn thermistor(kind: Thermistor) -> Value {
    match kind {
        Thermistor::Semitec104Gt2 => "104gt2".into(),
        Thermistor::Semitec104Nt4 => "104nt4".into(),
        Thermistor::Generic3950 => "ntc_3950".into(),
        Thermistor::Slice450 => "slice_450".into(),
        Thermistor::Pt1000 => "pt1000".into(),
        Thermistor::Beta { ohms, beta } => table([("ohms", whole(ohms)), ("beta", whole(beta))]),
    }
}

fn fan(f: &FanSettings) -> Value {
    let role = match f.role {
        FanRole::Commanded => "commanded",
        FanRole::Hotend => "hotend",
        FanRole::Controller => "controller",
        FanRole::Part => "part",
    };
    table([
        ("role", role.into()),
        ("kick_ms", whole(f.kick_ms)),
        ("least", number(f.least, &q::PART)),
        ("most", number(f.most, &q::PART)),
    ])
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use corehbot::units::{Mm, Ratio, StepsPerMm};

    fn is_read_back(machine: &Settings) {
        let text = written(machine).unwrap();
        let read = parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!((read.name.as_deref(), &read.settings), (Some(machine.name.as_str()), machine), "{text}");
    }

    #[test]
    fn every_example_is_read_back_to_the_bit() {
        let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines");
        let files = std::fs::read_dir(examples).unwrap().map(|file| file.unwrap().path());
        let files: Vec<_> = files.filter(|file| file.extension().is_some_and(|end| end == "toml")).collect();
        assert!(files.len() >= 9);
        files.iter().for_each(|file| is_read_back(&super::super::read(file).unwrap().settings));
    }

    #[test]
    fn values_that_no_short_number_makes_are_read_back_too() {
        let mut machine = Settings::prototype();
        machine.axes.e.steps_per_mm += StepsPerMm::DELTA;
        machine.axes.z.length -= Mm::DELTA;
        machine.arc_tolerance += Mm::DELTA;
        machine.minimum_cruise_ratio -= Ratio::DELTA;
        machine.thermal.filament += corehbot::units::WattsPerKelvin::DELTA;
        machine.advance.window = Some(corehbot::units::Seconds::lit("0.04") + corehbot::units::Seconds::DELTA);
        machine.wiring.motors[1].is_reversed = true;
        machine.wiring.endstops.y.is_normally_open = true;
        machine.thermal.heaters.bed.thermistor = Thermistor::Beta { ohms: 98_765, beta: 4321 };
        machine.corner = CornerRule::SquareCorner(corehbot::units::MmPerSec::lit("5.25"));
        machine.check_machine().unwrap();
        is_read_back(&machine);
        for kind in ShaperKind::all() {
            machine.shapers.x.kind = kind;
            is_read_back(&machine);
        }
        for kind in Thermistor::all() {
            machine.thermal.heaters.hotend.thermistor = kind;
            is_read_back(&machine);
        }
    }
}
