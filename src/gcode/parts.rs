//! Parts of commands: the axes, arcs, planes, forms and flaws that a [`Command`](super::Command) is made of.

use super::index::Absent;
use super::number::Number;
use crate::connectors::Heater;
use crate::settings::plain::{MOST_WORDS, letters};

/// One value per axis, each only if the line gave it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct AxisWords {
    /// Value of the X word.
    pub x: Option<Number>,
    /// Value of the Y word.
    pub y: Option<Number>,
    /// Value of the Z word.
    pub z: Option<Number>,
    /// Value of the E word.
    pub e: Option<Number>,
}

/// The words of a line that sets plain settings (`settings::plain`).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PlainWords {
    /// The number of the M-code.
    pub code: u16,
    /// A number for each letter that the line gave one, in the order of [`letters`].
    pub numbers: [Option<Number>; MOST_WORDS],
}

impl PlainWords {
    /// The number of a letter.
    #[must_use]
    pub fn number(&self, letter: &str) -> Option<Number> {
        letters(self.code).zip(&self.numbers).find(|(own, _)| *own == letter).and_then(|(_, number)| *number)
    }
}

/// The axes that a line named, with or without a value.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct AxisFlags {
    /// X was named.
    pub x: bool,
    /// Y was named.
    pub y: bool,
    /// Z was named.
    pub z: bool,
    /// E was named.
    pub e: bool,
}

/// The words of G28.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct HomeWords {
    /// The axes, all if none is named.
    pub axes: AxisFlags,
    /// O: axes that are homed stay where they are.
    pub only_lost: bool,
    /// R: the distance that z rises by before an axis is homed.
    pub raise: Option<Number>,
    /// W, L0: the mesh is not used any more.
    pub drops_mesh: bool,
}

/// The words of G34.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct LevelWords {
    /// I: measurements, each followed by a correction unless it is the last one.
    pub rounds: Option<Number>,
    /// T: the difference in mm between screws that is level enough.
    pub within: Option<Number>,
    /// A: the share of a measured difference that is corrected.
    pub share: Option<Number>,
    /// E: the probe stays out between its points.
    pub keeps_out: bool,
}

/// The words of G29 and its relatives.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct GridWords {
    /// The area from and to x, from and to y; all that the probe reaches without them.
    pub area: [Option<Number>; 4],
    /// H: the side of a square in the middle of the bed.
    pub square: Option<Number>,
    /// O: nothing is measured if a mesh is in use.
    pub only_without: bool,
    /// D: the heights are reported and not kept.
    pub is_dry: bool,
    /// N: homes all axes first.
    pub homes: bool,
    /// E: the probe is taken in between its touches.
    pub takes_in: bool,
    /// V: from 1 on each touch is told.
    pub verbosity: Option<Number>,
    /// Around the objects of the print.
    pub is_adaptive: bool,
    /// The margin around them in mm.
    pub margin: Option<Number>,
    /// Columns and rows; without them as many as its share of the whole mesh has.
    pub counts: [Option<Number>; 2],
    /// The area is in mm, even after G20.
    pub is_in_mm: bool,
}

/// The words of M420.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct LevellingWords {
    /// S: whether the mesh is used.
    pub on: Option<bool>,
    /// V: reports the mesh.
    pub reports: bool,
    /// T1: as a table for programs.
    pub form: Option<Number>,
    /// Z: the height up to which it fades; 0 is no fade.
    pub fade: Option<Number>,
    /// C: its mean becomes 0.
    pub centres: bool,
    /// L: takes the mesh that was kept.
    pub loads: bool,
}

impl LevellingWords {
    /// Whether it does more than report.
    #[must_use]
    pub const fn changes(&self) -> bool {
        self.on.is_some() || self.fade.is_some() || self.centres || self.loads
    }
}

/// A point of the mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshPoint {
    /// Its column and row.
    Number([Number; 2]),
    /// The point nearest to a place.
    Place([Option<Number>; 2]),
    /// The point nearest to the nozzle.
    Nearest,
}

/// The words of M421 and of G29 W.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PointWords {
    /// The point.
    pub point: MeshPoint,
    /// Z: its height.
    pub height: Option<Number>,
    /// Q: the change of its height.
    pub change: Option<Number>,
    /// N: it counts as not measured.
    pub forgets: bool,
}

/// How a message of M118 is dressed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// As it is.
    Plain,
    /// E1: `echo:` in front.
    Echo,
    /// A1: `//` in front, for an action command to the host.
    Action,
}

/// The receivers of a message of M118.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Audience {
    /// The host that sent it.
    Sender,
    /// P0: all hosts.
    All,
    /// P1 to P9: the host on that serial line, if there is one.
    Line(u8),
}

/// Where the centre of an arc lies.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ArcShape {
    /// Centre relative to the start (I, J, K).
    Centre {
        /// Offset in X.
        i: Number,
        /// Offset in Y.
        j: Number,
        /// Offset in Z.
        k: Number,
    },
    /// Radius (R); a negative one takes the longer way round.
    Radius(Number),
    /// Neither I, J, K nor R was given.
    Missing,
}

/// The plane in which an arc lies.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Plane {
    /// G17: x and y.
    Xy,
    /// G18: z and x.
    Zx,
    /// G19: y and z.
    Yz,
}

/// Why a line is not carried out although its command is known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Flaw<'a> {
    /// This is not a letter with a number.
    NoWord(&'a [u8]),
    /// This is not a name with `=` and the number that it needs.
    NoPair(&'a [u8]),
    /// This letter needs a number.
    NoNumber(u8),
    /// This number is out of range.
    OutOfRange(&'a [u8]),
    /// There is no such axis.
    NoAxis(u8),
    /// A second command stands on the line.
    SecondCommand(&'a [u8]),
    /// It is for a part that is not there.
    Absent(Absent<'a>),
}

/// The operation on the record of the machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MachineRecord<'a> {
    /// MACHINE_GET: say it.
    Get,
    /// MACHINE_PUT: take a piece of another one.
    Put {
        /// AT: its place in the record, in bytes.
        at: u16,
        /// HEX: its bytes, two digits each.
        hex: &'a [u8],
    },
    /// MACHINE_STORE: check the assembled record, and store it.
    Store,
}

/// Where the tool waits while a print is paused; as the machine is set where a word is left out.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ParkWords {
    /// X: the parking place.
    pub x: Option<Number>,
    /// Y: the same.
    pub y: Option<Number>,
    /// Z: the lift of the tool.
    pub z: Option<Number>,
    /// E, or L of M125: the length of filament to pull back.
    pub e: Option<Number>,
    /// R: the hotend's target when the print continues.
    pub target: Option<Number>,
    /// U of M600: the length of filament to pull out then.
    pub unload: Option<Number>,
    /// L of M600: the length to push in before the print continues; less than 0, it is Prusa's word for the length to
    /// pull out.
    pub load: Option<Number>,
    /// The letter of another word with a number, as of Marlin's M125 U.
    pub other: Option<u8>,
}

/// The words of SET_GCODE_OFFSET, in mm.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct OffsetWords {
    /// Z: the offset.
    pub to: Option<Number>,
    /// Z_ADJUST: more than now. It does not count beside Z.
    pub by: Option<Number>,
    /// MOVE=1: z moves at once.
    pub moves: bool,
}

/// The direction of a resonance test.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SweepAxis {
    /// Along x.
    #[default]
    X,
    /// Along y.
    Y,
    /// To the right and to the front.
    A,
    /// To the right and to the back.
    B,
}

/// The words of TEST_RESONANCES and SHAPER_CALIBRATE.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SweepWords {
    /// AXIS.
    pub axis: SweepAxis,
    /// FREQ_START, Hz.
    pub from: Option<Number>,
    /// FREQ_END, Hz.
    pub to: Option<Number>,
    /// ACCEL_PER_HZ, mm/s2 per Hz.
    pub accel_per_hz: Option<Number>,
    /// HZ_PER_SEC.
    pub hz_per_s: Option<Number>,
    /// SWEEPING_ACCEL, mm/s2.
    pub swing: Option<Number>,
    /// SWEEPING_PERIOD, s; 0 is none.
    pub period: Option<Number>,
    /// OUTPUT=raw_data: every sample goes to the host.
    pub wants_raw: bool,
    /// It is SHAPER_CALIBRATE.
    pub chooses: bool,
}

/// The words of SET_VELOCITY_LIMIT.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct VelocityWords<'a> {
    /// ACCEL, mm/s2.
    pub acceleration: Option<Number>,
    /// ACCEL_TO_DECEL, mm/s2.
    pub to_deceleration: Option<Number>,
    /// MINIMUM_CRUISE_RATIO.
    pub cruise_ratio: Option<Number>,
    /// SQUARE_CORNER_VELOCITY, mm/s.
    pub square_corner: Option<Number>,
    /// The name of another word: VELOCITY, or else the first.
    pub other: Option<&'a [u8]>,
}

/// The words of G2, G3.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ArcWords {
    /// G2 runs clockwise, G3 counter-clockwise.
    pub clockwise: bool,
    /// The target.
    pub to: AxisWords,
    /// F, per minute.
    pub feed: Option<Number>,
    /// I, J, K or R.
    pub shape: ArcShape,
    /// P: total number of turns, at least 1 (RS-274/NGC section 3.5.3).
    pub turns: u16,
    /// Most decimals of its coordinates as they are written, up to 5: places that differ by less than the last may
    /// be one.
    pub decimals: u8,
}

/// The words of M303, M306 T.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TuningWords {
    /// E: 0 the hotend, -1 the bed, -2 the chamber; `None` for another number.
    pub heater: Option<Heater>,
    /// S, in degrees Celsius.
    pub target: Option<Number>,
    /// C: swings.
    pub cycles: Option<Number>,
    /// U: whether to use the result.
    pub applies: bool,
}

/// The words of M593.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ShaperWords {
    /// X and Y.
    pub axes: AxisFlags,
    /// F, in Hz; 0 is off.
    pub frequency: Option<Number>,
    /// D: a ratio.
    pub damping: Option<Number>,
    /// T: which shaper.
    pub kind: Option<Number>,
}
