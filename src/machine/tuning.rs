//! Settings that lines change: each value is brought into its legal range, and following moves obey.

use super::answer::Answer;
use super::console::{Console, Interrupt, PortSet};
use super::setting::Setting;
use super::shaping::nearest;
use crate::gcode::{AxisWords, Number};
use crate::port::Pend;
use crate::settings::{AxisSettings, CornerRule, Settings, ranges};
use crate::units::{Mm, MmPerSec, MmPerSec2, StepsPerMm};

/// Every axis that a line names, with its value.
fn named<'a>(s: &'a mut Settings, words: &AxisWords) -> impl Iterator<Item = (&'a mut AxisSettings, Number)> {
    let a = &mut s.axes;
    [(&mut a.x, words.x), (&mut a.y, words.y), (&mut a.z, words.z), (&mut a.e, words.e)]
        .into_iter()
        .filter_map(|(axis, word)| word.map(|n| (axis, n)))
}

/// The fastest legal speed of an axis of that resolution.
fn fastest(steps_per_mm: StepsPerMm) -> MmPerSec {
    let bits = (u64::from(ranges::STEP_RATE) << 32) / u64::from(steps_per_mm.to_bits().max(1));
    MmPerSec::from_bits(bits.min(u64::from(u32::MAX)) as u32)
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    fn acceleration(&self, number: Number) -> MmPerSec2 {
        ranges::ACCELERATION.clamp(MmPerSec2::saturating_from_num(self.modal.length(number)))
    }

    /// M201.
    pub(super) fn set_max_acceleration(&mut self, words: &AxisWords) -> Answer<'static> {
        if *words == AxisWords::default() {
            return Setting::MaxAccelerations.answer();
        }
        let modal = self.modal;
        for (axis, number) in named(&mut self.settings, words) {
            let wanted = MmPerSec2::saturating_from_num(modal.length(number));
            axis.max_acceleration = ranges::ACCELERATION.clamp(wanted);
        }
        Answer::Nothing
    }

    /// M203.
    pub(super) fn set_max_speed(&mut self, words: &AxisWords) -> Answer<'static> {
        if *words == AxisWords::default() {
            return Setting::MaxSpeeds.answer();
        }
        let modal = self.modal;
        for (axis, number) in named(&mut self.settings, words) {
            axis.max_speed = modal.speed(number).min(fastest(axis.steps_per_mm));
        }
        Answer::Nothing
    }

    /// M92. The machine comes to rest first: a step must not change its size under way.
    pub(super) async fn set_resolution(&mut self, words: &AxisWords) -> Result<Answer<'static>, Interrupt> {
        if *words == AxisWords::default() {
            return Ok(Setting::Resolutions.answer());
        }
        let mut wanted = self.settings;
        let before = wanted;
        for (axis, number) in named(&mut wanted, words) {
            axis.steps_per_mm = ranges::STEPS_PER_MM.clamp(StepsPerMm::saturating_from_num(number.value()));
            axis.max_speed = axis.max_speed.min(fastest(axis.steps_per_mm));
        }
        if let Err(axes) = wanted.check_shared_motors() {
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
    pub(super) fn set_acceleration(
        &mut self,
        print: Option<Number>,
        retract: Option<Number>,
        travel: Option<Number>,
    ) -> Answer<'static> {
        if print.or(retract).or(travel).is_none() {
            return Setting::Accelerations.answer();
        }
        if let Some(number) = print {
            self.settings.print_acceleration = self.acceleration(number);
        }
        if let Some(number) = retract {
            self.settings.retract_acceleration = self.acceleration(number);
        }
        if let Some(number) = travel {
            self.settings.travel_acceleration = self.acceleration(number);
        }
        Answer::Nothing
    }

    /// M205. J chooses junction deviation; a jerk of X or Y without J is a square-corner velocity, for a
    /// corner of 90 degrees changes the speed of each axis by just that.
    pub(super) fn set_corners(
        &mut self,
        deviation: Option<Number>,
        jerk: &AxisWords,
        min_feed: Option<Number>,
        min_travel: Option<Number>,
    ) -> Answer<'static> {
        if deviation.or(min_feed).or(min_travel).is_none() && *jerk == AxisWords::default() {
            return Setting::Corners.answer();
        }
        if let Some(number) = deviation {
            let wanted: Mm = self.modal.length(number);
            self.settings.corner = CornerRule::JunctionDeviation(ranges::TOLERANCE.clamp(wanted));
        } else if let Some(number) = jerk.x.into_iter().chain(jerk.y).min() {
            self.settings.corner = CornerRule::SquareCorner(self.modal.speed(number));
        }
        if let Some(number) = jerk.e {
            self.settings.extruder_jerk = self.modal.speed(number);
        }
        let least = |modal: &super::modal::Modal, number: Number| {
            MmPerSec::saturating_from_num(modal.length(number)).min(ranges::SPEED.most)
        };
        if let Some(number) = min_feed {
            self.settings.min_feed = least(&self.modal, number);
        }
        if let Some(number) = min_travel {
            self.settings.min_travel = least(&self.modal, number);
        }
        Answer::Nothing
    }

    /// SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO.
    pub(super) fn set_cruise_ratio(&mut self, ratio: Option<Number>) -> Answer<'static> {
        let Some(ratio) = ratio else { return Setting::CruiseRatio.answer() };
        self.settings.minimum_cruise_ratio = ranges::CRUISE_RATIO.clamp(nearest(ratio));
        Answer::Nothing
    }

    /// M113.
    pub(super) fn set_keepalive(&mut self, seconds: Option<Number>) -> Answer<'static> {
        let Some(seconds) = seconds else { return Answer::Keepalive };
        self.settings.keepalive_s = seconds.to_u32().min(60) as u8;
        Answer::Nothing
    }
}
