//! Settings as lines set them: all values of a line if each is legal, otherwise none, and following moves obey.
//!
//! Plain functions on [`LiveSettings`]: each changes a copy and puts it back. M92 alone needs the machine at rest.

use crate::gcode::{AxisWords, CornerWords, Number, VelocityWords};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::settings::LiveSettings;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::{Notice, Notices};
use crate::machine::state::program::Dynamics;
use crate::port::Pend;
use crate::settings::{Axes, AxisSettings, CornerRule, Range, Settings, ranges};
use crate::units::{MmPerSec, MmPerSec2, Ratio, mul_div};

/// Every axis that a line names, with its letter, its value, and its number.
fn named<'a>(
    a: &'a mut Axes<AxisSettings>,
    words: &AxisWords,
) -> impl Iterator<Item = (&'a mut AxisSettings, &'static str, Number, usize)> {
    [(&mut a.x, "X", words.x), (&mut a.y, "Y", words.y), (&mut a.z, "Z", words.z), (&mut a.e, "E", words.e)]
        .into_iter()
        .enumerate()
        .filter_map(|(place, (axis, letter, word))| word.map(|n| (axis, letter, n, place)))
}

/// Side effects of M92 on other settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Resolved {
    /// Nothing.
    Resolutions,
    /// Speed limits too, because the step rate of a motor is limited.
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
    for (axis, letter, number, place) in named(&mut s.axes, words) {
        // The motor that makes the most steps of the axis has the same range.
        let times = mechanism.most_times(place).max(1).unsigned_abs();
        let range = Range { most: ranges::STEPS_PER_MM.most / u32::from(times), ..ranges::STEPS_PER_MM };
        clamps.plain(["M92", letter], number, range, &mut axis.steps_per_mm);
    }
    s.check_shared_motors()?;
    let most = [0, 1, 2, 3].map(|axis| ranges::STEP_RATE / s.finest(axis));
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
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    words: &AxisWords,
) -> Result<Answer<'static>, Interrupt> {
    if *words == AxisWords::default() {
        return Ok(Answer::Setting(Setting::Resolutions));
    }
    let mut wanted = *main_loop.settings;
    let resolved = set_resolution(words, &mut wanted, clamps);
    if clamps.refuses_line() {
        return Ok(Answer::Nothing);
    }
    match resolved {
        Ok(Resolved::Resolutions) => {}
        Ok(Resolved::LoweredSpeeds) => main_loop.reply(Answer::LoweredSpeeds).await?,
        Err(axes) => return Ok(Answer::SharedMotors(axes)),
    }
    main_loop.finish().await?;
    main_loop.use_settings(wanted).await?;
    Ok(Answer::Nothing)
}

/// M205. J sets junction deviation. A jerk of X or Y without J is a square-corner velocity, because a corner of 90
/// degrees changes the speed of each axis by exactly that.
pub(in crate::machine) fn set_corners(
    words: &CornerWords,
    s: &mut LiveSettings<'_>,
    modal: &Modal,
    clamps: &mut Clamps,
    notices: &mut Notices,
) -> Answer<'static> {
    let CornerWords { deviation, jerk, min_feed, min_travel, min_segment } = *words;
    if deviation.or(min_feed).or(min_travel).or(min_segment).is_none() && jerk == AxisWords::default() {
        return Answer::Setting(Setting::Corners);
    }
    let mut corner = None;
    if let Some(number) = deviation {
        let old = if let CornerRule::JunctionDeviation(old) = s.corner { Some(old) } else { None };
        let legal = clamps.length_of(modal, ["M205", "J"], number, ranges::TOLERANCE, old);
        corner = legal.map(CornerRule::JunctionDeviation);
    } else if let Some((number, letter)) = jerk.x.map(|x| (x, "X")).into_iter().chain(jerk.y.map(|y| (y, "Y"))).min() {
        let old = if let CornerRule::SquareCorner(old) = s.corner { Some(old) } else { None };
        let legal = clamps.length_of(modal, ["M205", letter], number, ranges::SPEED, old);
        corner = legal.map(CornerRule::SquareCorner);
    }
    let from_zero = Range { least: MmPerSec::ZERO, ..ranges::SPEED };
    let mut wanted = Dynamics::of(s);
    let words = [("E", jerk.e, ranges::SPEED), ("S", min_feed, from_zero), ("T", min_travel, from_zero)];
    for (place, (letter, number, range)) in wanted.speeds.iter_mut().zip(words) {
        if let Some(number) = number {
            clamps.length(modal, ["M205", letter], number, range, place);
        }
    }
    if clamps.refuses_line() {
        return Answer::Nothing;
    }
    wanted.corner = corner.unwrap_or(wanted.corner);
    s.set_dynamics(&wanted);
    let is_doubtful = jerk.x.zip(jerk.y).is_some_and(|(x, y)| x != y) || deviation.and(jerk.x.or(jerk.y)).is_some();
    let is_unused = jerk.z.or(min_segment).is_some();
    if !(is_doubtful || is_unused) || !notices.give(Notice::Corners) {
        return Answer::Nothing;
    }
    Answer::Line("echo:M205: one value for X and Y, the lesser, or J instead; Z and B are not used")
}

/// SET_VELOCITY_LIMIT, always in mm, even after G20. Klipper has one acceleration, and braking had its own word before
/// there was the ratio (klippy/toolhead.py).
pub(in crate::machine) fn set_velocity_limit<'a>(
    words: &VelocityWords<'a>,
    s: &mut LiveSettings<'_>,
    clamps: &mut Clamps,
) -> Answer<'a> {
    const NAME: &str = "SET_VELOCITY_LIMIT";
    if *words == VelocityWords::default() {
        return Answer::Setting(Setting::VelocityLimit);
    }
    let mut dynamics = Dynamics::of(s);
    let [mut acceleration, retract, travel] = dynamics.accelerations;
    if let Some(number) = words.acceleration {
        clamps.plain([NAME, "ACCEL="], number, ranges::ACCELERATION, &mut acceleration);
    }
    let square_corner = words.square_corner.and_then(|number| {
        let old = if let CornerRule::SquareCorner(old) = s.corner { Some(old) } else { None };
        clamps.plain_of([NAME, "SQUARE_CORNER_VELOCITY="], number, ranges::SPEED, old)
    });
    let mut cruise_ratio = dynamics.cruise_ratio;
    if let Some(number) = words.cruise_ratio {
        clamps.near([NAME, "MINIMUM_CRUISE_RATIO="], number, ranges::CRUISE_RATIO, &mut cruise_ratio);
    } else if let Some(number) = words.to_deceleration {
        // As an acceleration the ratio is the missing part of ACCEL; more than all of ACCEL gives 0.
        let one = u64::from(Ratio::ONE.to_bits());
        let whole = u64::from(acceleration.to_bits());
        let missing = |ratio: Ratio| mul_div(whole, one.saturating_sub(u64::from(ratio.to_bits())), one) as u32;
        let [least, mut wanted] = [ranges::CRUISE_RATIO.most, cruise_ratio].map(missing).map(MmPerSec2::from_bits);
        let range = Range { least: least.max(ranges::ACCELERATION.least), ..ranges::ACCELERATION };
        clamps.plain([NAME, "ACCEL_TO_DECEL="], number, range, &mut wanted);
        let part = mul_div(one, u64::from(wanted.to_bits()), whole);
        cruise_ratio = ranges::CRUISE_RATIO.clamp(Ratio::from_bits(one.saturating_sub(part) as u32));
    }
    if clamps.refuses_line() {
        return Answer::Nothing;
    }
    let travel = if words.acceleration.is_some() { acceleration } else { travel };
    dynamics.accelerations = [acceleration, retract, travel];
    dynamics.corner = square_corner.map_or(dynamics.corner, CornerRule::SquareCorner);
    dynamics.cruise_ratio = cruise_ratio;
    s.set_dynamics(&dynamics);
    words.other.map_or(Answer::Nothing, |other| Answer::NotObeyed(NAME, other))
}
