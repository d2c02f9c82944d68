//! Keys: every key of a machine file, from the rows of all settings, and the few keys without a setting.

use crate::texts::TEXTS;
use corehbot::motors::MotorName;
use corehbot::settings::ranges;
use corehbot::settings::rows::{Legal, Row, Text, ValueKind};
use corehbot::settings::table::described;
use corehbot_twin::description::Routing;
use corehbot_twin::math::powi;
use corehbot_twin::params::{ROWS as TWIN_ROWS, Row as TwinRow};
use std::sync::LazyLock;

/// A key of a machine file.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    /// The key with its tables.
    pub path: String,
    /// Its kind of value.
    pub of: Of,
}

/// The kind of value behind a key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Of {
    /// A setting of a part of the machine.
    Setting { row: &'static Row, text: &'static Text, part: usize },
    /// A list of values, one for each part.
    List { row: &'static Row, text: &'static Text },
    /// A key that settings follow from.
    Other(&'static Other),
    /// A number of the machine for the belt's twin, which no board keeps.
    Twin(&'static TwinRow),
    /// The routing of the belts, for the twin too.
    Routing,
}

/// A key that settings follow from.
#[derive(Debug)]
pub(crate) struct Other {
    /// The last word of the key.
    pub name: &'static str,
    /// The tables that may have it.
    pub tables: &'static [&'static str],
    /// Its meaning.
    pub meaning: &'static str,
}

/// Which board the machine is on.
pub(crate) const BOARD: &str = "board";
/// Movement of an axis by a turn of a motor.
pub(crate) const ROTATION_DISTANCE: &str = "rotation_distance";
/// Full steps of such a turn.
pub(crate) const FULL_STEPS: &str = "full_steps";

/// The table of the belt's twin.
pub(crate) const TWIN: &str = "twin";
/// Its key for the run of the belts.
pub(crate) const ROUTING: &str = "twin.routing";
/// The meaning of this key.
pub(crate) const ROUTING_MEANING: &str = "The run of the belts; auto takes the one that fits the motors' rows. An H-bot turns \
     like a CoreXY, and a bed that moves in y like a bar, so these are named. straight has a belt for each motor.";

/// The table of the driver of the first motor.
pub(crate) const OF_MOTOR: &str = "drivers.#0";

const AXES: &[&str] = &["axes.x", "axes.y", "axes.z", "axes.e"];

/// Keys without a setting.
const OTHERS: [Other; 3] = [
    Other {
        name: BOARD,
        tables: &[""],
        meaning: "The board. Motors, endstops and heaters are held to the connectors that it has; without a board they may be \
                  anything.",
    },
    Other {
        name: ROTATION_DISTANCE,
        tables: AXES,
        meaning: "Distance that a turn of the motor moves the axis (teeth x pitch, lead of a screw, with gears), in mm, instead of \
                  steps_per_mm, which is full_steps x microsteps / rotation_distance.",
    },
    Other {
        name: FULL_STEPS,
        tables: AXES,
        meaning: "Full steps of a turn of the motor, for rotation_distance; 200 if left out.",
    },
];

/// The subject of each table.
pub(crate) const TABLES: [(&str, &str); 45] = [
    ("", "A machine of CoreH-bot firmware. What is left out is as in the prototype."),
    (
        "mechanism",
        "Steps of each motor for one step of x, y, z and e. A file with this table lists every motor that is fitted.",
    ),
    ("motors", "The motors: their names, and the socket of the board for each."),
    ("endstops", "The input of the board for the switch of each axis."),
    ("corner", "Speed in corners: one of the keys."),
    ("shaper", "Input shapers against ringing (M593)."),
    ("shaper.x", "The shaper of x."),
    ("shaper.y", "The shaper of y."),
    ("advance", "Pressure advance (M900, M572)."),
    ("axes", "Resolution, limits and length of every axis."),
    ("axes.x", "The axis x."),
    ("axes.y", "The axis y."),
    ("axes.z", "The axis z."),
    ("axes.e", "The extruder; its length is the longest single move."),
    (
        "bed",
        "Where the machine can print, in the coordinates of the homed machine: all that its tool reaches, if left out.",
    ),
    ("belt", "The belt that joins the motors of x and y, and how it circulates."),
    ("pause", "Where the tool waits while a print is paused, and how it gets there and back."),
    ("job", "What a print does if homing or probing fails."),
    ("probe", "The Z probe: how it touches the bed, and where it sits."),
    ("probe.offset", "The probe's place minus the nozzle's (M851)."),
    ("probe.home", "Where the probe touches to home z."),
    ("safe_z_home", "Where its switch homes z, and how far z rises before anything is homed."),
    ("accelerometer", "The accelerometer at the tool, by which resonances are measured (TEST_RESONANCES)."),
    ("accelerometer.axes", "The axis of the sensor that points along each axis of the machine."),
    ("supply", "The power supply's switch (PS_ON): the last resort against a heater that does not go off."),
    ("homing", "How each axis finds its endstop, where that is, and in which order."),
    ("drivers", "The configuration of the motor drivers (TMC2209) where they have a UART."),
    ("drivers.belt", "Drivers of the motors that move x or y."),
    ("drivers.z", "Drivers of the motors that move z alone."),
    ("drivers.e", "Driver of the extruder."),
    (OF_MOTOR, "Driver of one motor, by its name: values in which it differs from its group."),
    ("thermal", "Settings that heaters and fans have in common."),
    ("heaters", "Heaters."),
    ("heaters.hotend", "The hotend (T)."),
    ("heaters.bed", "The bed (B)."),
    ("heaters.chamber", "The chamber (C)."),
    (
        "sensors",
        "More temperature sensors, which M105 reports. One that guards a heater takes its power at a limit; another that \
         is broken stops nothing.",
    ),
    ("sensors.chamber", "The chamber's air (C), if the chamber has no heater."),
    ("sensors.board", "The board or its case (M)."),
    ("sensors.probe", "The probe (P)."),
    ("sensors.second", "A second sensor on a heater (R)."),
    ("fans", "Fan outputs."),
    ("guards", "Guards, which cannot be switched off."),
    (
        TEXTS,
        "Lines of G-code with a name, up to 16: `NAME = \"G28\\nM109 S{EXTRUDER:200}\"`. START_PRINT and others replace what is \
         built in. An image has room for 2,026 bytes of them.",
    ),
    (
        TWIN,
        "The machine's belts, masses and motors, for `--plant belt` and `corehbot twin`. No board keeps them. Of a number for each \
         belt, span or motor a list is legal too.",
    ),
];

/// The subject of a table: by its path, or by its last word.
pub(crate) fn about(path: &str) -> Option<&'static str> {
    let last = path.rsplit('.').next().unwrap_or(path);
    let find = |name: &str| TABLES.iter().find(|(table, _)| *table == name).map(|(_, about)| *about);
    find(path).or_else(|| find(last))
}

/// The legal words for the run of the belts.
pub(crate) fn routings() -> Vec<&'static str> {
    std::iter::once(Routing::AUTO).chain(Routing::all().map(Routing::key)).collect()
}

/// A key behind a table.
pub(crate) fn join(table: &str, key: &str) -> String {
    let point = if table.is_empty() || key.is_empty() { "" } else { "." };
    format!("{table}{point}{key}")
}

/// All keys.
pub(crate) static ALL: LazyLock<Vec<Known>> = LazyLock::new(|| {
    let mut all: Vec<Known> = OTHERS
        .iter()
        .flat_map(|other| other.tables.iter().map(move |table| (join(table, other.name), Of::Other(other))))
        .map(|(path, of)| Known { path, of })
        .collect();
    all.push(Known { path: ROUTING.to_owned(), of: Of::Routing });
    all.extend(TWIN_ROWS.iter().map(|row| Known { path: join(TWIN, row.key), of: Of::Twin(row) }));
    for (row, text) in described() {
        let is_list = row.leaf.is_empty() && row.tables.len() > 1 && row.tables.iter().all(|t| t == &row.tables[0]);
        let parts = if is_list { 1 } else { row.tables.len() };
        all.extend(row.tables.iter().take(parts).enumerate().map(|(part, table)| Known {
            path: join(table, row.leaf),
            of: if is_list { Of::List { row, text } } else { Of::Setting { row, text, part } },
        }));
    }
    all
});

/// The path of a setting in a file where motors have these names: `mechanism.#2` is `mechanism.m8` in the prototype's.
/// `None` for a motor without a name.
pub(crate) fn named(path: &str, names: &[MotorName]) -> Option<String> {
    let Some((table, rest)) = path.split_once(".#") else { return Some(path.to_owned()) };
    let (number, leaf) = rest.split_once('.').unwrap_or((rest, ""));
    let name = names.get(number.parse::<usize>().ok()?).filter(|name| !name.is_none())?;
    let motor = join(table, name.as_str());
    // `drivers.z` is a group of drivers, also if a motor has this name.
    (!is_table(&motor)).then(|| join(&motor, leaf))
}

/// The reverse: a path in such a file, with the number of a motor for its name.
pub(crate) fn numbered(path: &str, names: &[MotorName]) -> String {
    let mut words = path.splitn(3, '.');
    let (table, name, leaf) = (words.next(), words.next(), words.next());
    let number = name.and_then(|name| names.iter().position(|known| !name.is_empty() && known.as_str() == name));
    match (table, number) {
        (Some(table), Some(number)) if has_motors(table) && !is_table(&join(table, name.unwrap_or_default())) => {
            join(&format!("{table}.#{number}"), leaf.unwrap_or_default())
        }
        _ => path.to_owned(),
    }
}

/// Whether a table has keys or tables that are named by motors.
fn has_motors(table: &str) -> bool {
    is_table(&format!("{table}.#0")) || find(&format!("{table}.#0")).is_some()
}

/// The key at that path.
pub(crate) fn find(path: &str) -> Option<&'static Known> {
    ALL.iter().find(|known| known.path == path)
}

/// Whether there are keys in a table of that path.
pub(crate) fn is_table(path: &str) -> bool {
    ALL.iter().any(|known| known.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
}

/// The names of the keys and tables in a table, where motors have these names.
pub(crate) fn names_in(table: &str, motors: &[MotorName]) -> Vec<String> {
    let mut names = Vec::new();
    for path in ALL.iter().filter_map(|known| named(&known.path, motors)) {
        let inner = if table.is_empty() { Some(&*path) } else { path.strip_prefix(table) };
        let inner = inner.and_then(|inner| if table.is_empty() { Some(inner) } else { inner.strip_prefix('.') });
        if let Some(name) = inner.and_then(|inner| inner.split('.').next()).map(str::to_owned)
            && !names.contains(&name)
        {
            names.push(name);
        }
    }
    if table.is_empty() {
        names.push(TEXTS.to_owned());
    }
    names
}

/// The names of a choice.
pub(crate) fn names_of(name: fn(usize) -> Option<&'static str>) -> Vec<&'static str> {
    (0..).map_while(name).collect()
}

/// Bits after the point of a kind of number; 0 of whole ones.
pub(crate) const fn fraction(kind: ValueKind) -> u32 {
    match kind {
        ValueKind::Fixed(bits) | ValueKind::Auto(bits) => bits,
        ValueKind::Whole
        | ValueKind::OfMotor
        | ValueKind::Place
        | ValueKind::Switch
        | ValueKind::Choice(_)
        | ValueKind::Name
        | ValueKind::MotorName
        | ValueKind::Plug
        | ValueKind::Connector
        | ValueKind::Thermistor
        | ValueKind::MotorRow => 0,
    }
}

/// The legal numbers, in words.
pub(crate) fn legal_words(legal: Legal, kind: ValueKind) -> String {
    // The greatest of these is no place.
    let most =
        if matches!(kind, ValueKind::Place) { legal.most.min(ranges::SCREW_PLACE.most.into()) } else { legal.most };
    let [least, most] = [legal.least, most].map(|bits| shortest(bits, fraction(kind)));
    let whole = if matches!(kind, ValueKind::Whole | ValueKind::OfMotor | ValueKind::Place) {
        "the whole numbers "
    } else {
        ""
    };
    // Files say this 0 by a word, or by nothing.
    let is_hidden = matches!(kind, ValueKind::Auto(_) | ValueKind::OfMotor);
    let zero = if legal.may_be_zero && legal.least > 0 && !is_hidden { "0 and " } else { "" };
    format!("{zero}{whole}{least} to {most}")
}

/// Decimals that are tried for the shortest number; a value has at most 32 bits after the point.
const MOST_DECIMALS: usize = 12;

/// The bits of a fixed-point number; too great a number for 64 bits saturates. NaN has no bits.
pub(crate) fn bits_of(number: f64, fraction: u32) -> Option<i64> {
    // Exact except for the rounding, because the factor is a power of two.
    (!number.is_nan()).then(|| (number * powi(2.0, fraction as i32)).round_ties_even() as i64)
}

/// The shortest number that has these bits.
pub(crate) fn shortest(bits: i64, fraction: u32) -> f64 {
    let exact = bits as f64 / powi(2.0, fraction as i32);
    let rounded = (0..=MOST_DECIMALS).filter_map(|decimals| format!("{exact:.decimals$}").parse::<f64>().ok());
    rounded.into_iter().find(|number| bits_of(*number, fraction) == Some(bits)).unwrap_or(exact)
}
