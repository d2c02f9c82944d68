//! Firmware retraction: G10 pulls the filament back and lifts the tool, G11 undoes it.
//!
//! The program knows nothing of it: what it commands goes on meaning the same, and the machine stays away from it by
//! a lift and a length of filament (as in Marlin, fwretract.cpp). M500 does not keep what M207 and M208 set.

use super::clamps::Clamps;
use super::setting::Setting;
use crate::gcode::Number;
use crate::machine::numbers::exact;
use crate::machine::reports::answer::Answer;
use crate::machine::reports::speaker::Speaker;
use crate::machine::state::modal::Modal;
use crate::settings::Range;
use crate::units::{Mm, MmPerSec};

/// The longest retraction and the highest lift: bowden tubes ask for less than a tenth of it.
const RETRACTION: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// How G10 and G11 retract, and whether the filament is.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Retraction {
    length: Mm,
    speed: MmPerSec,
    lift: Mm,
    extra: Mm,
    recover_speed: MmPerSec,
    /// How far the tool is lifted above the commanded position, and the filament pulled back from it.
    away: Option<[Mm; 2]>,
}

/// A move of the machine alone: how far the machine is away from the commanded position at its end, and its speed.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct RetractionMove {
    away: [Mm; 2],
    pub speed: MmPerSec,
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
    pub fn moves_away(&self, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        let (lift, length) = (self.lift, self.length);
        let moves = [
            RetractionMove { away: [Mm::ZERO, length], speed: self.speed },
            RetractionMove { away: [lift, length], speed: z_speed },
        ];
        self.away.is_none().then_some(moves)
    }

    /// G11: the lift first, then the filament.
    pub fn moves_back(&self, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        let [_, length] = self.away?;
        let recovered = RetractionMove { away: [Mm::ZERO, -self.extra], speed: self.recover_speed };
        Some([RetractionMove { away: [Mm::ZERO, length], speed: z_speed }, recovered])
    }

    /// Where the machine stands after that move.
    pub fn after(&self, step: RetractionMove, commanded: [Mm; 4]) -> [Mm; 4] {
        Self { away: Some(step.away), ..*self }.away_from(commanded)
    }

    /// That move is planned.
    pub const fn note_planned(&mut self, step: RetractionMove) {
        self.away = Some(step.away);
    }

    /// The filament that was recovered in addition, which counts as asked for. `None` if some is still retracted.
    pub fn take_extra(&mut self) -> Option<Mm> {
        let [lift, length] = self.away.filter(|[_, length]| *length <= Mm::ZERO)?;
        self.away = (lift > Mm::ZERO).then_some([lift, Mm::ZERO]);
        Some(-length)
    }

    /// Z was homed, so its lift is gone.
    pub fn forget_lift(&mut self) {
        if let Some([lift, _]) = &mut self.away {
            *lift = Mm::ZERO;
        }
    }

    /// M207. A filament that is retracted is recovered as far as it was retracted.
    pub fn set(
        &mut self,
        length: Option<Number>,
        feed: Option<Number>,
        lift: Option<Number>,
        modal: &Modal,
        clamps: &mut Clamps,
    ) -> Answer<'static> {
        if length.or(feed).or(lift).is_none() {
            return Answer::Setting(Setting::Retraction);
        }
        if let Some(length) = length {
            self.length = clamps.length(modal, ["M207", "S"], length, RETRACTION);
        }
        if let Some(feed) = feed {
            self.speed = clamps.speed_a_minute(modal, ["M207", "F"], feed);
        }
        if let Some(lift) = lift {
            self.lift = clamps.length(modal, ["M207", "Z"], lift, RETRACTION);
        }
        Answer::Nothing
    }

    /// M208.
    pub fn set_recovery(
        &mut self,
        extra: Option<Number>,
        feed: Option<Number>,
        modal: &Modal,
        clamps: &mut Clamps,
    ) -> Answer<'static> {
        if extra.or(feed).is_none() {
            return Answer::Setting(Setting::Recovery);
        }
        if let Some(extra) = extra {
            self.extra = clamps.length(modal, ["M208", "S"], extra, RETRACTION);
        }
        if let Some(feed) = feed {
            self.recover_speed = clamps.speed_a_minute(modal, ["M208", "F"], feed);
        }
        Answer::Nothing
    }

    /// M503, the line of M207.
    pub fn say(&self, to: &mut Speaker<'_>) {
        let (length, feed, lift) = (exact(self.length), exact(Mm::from(self.speed) * 60), exact(self.lift));
        to.say(format_args!("echo:  M207 S{length} F{feed} Z{lift}"));
    }

    /// M503, the line of M208.
    pub fn say_recovery(&self, to: &mut Speaker<'_>) {
        let (extra, feed) = (exact(self.extra), exact(Mm::from(self.recover_speed) * 60));
        to.say(format_args!("echo:  M208 S{extra} F{feed}"));
    }
}
