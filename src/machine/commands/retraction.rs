//! Firmware retraction: G10 pulls the filament back and lifts the tool, G11 undoes it.
//!
//! The program knows nothing of it: what it commands goes on meaning the same, and the machine stays away from it by
//! a lift and a length of filament (as in Marlin, fwretract.cpp). M500 does not keep what M207 and M208 set.

use super::settings::shown::Setting;
use crate::gcode::Number;
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::Range;
use crate::units::{Mm, MmPerSec};

/// The longest retraction and the highest lift: bowden tubes ask for less than a tenth of it.
const LENGTH: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// How G10 and G11 retract, and whether the filament is.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Retraction {
    pub length: Mm,
    pub speed: MmPerSec,
    pub lift: Mm,
    pub extra: Mm,
    pub recover_speed: MmPerSec,
    /// How far the tool is above and the filament behind the commanded position.
    away: Option<[Mm; 2]>,
}

/// A way of the machine alone: how far it is away from the commanded position then, and how fast it goes there.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Way {
    away: [Mm; 2],
    speed: MmPerSec,
}

impl Retraction {
    /// Marlin's values (Configuration_adv.h, RETRACT_LENGTH and those below it).
    pub const fn new() -> Self {
        Self {
            length: Mm::const_from_int(3),
            speed: MmPerSec::const_from_int(45),
            lift: Mm::ZERO,
            extra: Mm::ZERO,
            recover_speed: MmPerSec::const_from_int(8),
            away: None,
        }
    }

    /// Where the machine goes for a commanded position.
    pub fn away_from(&self, position: [Mm; 4]) -> [Mm; 4] {
        let [x, y, z, e] = position;
        let [lift, length] = self.away.unwrap_or_default();
        [x, y, z.saturating_add(lift), e.wrapping_sub(length)]
    }

    /// The commanded position of a machine that stands there.
    pub fn commanded(&self, position: [Mm; 4]) -> [Mm; 4] {
        let [x, y, z, e] = position;
        let [lift, length] = self.away.unwrap_or_default();
        [x, y, z.saturating_sub(lift), e.wrapping_add(length)]
    }

    /// G10: the filament first, then the lift. Nothing if that was done.
    pub fn ways_away(&self, z_speed: MmPerSec) -> Option<[Way; 2]> {
        let (lift, length) = (self.lift, self.length);
        let ways = [Way { away: [Mm::ZERO, length], speed: self.speed }, Way { away: [lift, length], speed: z_speed }];
        self.away.is_none().then_some(ways)
    }

    /// G11: the lift first, then the filament.
    pub fn ways_back(&self, z_speed: MmPerSec) -> Option<[Way; 2]> {
        let [_, length] = self.away?;
        let recovered = Way { away: [Mm::ZERO, -self.extra], speed: self.recover_speed };
        Some([Way { away: [Mm::ZERO, length], speed: z_speed }, recovered])
    }

    /// Z was homed, so its lift is gone.
    pub fn forget_lift(&mut self) {
        if let Some([lift, _]) = &mut self.away {
            *lift = Mm::ZERO;
        }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// G10 and G11: plans ways away from the commanded position, or back to it.
    pub(in crate::machine) async fn stay_away(&mut self, ways: Option<[Way; 2]>) -> Result<(), Interrupt> {
        for Way { away, speed } in ways.into_iter().flatten() {
            let position = Retraction { away: Some(away), ..self.retraction }.away_from(self.modal.position);
            self.plan(Target { position, speed, has_overrides: false, watch: EndstopSet::NONE }).await?;
            self.retraction.away = Some(away);
        }
        if let Some([lift, length]) = self.retraction.away.filter(|[_, length]| *length <= Mm::ZERO) {
            // What was pushed in addition is filament that was asked for.
            let [_, _, _, e] = &mut self.modal.position;
            *e = e.wrapping_sub(length);
            self.retraction.away = (lift > Mm::ZERO).then_some([lift, Mm::ZERO]);
        }
        Ok(())
    }

    /// M207. A filament that is retracted is recovered as far as it was retracted.
    pub(in crate::machine) fn set_retraction(
        &mut self,
        length: Option<Number>,
        feed: Option<Number>,
        lift: Option<Number>,
    ) -> Answer<'static> {
        if length.or(feed).or(lift).is_none() {
            return Setting::Retraction.answer();
        }
        if let Some(length) = length {
            self.retraction.length = self.clamps.length(&self.modal, ["M207", "S"], length, LENGTH);
        }
        if let Some(feed) = feed {
            self.retraction.speed = self.clamps.speed_a_minute(&self.modal, ["M207", "F"], feed);
        }
        if let Some(lift) = lift {
            self.retraction.lift = self.clamps.length(&self.modal, ["M207", "Z"], lift, LENGTH);
        }
        Answer::Nothing
    }

    /// M208.
    pub(in crate::machine) fn set_recovery(&mut self, extra: Option<Number>, feed: Option<Number>) -> Answer<'static> {
        if extra.or(feed).is_none() {
            return Setting::Recovery.answer();
        }
        if let Some(extra) = extra {
            self.retraction.extra = self.clamps.length(&self.modal, ["M208", "S"], extra, LENGTH);
        }
        if let Some(feed) = feed {
            self.retraction.recover_speed = self.clamps.speed_a_minute(&self.modal, ["M208", "F"], feed);
        }
        Answer::Nothing
    }
}
