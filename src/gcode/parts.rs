//! Parts of commands: the axes, arcs, planes, forms and flaws that a [`Command`](super::Command) is made of.

use super::index::Absent;
use super::number::Number;

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
