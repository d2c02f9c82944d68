//! Routing: the run of a machine's belt, as a table.
//!
//! A belt is the row of its stops in the direction that turns motors counter-clockwise. A stop is a pulley, or the
//! clamp that holds the belt on the head. Places are sums of the machine's dimensions, so a table holds for any size.
//! The place determines what a stop moves with: the head if its x follows the tool, the bar if only its y does, and the
//! frame otherwise.
//!
//! Tables: `corehbot` (figures 5 and 6c of the CoreH-bot paper), `hbot` (figure 6a), `corexy` (figure 6b, and the same
//! with a motor at each end of its belts).

mod corehbot;
mod corexy;
mod hbot;
mod stop;

pub use stop::{Along, Block, Mark, Place, Role, Side, Stop};

/// A belt: its stops in the direction of travel.
#[derive(Clone, Copy, Debug)]
pub struct Belt {
    /// The stops. A belt without clamps is closed: the first stop follows the last. Otherwise the first and last are
    /// clamps.
    pub stops: &'static [Stop],
    /// Names of the spans between motors and clamps, from the first of them on.
    pub spans: &'static [&'static str],
}

impl Belt {
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
}

impl Machine {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::CoreHBot, Self::HBot, Self::CoreXy, Self::AwdCoreXy];

    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::CoreHBot => "CoreH-bot",
            Self::HBot => "H-bot",
            Self::CoreXy => "CoreXY",
            Self::AwdCoreXy => "AWD CoreXY",
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
        }
    }

    /// Its belts.
    #[must_use]
    pub const fn belts(self) -> &'static [Belt] {
        match self {
            Self::CoreHBot => &[corehbot::BELT],
            Self::HBot => &[hbot::BELT],
            Self::CoreXy => &corexy::BELTS,
            Self::AwdCoreXy => &corexy::AWD_BELTS,
        }
    }

    /// Motor travel (in [`motors`](Self::motors)' order) that no rigid belt follows: it strains the belt.
    #[must_use]
    pub const fn residuals(self) -> &'static [&'static [f64]] {
        match self {
            // The paper's equation 11.
            Self::CoreHBot => &[&[1.0, -1.0, 1.0, -1.0]],
            Self::HBot | Self::CoreXy => &[],
            // Motors 1 and 8 pull one belt, 4 and 11 the other.
            Self::AwdCoreXy => &[&[1.0, 0.0, -1.0, 0.0], &[0.0, 1.0, 0.0, -1.0]],
        }
    }

    /// All stops, belt after belt.
    pub fn stops(self) -> impl Iterator<Item = &'static Stop> {
        self.belts().iter().flat_map(|belt| belt.stops)
    }

    /// Its motors' numbers, ascending.
    #[must_use]
    pub fn motors(self) -> Vec<u8> {
        let mut motors: Vec<u8> = self.stops().filter_map(Stop::motor).collect();
        motors.sort_unstable();
        motors
    }
}
