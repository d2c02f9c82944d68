//! Plan: the sweep that a line wants, and whether the machine can make it where the tool stands.

use crate::gcode::Number;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::{Thousandths, shortest};
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::motion::Sweep;
use crate::port::Wake;
use crate::settings::{HomedAxis, Range, Settings};
use crate::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, mul_div, part_of};
use core::fmt::{self, Display, Formatter};

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

impl SweepAxis {
    /// Its letter.
    pub const fn name(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::A => 'A',
            Self::B => 'B',
        }
    }
}

/// The words of TEST_RESONANCES and SHAPER_CALIBRATE.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct SweepWords {
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

/// Frequencies: below, a pulse is longer than the generator's longest span; above, the blocks have no vibration.
const FREQUENCY: Range<Hertz> = Range { least: Hertz::const_from_int(5), most: Hertz::const_from_int(150) };

/// Klipper's most (resonance_tester.py), and a sweep of an hour.
const HZ_PER_S: Range<Ratio> = Range { least: Ratio::lit("0.05"), most: Ratio::const_from_int(2) };

/// Acceleration for each Hz. With less the tool hardly moves.
const ACCEL_PER_HZ: Range<MmPerSec2> =
    Range { least: MmPerSec2::const_from_int(1), most: MmPerSec2::const_from_int(200) };

/// Acceleration of the swing.
const SWING: Range<MmPerSec2> = Range { least: MmPerSec2::ZERO, most: MmPerSec2::const_from_int(2000) };

/// Period of the swing.
const PERIOD: Range<Seconds> = Range { least: Seconds::ZERO, most: Seconds::const_from_int(10) };

/// 1 and the root of a half, times 2^16.
const WHOLE: i32 = 65_536;
const DIAGONAL: i32 = 46_341;

/// Parts of x and y in a mm along the axis, times 2^16: those of Klipper's TestAxis.
pub(in crate::machine) const fn parts_of(axis: SweepAxis) -> [i32; 2] {
    match axis {
        SweepAxis::X => [WHOLE, 0],
        SweepAxis::Y => [0, WHOLE],
        SweepAxis::A => [DIAGONAL, -DIAGONAL],
        SweepAxis::B => [DIAGONAL, DIAGONAL],
    }
}

/// The sweep that a line wants; Klipper's numbers where it names none. Words out of range are noted.
#[inline(never)]
pub(super) fn wanted(s: &Settings, words: &SweepWords, clamps: &mut Clamps) -> Sweep {
    const COMMAND: &str = "TEST_RESONANCES";
    let SweepWords { axis, from, to, accel_per_hz, hz_per_s, swing, period, .. } = *words;
    let steps = |part: i32, resolution: u32| {
        part_of(resolution.into(), part.unsigned_abs().into(), 1 << 16) as i32 * part.signum()
    };
    let [x, y] = parts_of(axis);
    let mut sweep = Sweep {
        from: Hertz::const_from_int(5),
        to: Hertz::const_from_int(135),
        accel_per_hz: MmPerSec2::const_from_int(60),
        hz_per_s: Ratio::ONE,
        swing: MmPerSec2::const_from_int(400),
        period: const { Seconds::lit("1.2") },
        brake: limit(s, axis),
        steps_per_mm: [steps(x, s.axes.x.steps_per_mm.to_bits()), steps(y, s.axes.y.steps_per_mm.to_bits())],
    };
    if let Some(number) = from {
        clamps.near([COMMAND, "FREQ_START="], number, FREQUENCY, &mut sweep.from);
    }
    if let Some(number) = to {
        let above = Range { least: sweep.from, ..FREQUENCY };
        clamps.near([COMMAND, "FREQ_END="], number, above, &mut sweep.to);
    }
    if let Some(number) = accel_per_hz {
        clamps.near([COMMAND, "ACCEL_PER_HZ="], number, ACCEL_PER_HZ, &mut sweep.accel_per_hz);
    }
    if let Some(number) = hz_per_s {
        clamps.near([COMMAND, "HZ_PER_SEC="], number, HZ_PER_S, &mut sweep.hz_per_s);
    }
    if let Some(number) = swing {
        clamps.near([COMMAND, "SWEEPING_ACCEL="], number, SWING, &mut sweep.swing);
    }
    if let Some(number) = period {
        clamps.near([COMMAND, "SWEEPING_PERIOD="], number, PERIOD, &mut sweep.period);
        if sweep.period == Seconds::ZERO {
            sweep.swing = MmPerSec2::ZERO;
        }
    }
    sweep
}

/// The most of a number with so many bits for the whole along an axis: its own two, and the motors'.
fn bounded(axis: SweepAxis, [of_x, of_y]: [u32; 2], of_motors: u32) -> u32 {
    let [x, y] = parts_of(axis);
    // A belt motor makes x, y, or both.
    let motor = (x - y).unsigned_abs().max((x + y).unsigned_abs());
    let mut least = u64::from(u32::MAX);
    for (most, part) in [(of_x, x.unsigned_abs()), (of_y, y.unsigned_abs()), (of_motors, motor)] {
        least = least.min(mul_div(most.into(), 1 << 16, part.into()));
    }
    least as u32
}

/// The acceleration that the machine allows along an axis, travels included.
fn limit(s: &Settings, axis: SweepAxis) -> MmPerSec2 {
    let axes = [s.axes.x.max_acceleration.to_bits(), s.axes.y.max_acceleration.to_bits()];
    let most = MmPerSec2::from_bits(bounded(axis, axes, s.motor_max_acceleration.to_bits()));
    most.min(s.travel_acceleration)
}

fn speed_limit(s: &Settings, axis: SweepAxis) -> MmPerSec {
    let axes = [s.axes.x.max_speed.to_bits(), s.axes.y.max_speed.to_bits()];
    MmPerSec::from_bits(bounded(axis, axes, s.motor_max_speed.to_bits()))
}

/// Keeps the sweep within the acceleration that the machine allows. Returns whether it is weaker than it was wanted;
/// `None` if not even the weakest is possible.
pub(super) fn weaken(sweep: &mut Sweep) -> Option<bool> {
    let room = sweep.brake.saturating_sub(sweep.swing);
    // Rounded down to whole mm/s^2: people read it.
    let most = room.to_num::<u32>() / sweep.to.to_bits().div_ceil(1 << Hertz::FRAC_NBITS).max(1);
    let most = MmPerSec2::from_num(most);
    let is_weaker = sweep.accel_per_hz > most;
    if is_weaker {
        sweep.accel_per_hz = most;
    }
    (most >= ACCEL_PER_HZ.least).then_some(is_weaker)
}

/// How far a sweep goes, and how fast.
#[derive(Clone, Copy)]
pub(super) struct Extremes {
    /// mm along the axis, times 2^32.
    back: i64,
    forth: i64,
    /// mm/s, times 2^32.
    speed: i64,
}

/// Pieces that a turn of the main loop reckons: about a millisecond.
const A_TURN: usize = 64;

/// Reckons how far a sweep goes.
pub(super) async fn extremes<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    sweep: &Sweep,
) -> Result<Extremes, Interrupt> {
    let mut all = Extremes { back: 0, forth: 0, speed: 0 };
    for (count, piece) in sweep.pieces().enumerate() {
        let end = piece.end;
        all.back = all.back.min(end.at);
        all.forth = all.forth.max(end.at);
        all.speed = all.speed.max(end.speed.abs());
        if count % A_TURN == 0 {
            main_loop.come_again();
            main_loop.poll().await?;
        }
    }
    Ok(all)
}

/// Why the machine cannot make a sweep from where the tool stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Refusal {
    /// The machine's limits allow nothing.
    TooWeak { limit: MmPerSec2 },
    /// The swing is faster than an axis may be.
    TooFast { speed: MmPerSec, most: MmPerSec },
    /// The sweep would leave the space that the tool reaches.
    NoRoom { axis: HomedAxis, least: Mm, most: Mm, reach: Range<Mm> },
}

impl Display for Refusal {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooWeak { limit } => {
                let limit = shortest(limit);
                put!(f, "the machine allows {limit} mm/s2, too little for it. Lower SWEEPING_ACCEL or FREQ_END")
            }
            Self::TooFast { speed, most } => {
                let (speed, most) = (speed.to_num::<u32>(), shortest(most));
                put!(f, "it reaches {speed} mm/s, the machine allows {most}. Lower SWEEPING_ACCEL")
            }
            Self::NoRoom { axis, least, most, reach } => {
                let axis = axis.letter();
                let [least, most, from, until] = [least, most, reach.least, reach.most].map(Thousandths);
                put!(
                    f,
                    "it takes {axis} from {least} to {most}, the tool reaches {from} to {until}. Move it to the middle \
                    first"
                )
            }
        }
    }
}

/// Whether the machine can make a sweep from where the tool stands; why not, if it cannot.
#[inline(never)]
pub(super) fn refusal<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    axis: SweepAxis,
    all: &Extremes,
) -> Option<Refusal> {
    let s: &Settings = &main_loop.settings;
    let most = speed_limit(s, axis);
    let speed = MmPerSec::from_bits((all.speed >> 16) as u32);
    if speed > most {
        return Some(Refusal::TooFast { speed, most });
    }
    let at = main_loop.motion.end_mm();
    for ((at, part), homed) in at.into_iter().zip(parts_of(axis)).zip([HomedAxis::X, HomedAxis::Y]) {
        let end = |way: i64| {
            let way = part_of(way, part.unsigned_abs().into(), 1 << 16) * i64::from(part.signum());
            at.saturating_add(Mm::from_bits(way))
        };
        let (a, b) = (end(all.back), end(all.forth));
        let (least, most) = (a.min(b), a.max(b));
        let reach = s.reach(homed);
        if part != 0 && (least < reach.least || most > reach.most) {
            return Some(Refusal::NoRoom { axis: homed, least, most, reach });
        }
    }
    None
}
