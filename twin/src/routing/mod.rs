//! Routing: the run of a machine's belts, as a table.
//!
//! A belt is the row of its stops in the direction that turns motors counter-clockwise. A stop is a pulley, or the
//! clamp that holds the belt on the head. Places are sums of the machine's dimensions, so a table holds for any size.
//! The place determines what a stop moves with: a coordinate that begins at the tool follows the tool.
//!
//! | file | content |
//! |---|---|
//! | [`stop`] | a pulley or clamp, and its place |
//! | `corehbot` | figures 5 and 6c of the CoreH-bot paper |
//! | `hbot` | figure 6a |
//! | `corexy` | figure 6b, and the same with a motor at each end of its belts |
//! | [`separate_belts`] | machines with a belt for each motor, from the motors' rows: CoreXYZ, Cartesian and others |

mod corehbot;
mod corexy;
mod hbot;
pub mod separate_belts;
pub mod stop;

pub use separate_belts::Own;
pub use stop::{Along, Block, Mark, Place, Role, Side, Stop};

use crate::params::Params;
use std::borrow::Cow;

/// How a belt runs from stop to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runs {
    /// In one plane, along the tangents of its pulleys; the places are those of the pulleys' centres.
    Flat,
    /// In space, along the axes; the places are the corners of its line, which pulleys round off.
    Upright,
}

/// A belt: its stops in the direction of travel.
#[derive(Clone, Debug)]
pub struct Belt {
    /// The stops. A belt without clamps is closed: the first stop follows the last. Otherwise the first and last are
    /// clamps.
    pub stops: Cow<'static, [Stop]>,
    /// Names of the spans between motors and clamps, from the first of them on.
    pub spans: &'static [&'static str],
    /// How it runs.
    pub runs: Runs,
}

impl Belt {
    /// In one plane.
    const fn flat(stops: &'static [Stop], spans: &'static [&'static str]) -> Self {
        Self { stops: Cow::Borrowed(stops), spans, runs: Runs::Flat }
    }

    /// Whether the first stop follows the last.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.stops.first().is_some_and(|stop| stop.role != Role::Clamp)
    }
}

/// A machine with belts known to the twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// One closed belt, four motors, fourteen pulleys.
    CoreHBot,
    /// One belt held on the head, two motors.
    HBot,
    /// Two belts that cross, two motors.
    CoreXy,
    /// Two belts that cross, four motors: two a belt.
    AwdCoreXy,
    /// Four belts over three axes, a motor each.
    CoreXyz,
    /// The same with three motors; the fourth belt runs over an idler.
    CoreXyzThree,
    /// A belt for each motor, by the motors' rows.
    Own(Own),
}

impl Machine {
    /// All with a table of their own.
    pub const ALL: [Self; 6] =
        [Self::CoreHBot, Self::HBot, Self::CoreXy, Self::AwdCoreXy, Self::CoreXyz, Self::CoreXyzThree];

    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::CoreHBot => "CoreH-bot",
            Self::HBot => "H-bot",
            Self::CoreXy => "CoreXY",
            Self::AwdCoreXy => "AWD CoreXY",
            Self::CoreXyz => "CoreXYZ",
            Self::CoreXyzThree => "CoreXYZ with three motors",
            Self::Own(_) => "machine with a belt for each motor",
        }
    }

    /// Its name on a command line.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::CoreHBot => "corehbot",
            Self::HBot => "hbot",
            Self::CoreXy => "corexy",
            Self::AwdCoreXy => "awd-corexy",
            Self::CoreXyz => "corexyz",
            Self::CoreXyzThree => "corexyz-three",
            Self::Own(own) if own.has_moving_bed => "moving-bed",
            Self::Own(_) => "straight",
        }
    }

    /// Its name for people, by its key.
    #[must_use]
    pub fn name_of(key: &'static str) -> &'static str {
        Self::ALL.into_iter().find(|machine| machine.key() == key).map_or(key, Self::name)
    }

    /// Its belts.
    #[must_use]
    pub fn belts(self) -> Vec<Belt> {
        match self {
            Self::CoreHBot => vec![corehbot::BELT],
            Self::HBot => vec![hbot::BELT],
            Self::CoreXy => corexy::BELTS.to_vec(),
            Self::AwdCoreXy => corexy::AWD_BELTS.to_vec(),
            Self::CoreXyz => separate_belts::corexyz(4),
            Self::CoreXyzThree => separate_belts::corexyz(3),
            Self::Own(own) => own.belts(),
        }
    }

    /// Motor travel (in [`motors`](Self::motors)' order) that no rigid belt follows: it strains the belt.
    #[must_use]
    pub fn residuals(self) -> Vec<Vec<f64>> {
        match self {
            // The paper's equation 11.
            Self::CoreHBot => vec![vec![1.0, -1.0, 1.0, -1.0]],
            Self::HBot | Self::CoreXy | Self::CoreXyzThree => Vec::new(),
            // Motors 1 and 8 pull one belt, 4 and 11 the other.
            Self::AwdCoreXy => vec![vec![1.0, 0.0, -1.0, 0.0], vec![0.0, 1.0, 0.0, -1.0]],
            // A - B + C - D of Carlyle's table, in the order D, C, B, A.
            Self::CoreXyz => vec![vec![-1.0, 1.0, -1.0, 1.0]],
            Self::Own(own) => own.residuals(),
        }
    }

    /// All stops, belt after belt.
    #[must_use]
    pub fn stops(self) -> Vec<Stop> {
        self.belts().iter().flat_map(|belt| belt.stops.iter().copied()).collect()
    }

    /// Names of all spans, belt after belt.
    #[must_use]
    pub fn span_names(self) -> Vec<&'static str> {
        self.belts().iter().flat_map(|belt| belt.spans.iter().copied()).collect()
    }

    /// Its motors' numbers, ascending.
    #[must_use]
    pub fn motors(self) -> Vec<u8> {
        let mut motors: Vec<u8> = self.stops().iter().filter_map(Stop::motor).collect();
        motors.sort_unstable();
        motors
    }

    /// Place of a motor in the order of the motors' numbers.
    #[must_use]
    pub fn index_of(self, motor: u8) -> usize {
        self.motors().iter().position(|number| *number == motor).unwrap_or_default()
    }

    /// Whether belts move the tool in z.
    #[must_use]
    pub fn lifts(self) -> bool {
        match self {
            Self::CoreXyz | Self::CoreXyzThree => true,
            Self::Own(own) => own.lifts(),
            _ => false,
        }
    }

    /// Axes that belts move: x and y, or x, y and z.
    #[must_use]
    pub fn axes(self) -> usize {
        2 + usize::from(self.lifts())
    }

    /// Whether its bar moves in y on two guides, on which it may yaw.
    #[must_use]
    pub const fn has_yawing_bar(self) -> bool {
        !matches!(self, Self::Own(Own { has_moving_bed: true, .. }))
    }

    /// Mass in kg of all that moves on the frame.
    #[must_use]
    pub fn carried_kg(self, params: &Params) -> f64 {
        let [_, along_y, up] = self.masses_kg(params);
        match self {
            Self::Own(own) if own.has_moving_bed => along_y + up,
            _ if self.lifts() => up,
            _ => along_y,
        }
    }

    /// Mass in kg that moves along x, y and z.
    #[must_use]
    pub fn masses_kg(self, params: &Params) -> [f64; 3] {
        let Params { head_mass_kg: head, bar_mass_kg: bar, gantry_mass_kg: gantry, bed_mass_kg: bed, .. } = *params;
        match self {
            Self::Own(own) if own.has_moving_bed => [head, bed, head + bar],
            _ => [head, head + bar, head + bar + gantry],
        }
    }
}
