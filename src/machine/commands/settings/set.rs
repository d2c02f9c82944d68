//! Settings as lines set them: each value is brought into its legal range, and following moves obey.
//!
//! Plain functions on the settings; M92 alone needs the machine at rest.

use crate::gcode::{AxisWords, Number, VelocityWords};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::numbers::exact;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::{Notice, Notices};
use crate::port::Pend;
use crate::settings::{AxisSettings, CornerRule, Range, Settings, ranges};
use crate::units::{MmPerSec, Ratio, StepsPerMm, mul_div};

/// Every axis that a line names, with its letter, its value, and its number.
fn named<'a>(
    s: &'a mut Settings,
    words: &AxisWords,
) -> impl Iterator<Item = (&'a mut AxisSettings, &'static str, Number, usize)> {
    let a = &mut s.axes;
    [(&mut a.x, "X", words.x), (&mut a.y, "Y", words.y), (&mut a.z, "Z", words.z), (&mut a.e, "E", words.e)]
        .into_iter()
        .enumerate()
        .filter_map(|(place, (axis, letter, word))| word.map(|n| (axis, letter, n, place)))
}

/// The words of M205.
pub(in crate::machine) struct CornerWords {
    pub deviation: Option<Number>,
    pub jerk: AxisWords,
    pub min_feed: Option<Number>,
    pub min_travel: Option<Number>,
    pub min_segment: Option<Number>,
}

/// The fastest legal speed of an axis of that resolution.
fn fastest(steps_per_mm: StepsPerMm) -> MmPerSec {
    let bits = (u64::from(ranges::STEP_RATE) << 32) / u64::from(steps_per_mm.to_bits().max(1));
    MmPerSec::from_bits(bits.min(u64::from(u32::MAX)) as u32)
}

/// M201.
pub(in crate::machine) fn set_max_acceleration(
    words: &AxisWords,
    s: &mut Settings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if *words == AxisWords::default() {
        return Answer::Setting(Setting::MaxAccelerations);
    }
    for (axis, letter, number, _) in named(s, words) {
        axis.max_acceleration = clamps.length(modal, ["M201", letter], number, ranges::ACCELERATION);
    }
    Answer::Nothing
}

/// M203.
pub(in crate::machine) fn set_max_speed(
    words: &AxisWords,
    s: &mut Settings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if *words == AxisWords::default() {
        return Answer::Setting(Setting::MaxSpeeds);
    }
    let finest = [0, 1, 2, 3].map(|axis| s.finest(axis));
    for (axis, letter, number, place) in named(s, words) {
        let most = ranges::SPEED.most.min(fastest(finest[place]));
        axis.max_speed = clamps.length(modal, ["M203", letter], number, Range { most, ..ranges::SPEED });
    }
    Answer::Nothing
}

/// What M92 has changed beside the resolutions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Resolved {
    /// Nothing.
    Resolutions,
    /// Speed limits too, for a motor makes so many steps a second at most.
    LoweredSpeeds,
}

/// M92.
///
/// # Errors
/// The axes that would share motors and have different steps.
fn set_resolution(words: &AxisWords, s: &mut Settings, clamps: &mut Clamps) -> Result<Resolved, &'static str> {
    let speeds = |s: &Settings| (s.axes.map(|a| a.max_speed), s.motor_max_speed);
    let before = speeds(s);
    let mechanism = s.mechanism;
    for (axis, letter, number, place) in named(s, words) {
        // The motor that makes the most steps of the axis has the same range.
        let times = mechanism.most_times(place).max(1).unsigned_abs();
        let range = Range { most: ranges::STEPS_PER_MM.most / StepsPerMm::from_num(times), ..ranges::STEPS_PER_MM };
        axis.steps_per_mm = clamps.plain(["M92", letter], number, range);
    }
    s.check_shared_motors()?;
    let most = [0, 1, 2, 3].map(|axis| fastest(s.finest(axis)));
    let [x, y, z, e] = most;
    let a = &mut s.axes;
    for (axis, most) in [(&mut a.x, x), (&mut a.y, y), (&mut a.z, z), (&mut a.e, e)] {
        axis.max_speed = axis.max_speed.min(most);
    }
    let belt = x.min(y);
    s.motor_max_speed = s.motor_max_speed.min(belt);
    Ok(if speeds(s) == before { Resolved::Resolutions } else { Resolved::LoweredSpeeds })
}

/// M92. The machine comes to rest first: a step must not change its size under way.
pub(in crate::machine) async fn change_resolution<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    clamps: &mut Clamps,
    words: &AxisWords,
) -> Result<Answer<'static>, Interrupt> {
    if *words == AxisWords::default() {
        return Ok(Answer::Setting(Setting::Resolutions));
    }
    let mut wanted = *crank.settings();
    match set_resolution(words, &mut wanted, clamps) {
        Ok(Resolved::Resolutions) => {}
        Ok(Resolved::LoweredSpeeds) => crank.tell(Answer::LoweredSpeeds).await?,
        Err(axes) => {
            clamps.clear();
            return Ok(Answer::SharedMotors(axes));
        }
    }
    crank.finish().await?;
    crank.use_settings(wanted).await?;
    Ok(Answer::Nothing)
}

/// M204.
pub(in crate::machine) fn set_acceleration(
    [print, retract, travel]: [Option<Number>; 3],
    s: &mut Settings,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if print.or(retract).or(travel).is_none() {
        return Answer::Setting(Setting::Accelerations);
    }
    for (place, letter, number) in [
        (&mut s.print_acceleration, "P", print),
        (&mut s.retract_acceleration, "R", retract),
        (&mut s.travel_acceleration, "T", travel),
    ] {
        if let Some(number) = number {
            *place = clamps.length(modal, ["M204", letter], number, ranges::ACCELERATION);
        }
    }
    Answer::Nothing
}

/// M205. J chooses junction deviation; a jerk of X or Y without J is a square-corner velocity, for a
/// corner of 90 degrees changes the speed of each axis by just that.
pub(in crate::machine) fn set_corners(
    words: &CornerWords,
    s: &mut Settings,
    modal: &Modal,
    clamps: &mut Clamps,
    notices: &mut Notices,
) -> Answer<'static> {
    let CornerWords { deviation, jerk, min_feed, min_travel, min_segment } = *words;
    if deviation.or(min_feed).or(min_travel).or(min_segment).is_none() && jerk == AxisWords::default() {
        return Answer::Setting(Setting::Corners);
    }
    if let Some(number) = deviation {
        s.corner = CornerRule::JunctionDeviation(clamps.length(modal, ["M205", "J"], number, ranges::TOLERANCE));
    } else if let Some((number, letter)) = jerk.x.map(|x| (x, "X")).into_iter().chain(jerk.y.map(|y| (y, "Y"))).min() {
        s.corner = CornerRule::SquareCorner(clamps.length(modal, ["M205", letter], number, ranges::SPEED));
    }
    if let Some(number) = jerk.e {
        s.extruder_jerk = clamps.length(modal, ["M205", "E"], number, ranges::SPEED);
    }
    let least = Range { least: MmPerSec::ZERO, ..ranges::SPEED };
    if let Some(number) = min_feed {
        s.min_feed = clamps.length(modal, ["M205", "S"], number, least);
    }
    if let Some(number) = min_travel {
        s.min_travel = clamps.length(modal, ["M205", "T"], number, least);
    }
    let is_doubtful = jerk.x.zip(jerk.y).is_some_and(|(x, y)| x != y) || deviation.and(jerk.x.or(jerk.y)).is_some();
    let is_unused = jerk.z.or(min_segment).is_some();
    if !(is_doubtful || is_unused) || !notices.give(Notice::Corners) {
        return Answer::Nothing;
    }
    Answer::Line("echo:M205: one value for X and Y, the lesser, or J instead; Z and B are not used")
}

/// SET_VELOCITY_LIMIT, in mm whatever G20 says. Klipper has one acceleration, and braking had a word of its own
/// before there was the ratio (klippy/toolhead.py).
pub(in crate::machine) fn set_velocity_limit<'a>(
    words: &VelocityWords<'a>,
    s: &mut Settings,
    clamps: &mut Clamps,
) -> Answer<'a> {
    const NAME: &str = "SET_VELOCITY_LIMIT";
    if *words == VelocityWords::default() {
        return Answer::Setting(Setting::VelocityLimit);
    }
    if let Some(number) = words.acceleration {
        s.print_acceleration = clamps.plain([NAME, "ACCEL="], number, ranges::ACCELERATION);
        s.travel_acceleration = s.print_acceleration;
    }
    if let Some(number) = words.square_corner {
        s.corner = CornerRule::SquareCorner(clamps.plain([NAME, "SQUARE_CORNER_VELOCITY="], number, ranges::SPEED));
    }
    if let Some(number) = words.cruise_ratio {
        s.minimum_cruise_ratio = clamps.near([NAME, "MINIMUM_CRUISE_RATIO="], number, ranges::CRUISE_RATIO);
    } else if let Some(number) = words.to_deceleration {
        let wanted = clamps.plain([NAME, "ACCEL_TO_DECEL="], number, ranges::ACCELERATION);
        let one = Ratio::ONE.to_bits();
        let part = mul_div(u64::from(one), u64::from(wanted.to_bits()), u64::from(s.print_acceleration.to_bits()));
        let ratio = Ratio::from_bits(one.saturating_sub(part.min(u64::from(one)) as u32));
        s.minimum_cruise_ratio = ranges::CRUISE_RATIO.clamp(ratio);
        if ratio > ranges::CRUISE_RATIO.most {
            clamps.note([NAME, "MINIMUM_CRUISE_RATIO="], exact(ratio), exact(ranges::CRUISE_RATIO.most));
        }
    }
    words.other.map_or(Answer::Nothing, |other| Answer::NotObeyed(NAME, other))
}

/// M113.
pub(in crate::machine) fn set_keepalive(
    seconds: Option<Number>,
    s: &mut Settings,
    clamps: &mut Clamps,
) -> Answer<'static> {
    let Some(seconds) = seconds else { return Answer::Keepalive };
    let Range { least, most } = ranges::KEEPALIVE_S;
    let legal = Range { least: least.into(), most: most.into() };
    s.keepalive_s = clamps.whole(["M113", "S"], seconds, legal) as u8;
    Answer::Nothing
}
