//! The answers to resonance tests.

use crate::accelerometer::{SensorFault, SensorKind};
use crate::settings::{HomedAxis, Range, Shaper};
use crate::units::{Mm, MmPerSec, MmPerSec2};

/// The direction of a resonance test.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) enum SweepAxis {
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

/// A mode of the tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::machine) struct Mode {
    /// Hundredths of a Hz.
    pub centihertz: u32,
    /// Thousandths of critical damping.
    pub damping: u16,
    /// Thousandths by which the response differs from the mode's (root mean square).
    pub fit_error: u16,
}

/// A sample along the machine's axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::machine) struct RawSample {
    /// Its time in us.
    pub us: u32,
    /// mm/s^2 along x, y, z.
    pub axes: [i32; 3],
}

/// The shaper for the modes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::machine) struct Suggested {
    pub shaper: Shaper,
    /// What it leaves of the vibration.
    pub percent: u8,
    /// The acceleration at which it rounds corners by 0.12 mm.
    pub most: MmPerSec2,
}

/// What a resonance test found.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::machine) enum ResonanceAnswer {
    /// The machine has no accelerometer by its settings.
    NoSensor,
    /// The sweep was made, and no sensor listened.
    Swept(SweepAxis),
    /// The machine's limits allow less than was wanted.
    Weaker {
        accel_per_hz: MmPerSec2,
        limit: MmPerSec2,
    },
    /// They allow nothing.
    TooWeak {
        limit: MmPerSec2,
    },
    /// The swing is faster than an axis may be.
    TooFast {
        speed: MmPerSec,
        most: MmPerSec,
    },
    /// The sweep would leave the space that the tool reaches.
    NoRoom {
        axis: HomedAxis,
        least: Mm,
        most: Mm,
        reach: Range<Mm>,
    },
    /// The sensor failed.
    Failed(SensorKind, SensorFault),
    /// It is too noisy at rest: mm/s^2 along its x, y, z.
    Noisy(SensorKind, [u32; 3]),
    /// M955: the samples of a second, and the noise.
    Sensor {
        kind: SensorKind,
        rate: u32,
        noise: [u32; 3],
    },
    /// The first line of Klipper's raw data, and a sample of it.
    RawHead,
    Raw(RawSample),
    /// The modes, the highest peak first, and the shaper if there is to be one.
    Found {
        axis: SweepAxis,
        modes: [Option<Mode>; 2],
        shaper: Option<Suggested>,
    },
}
