//! Firmware retraction: G10 pulls the filament back and lifts the tool, G11 undoes it.
//!
//! The program does not see it. Its commanded positions keep their meaning, and the machine stays away from them by a
//! lift and a length of filament (as in Marlin, fwretract.cpp). M500 does not keep the values of M207 and M208.
//!
//! Four events end a retraction: G28, M84 of the extruder, the end of a print and the next print forget it. The
//! filament then stays where it is, and counts as commanded.

use crate::units::{Mm, MmPerSec};

/// How G10 and G11 retract: M207, M208.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct RetractionSettings {
    pub length: Mm,
    pub speed: MmPerSec,
    pub lift: Mm,
    pub extra: Mm,
    pub recover_speed: MmPerSec,
}

impl RetractionSettings {
    /// Marlin's values (Configuration_adv.h, RETRACT_LENGTH and those below it).
    pub const fn new() -> Self {
        Self {
            length: Mm::const_from_int(3),
            speed: MmPerSec::const_from_int(45),
            lift: Mm::ZERO,
            extra: Mm::ZERO,
            recover_speed: MmPerSec::const_from_int(8),
        }
    }
}

/// Whether the filament is retracted.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Retraction {
    /// The lift of the tool above the commanded position, and the length of filament pulled back from it.
    away: Option<[Mm; 2]>,
}

/// A move of the machine alone: its distance from the commanded position at its end, and its speed.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct RetractionMove {
    away: [Mm; 2],
    pub speed: MmPerSec,
}

impl Retraction {
    /// The filament is where the program wants it.
    pub const fn new() -> Self {
        Self { away: None }
    }

    /// Where the machine goes for a commanded position.
    #[inline(never)]
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
    pub fn moves_away(&self, settings: &RetractionSettings, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        let (lift, length) = (settings.lift, settings.length);
        let moves = [
            RetractionMove { away: [Mm::ZERO, length], speed: settings.speed },
            RetractionMove { away: [lift, length], speed: z_speed },
        ];
        self.away.is_none().then_some(moves)
    }

    /// G11: the lift first, then the filament.
    pub fn moves_back(&self, settings: &RetractionSettings, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        let [_, length] = self.away?;
        let recovered = RetractionMove { away: [Mm::ZERO, -settings.extra], speed: settings.recover_speed };
        Some([RetractionMove { away: [Mm::ZERO, length], speed: z_speed }, recovered])
    }

    /// Where the machine stands after that move.
    pub fn after(&self, step: RetractionMove, commanded: [Mm; 4]) -> [Mm; 4] {
        Self { away: Some(step.away) }.away_from(commanded)
    }

    /// That move is planned.
    pub const fn note_planned(&mut self, step: RetractionMove) {
        self.away = Some(step.away);
    }

    /// The filament that was recovered in addition, which counts as commanded. `None` if some is still retracted.
    pub fn take_extra(&mut self) -> Option<Mm> {
        let [lift, length] = self.away.filter(|[_, length]| *length <= Mm::ZERO)?;
        self.away = (lift > Mm::ZERO).then_some([lift, Mm::ZERO]);
        Some(-length)
    }

    /// The lift of the tool, and the length of filament pulled back.
    pub fn away(&self) -> [Mm; 2] {
        self.away.unwrap_or_default()
    }
}
