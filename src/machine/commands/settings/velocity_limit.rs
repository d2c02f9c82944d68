//! SET_VELOCITY_LIMIT: limits in Klipper's words.

use crate::gcode::VelocityWords;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::main_loop::settings::LiveSettings;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::program::Dynamics;
use crate::settings::{CornerRule, Range, ranges};
use crate::units::{MmPerSec2, Ratio, mul_div};

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
