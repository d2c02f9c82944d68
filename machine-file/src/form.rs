//! The form of a machine file: its tables and keys, every one optional. The comments of keys, with their units, are what an
//! editor shows: they stand in the schema (`schema`).

mod heat;
mod motion;

use corehbot::connectors::{BoardConnectors, NUCLEO, OCTOPUS, OCTOPUS_PRO, SIM, SPIDER};
use corehbot::settings::Alignment;
use corehbot::settings::ranges::{BAUD, PAUSE_HEAT_MIN};
pub(super) use heat::{
    FanToml, FansToml, GuardsToml, HeaterToml, HeatersToml, ModelToml, PidToml, ThermalToml, ThermistorToml,
};
pub(super) use motion::{
    AdvanceToml, AxesToml, AxisToml, CornerToml, DriverToml, DriversToml, EndToml, HomedAxisToml, HomingToml,
    HomingsToml, ShaperToml, ShapersToml, WindowToml,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// A machine of CoreH-bot firmware. What is left out is as in the prototype.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MachineToml {
    /// What hosts, screens and reports call the machine: up to 24 letters, digits, blanks and + - . , / ( ) & # '.
    pub name: Option<String>,
    /// The board. Motors, endstops and heaters are held to the connectors that it has; without a board they may be
    /// anything.
    pub board: Option<BoardToml>,
    /// Speed limit of one belt motor, in mm of belt a second. A diagonal asks 1.41 times the tool's speed of two
    /// motors.
    pub motor_max_speed: Option<f64>,
    /// Acceleration limit of one belt motor, in mm of belt a second squared.
    pub motor_max_acceleration: Option<f64>,
    /// Acceleration of moves that print, in mm/s2 (M204 P).
    pub print_acceleration: Option<f64>,
    /// Acceleration of moves of the extruder alone, in mm/s2 (M204 R).
    pub retract_acceleration: Option<f64>,
    /// Acceleration of moves that do not print, in mm/s2 (M204 T).
    pub travel_acceleration: Option<f64>,
    /// The jump in the extruder's speed that a corner may ask for, in mm/s (M205 E).
    pub extruder_jerk: Option<f64>,
    /// Least commanded speed of printing moves, in mm/s; 0 is none (M205 S).
    pub min_feed: Option<f64>,
    /// Least commanded speed of other moves, in mm/s; 0 is none (M205 T).
    pub min_travel: Option<f64>,
    /// Whether moves are kept inside the reachable space (M211).
    pub soft_endstops: Option<bool>,
    /// Whether moves of an axis that was not homed are refused. Otherwise the host is told of them once.
    pub require_homing: Option<bool>,
    /// How far the chords of an arc may lie inside it, in mm.
    pub arc_tolerance: Option<f64>,
    /// Seconds between two busy messages; 0 is none (M113).
    pub keepalive_s: Option<f64>,
    /// Rate of the serial lines on the board's headers, in baud; USB has none. It counts after a reset.
    #[schemars(with = "Option<u32>", range(min = BAUD.least, max = BAUD.most))]
    pub baud: Option<f64>,
    /// Milliseconds of silence in the middle of numbered lines after which the host is prompted to go on, 100 or more;
    /// 0 is never.
    pub patience_ms: Option<f64>,
    /// Seconds of motion, at nominal speed, that wait in the look-ahead before a line is answered.
    pub lookahead_time: Option<f64>,
    /// Whether ok tells the line number, free moves and free lines (ok N12 P100 B9), as Marlin's ADVANCED_OK.
    pub advanced_ok: Option<bool>,
    /// The part of a move over which its speed holds at least, unless it accelerates or brakes all along.
    pub minimum_cruise_ratio: Option<f64>,
    /// How many steps a motor turns for one step of x, y, z and e. A file with this table lists every motor that is
    /// fitted.
    pub mechanism: Option<MechanismToml>,
    /// Which socket of the board each motor is plugged into.
    pub motors: MotorsToml,
    /// Which input of the board the switch of each axis is plugged into.
    pub endstops: EndstopsToml,
    /// Speed in corners: one of the keys.
    pub corner: CornerToml,
    /// Input shapers against ringing (M593).
    pub shaper: ShapersToml,
    /// Pressure advance (M900, M572).
    pub advance: AdvanceToml,
    /// Resolution, limits and length of every axis.
    pub axes: AxesToml,
    /// Where the machine can print: all that its tool reaches, if left out.
    pub bed: BedToml,
    /// What ties the motors of x and y together.
    pub belt: BeltToml,
    /// What a pause does with the tool and the heat.
    pub pause: PauseToml,
    /// How each axis finds its endstop, where that is, and in which order.
    pub homing: HomingsToml,
    /// What the motor drivers (TMC2209) are told where they have a UART.
    pub drivers: DriversToml,
    /// What heaters and fans have in common.
    pub thermal: ThermalToml,
    /// Heaters.
    pub heaters: HeatersToml,
    /// Fan outputs.
    pub fans: FansToml,
}

/// Boards by their names in `connectors`.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum BoardToml {
    Octopus,
    OctopusPro,
    Spider,
    Nucleo,
    Sim,
}

impl From<BoardToml> for &'static BoardConnectors {
    fn from(board: BoardToml) -> Self {
        match board {
            BoardToml::Octopus => &OCTOPUS,
            BoardToml::OctopusPro => &OCTOPUS_PRO,
            BoardToml::Spider => &SPIDER,
            BoardToml::Nucleo => &NUCLEO,
            BoardToml::Sim => &SIM,
        }
    }
}

/// The connector of each motor.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MotorsToml {
    /// Socket of motor 1, as printed on the board; ! before it turns the motor the other way round; empty is nowhere.
    pub m1: Option<PlugToml>,
    /// Socket of motor 4, as printed on the board; ! before it turns the motor the other way round; empty is nowhere.
    pub m4: Option<PlugToml>,
    /// Socket of motor 8, as printed on the board; ! before it turns the motor the other way round; empty is nowhere.
    pub m8: Option<PlugToml>,
    /// Socket of motor 11, as printed on the board; ! before it turns the motor the other way round; empty is nowhere.
    pub m11: Option<PlugToml>,
    /// Socket of the first screw, as printed on the board; ! before it turns the motor the other way round; empty is
    /// nowhere.
    pub z1: Option<PlugToml>,
    /// Socket of the second screw, as printed on the board; ! before it turns the motor the other way round; empty is
    /// nowhere.
    pub z2: Option<PlugToml>,
    /// Socket of the extruder, as printed on the board; ! before it turns the motor the other way round; empty is
    /// nowhere.
    pub e0: Option<PlugToml>,
}

/// The connector of each axis' switch.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct EndstopsToml {
    /// Input of the x switch, which opens when it is pressed; ! before it: it closes (normally open).
    pub x: Option<PlugToml>,
    /// Input of the y switch, which opens when it is pressed; ! before it: it closes (normally open).
    pub y: Option<PlugToml>,
    /// Input of the z switch, which opens when it is pressed; ! before it: it closes (normally open).
    pub z: Option<PlugToml>,
    /// Input of the Z probe, which goes high when the probe triggers; ! before it: it goes low; empty is no probe. On a board M119
    /// tells it, and nothing probes by it.
    pub probe: Option<PlugToml>,
}

/// The bed, in the coordinates of the homed machine.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct BedToml {
    /// Size in x, in mm.
    pub width: Option<f64>,
    /// Size in y, in mm.
    pub depth: Option<f64>,
    /// x of its left edge, in mm.
    pub left: Option<f64>,
    /// y of its front edge, in mm.
    pub front: Option<f64>,
}

/// Where the tool waits while a print is paused, and how it gets there and back.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct PauseToml {
    /// Filament that is pulled back before the tool leaves the part, in mm; 0 is none.
    pub retract: Option<f64>,
    /// Speed at which filament is pulled back, in mm/s.
    pub retract_speed: Option<f64>,
    /// Speed at which filament is pushed forward again, in mm/s.
    pub unretract_speed: Option<f64>,
    /// How far the tool is lifted off the part, in mm; 0 is not at all.
    pub lift: Option<f64>,
    /// Whether the tool goes to the place of x and y.
    pub park: Option<bool>,
    /// x of the parking place, in mm; beyond the reachable space it is the edge.
    pub x: Option<f64>,
    /// y of the parking place, in mm; beyond the reachable space it is the edge.
    pub y: Option<f64>,
    /// Speed of the way to the parking place and back, in mm/s.
    pub travel_speed: Option<f64>,
    /// Minutes of a pause after which heaters go off, to be heated again before the print goes on; they go off after thermal.idle_min at
    /// the latest.
    #[schemars(with = "Option<u8>", range(min = PAUSE_HEAT_MIN.least, max = PAUSE_HEAT_MIN.most))]
    pub heat_off_min: Option<f64>,
}

/// The belt, and how it runs round.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct BeltToml {
    /// Whether one closed belt runs over all motors that move x or y, each turning it the same way round when it turns forward, so that it
    /// can run round while the tool stands (C in G0 and G1). A file with a mechanism has none unless it says so.
    pub closed: Option<bool>,
    /// Milliseconds between two motors of one belt that get power.
    pub settling: Option<f64>,
    /// Speed limit of a belt that runs round, in mm/s.
    pub max_speed: Option<f64>,
    /// Acceleration limit of a belt that runs round, in mm/s2.
    pub max_acceleration: Option<f64>,
    /// How far the belt runs on after x and y are homed, in mm, so that it does not always bend at the same teeth; 0 is not at all.
    pub homing_advance: Option<f64>,
    /// What there is to do about motors of one belt that were not aligned (M915) since they got power.
    pub alignment: Option<AlignmentToml>,
    /// What motors are to strain the belt by when they are aligned, in mm of belt: their residual.
    pub preload: Option<f64>,
    /// Where the drivers of a belt's motors stood to each other when nothing strained it, in 1024ths of an electrical turn, a number for each
    /// residual: M915 finds it, and nobody else knows. Left out, it is not known.
    pub phases: Option<Vec<f64>>,
    /// How far z is raised when a motor of the belt has failed, in mm, before the others park the tool; 0 cuts all power at once.
    pub limp_lift: Option<f64>,
}

/// Off: nothing. Warning: the host is told of the first printing move. Required: printing moves are refused. Automatic: they are aligned
/// when x and y are homed.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum AlignmentToml {
    Off,
    Warning,
    Required,
    Automatic,
}

impl From<AlignmentToml> for Alignment {
    fn from(alignment: AlignmentToml) -> Self {
        match alignment {
            AlignmentToml::Off => Self::Off,
            AlignmentToml::Warning => Self::Warning,
            AlignmentToml::Required => Self::Required,
            AlignmentToml::Automatic => Self::Automatic,
        }
    }
}

/// A row a motor that is fitted.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MechanismToml {
    /// Motor 1 (CoreH-bot: front left): steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub m1: Option<RowToml>,
    /// Motor 4 (CoreH-bot: front right): steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub m4: Option<RowToml>,
    /// Motor 8 (CoreH-bot: rear right): steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub m8: Option<RowToml>,
    /// Motor 11 (CoreH-bot: rear left): steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub m11: Option<RowToml>,
    /// First screw: steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub z1: Option<RowToml>,
    /// Second screw: steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub z2: Option<RowToml>,
    /// Extruder: steps for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
    pub e0: Option<RowToml>,
}

/// A row: what a motor turns for a step of x, y, z and maybe e.
#[derive(Deserialize, JsonSchema)]
pub(super) struct RowToml(
    #[schemars(with = "Vec<i8>", length(min = 3, max = 4), inner(range(min = -16, max = 16)))] pub Vec<f64>,
);

/// A connector, as `plugs` reads it.
#[derive(Deserialize, JsonSchema)]
pub(super) struct PlugToml(#[schemars(regex(pattern = r"^(|!?[\x22-\x7e]{1,8})$"))] pub String);
