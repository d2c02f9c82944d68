//! Settings that lines change: each value is brought into its legal range, and following moves
//! obey.

use super::shown::{Setting, exact};
use crate::gcode::{AxisWords, Number, VelocityWords};
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::port::Pend;
use crate::settings::{AxisSettings, CornerRule, Range, Settings, ranges};
use crate::units::{MmPerSec, Ratio, StepsPerMm, mul_div};

/// Every axis that a line names, with its letter and its value.
fn named<'a>(
    s: &'a mut Settings,
    words: &AxisWords,
) -> impl Iterator<Item = (&'a mut AxisSettings, &'static str, Number)> {
    let a = &mut s.axes;
    [(&mut a.x, "X", words.x), (&mut a.y, "Y", words.y), (&mut a.z, "Z", words.z), (&mut a.e, "E", words.e)]
        .into_iter()
        .filter_map(|(axis, letter, word)| word.map(|n| (axis, letter, n)))
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

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M201.
    pub(in crate::machine) fn set_max_acceleration(&mut self, words: &AxisWords) -> Answer<'static> {
        if *words == AxisWords::default() {
            return Setting::MaxAccelerations.answer();
        }
        let Self { settings, clamps, modal, .. } = self;
        for (axis, letter, number) in named(settings, words) {
            axis.max_acceleration = clamps.length(modal, ["M201", letter], number, ranges::ACCELERATION);
        }
        Answer::Nothing
    }

    /// M203.
    pub(in crate::machine) fn set_max_speed(&mut self, words: &AxisWords) -> Answer<'static> {
        if *words == AxisWords::default() {
            return Setting::MaxSpeeds.answer();
        }
        let Self { settings, clamps, modal, .. } = self;
        for (axis, letter, number) in named(settings, words) {
            let most = ranges::SPEED.most.min(fastest(axis.steps_per_mm));
            axis.max_speed = clamps.length(modal, ["M203", letter], number, Range { most, ..ranges::SPEED });
        }
        Answer::Nothing
    }

    /// M92. The machine comes to rest first: a step must not change its size under way.
    pub(in crate::machine) async fn set_resolution(&mut self, words: &AxisWords) -> Result<Answer<'static>, Interrupt> {
        if *words == AxisWords::default() {
            return Ok(Setting::Resolutions.answer());
        }
        let mut wanted = self.settings;
        let before = wanted;
        for (axis, letter, number) in named(&mut wanted, words) {
            axis.steps_per_mm = self.clamps.plain(["M92", letter], number, ranges::STEPS_PER_MM);
            axis.max_speed = axis.max_speed.min(fastest(axis.steps_per_mm));
        }
        if let Err(axes) = wanted.check_shared_motors() {
            self.clamps.clear();
            return Ok(Answer::SharedMotors(axes));
        }
        let belt = fastest(wanted.axes.x.steps_per_mm.max(wanted.axes.y.steps_per_mm));
        wanted.motor_max_speed = wanted.motor_max_speed.min(belt);
        let speeds = |s: &Settings| (s.axes.map(|a| a.max_speed), s.motor_max_speed);
        if speeds(&wanted) != speeds(&before) {
            self.tell(Answer::LoweredSpeeds).await?;
        }
        self.finish().await?;
        self.use_settings(wanted).await?;
        Ok(Answer::Nothing)
    }

    /// M204.
    pub(in crate::machine) fn set_acceleration(
        &mut self,
        print: Option<Number>,
        retract: Option<Number>,
        travel: Option<Number>,
    ) -> Answer<'static> {
        if print.or(retract).or(travel).is_none() {
            return Setting::Accelerations.answer();
        }
        let Self { settings: s, clamps, modal, .. } = self;
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
    pub(in crate::machine) fn set_corners(&mut self, words: &CornerWords) -> Answer<'static> {
        let CornerWords { deviation, jerk, min_feed, min_travel, min_segment } = *words;
        if deviation.or(min_feed).or(min_travel).or(min_segment).is_none() && jerk == AxisWords::default() {
            return Setting::Corners.answer();
        }
        let Self { settings: s, clamps, modal, .. } = self;
        if let Some(number) = deviation {
            s.corner = CornerRule::JunctionDeviation(clamps.length(modal, ["M205", "J"], number, ranges::TOLERANCE));
        } else if let Some((number, letter)) =
            jerk.x.map(|x| (x, "X")).into_iter().chain(jerk.y.map(|y| (y, "Y"))).min()
        {
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
        if !(is_doubtful || is_unused) || core::mem::replace(&mut self.told_of_corners, true) {
            return Answer::Nothing;
        }
        Answer::Line("echo:M205: one value for X and Y, the lesser, or J instead; Z and B are not used")
    }

    /// SET_VELOCITY_LIMIT, in mm whatever G20 says. Klipper has one acceleration, and the way to brake was a word of its
    /// own before there was the ratio (klippy/toolhead.py).
    pub(in crate::machine) fn set_velocity_limit<'a>(&mut self, words: &VelocityWords<'a>) -> Answer<'a> {
        const NAME: &str = "SET_VELOCITY_LIMIT";
        if *words == VelocityWords::default() {
            return Setting::VelocityLimit.answer();
        }
        let Self { settings: s, clamps, .. } = self;
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
    pub(in crate::machine) fn set_keepalive(&mut self, seconds: Option<Number>) -> Answer<'static> {
        let Some(seconds) = seconds else { return Answer::Keepalive };
        self.settings.keepalive_s = self.clamps.whole(["M113", "S"], seconds, Range { least: 0, most: 60 }) as u8;
        Answer::Nothing
    }
}
