//! The first layer: the offset of z, shifted while moves are under way (M290, SET_GCODE_OFFSET).
//!
//! `main_loop::z_offset` shifts it, the generator makes the steps (`motion::stepgen::z_offset`). SET_GCODE_OFFSET
//! changes the program's offset and no other. M290 changes that of the probe where it homes z, otherwise the program's.
//! Without P0 the change is kept over homing, and M500 stores it.

use super::moves::Moves;
use crate::gcode::{Number, OffsetWords};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::z_offset::{let_z_stand, shift_z, z_reach};
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::settings::{Range, Settings, ZStore, ranges};
use crate::units::Mm;

/// The most that one M290 shifts: more is a slip of the finger.
const MOST: Range<Mm> = Range { least: Mm::const_from_int(-2), most: Mm::const_from_int(2) };

/// Where the kept offset would be too large.
const TOO_FAR: Answer<'static> =
    Answer::Line(packed!("echo:ignored: the offset of Z would be out of range (-5 to 5 mm)"));

/// Where it, and what an order has let stand or homing takes back, would be.
const TOO_FAR_ASIDE: Answer<'static> =
    Answer::Line(packed!("echo:ignored: the shifts of Z since homing would exceed 5 mm"));

/// Whether an offset, changed by so much, is in the range of the setting that keeps it.
fn may_be_kept(s: &Settings, store: ZStore, by: Mm) -> bool {
    let range = if store == ZStore::Probe { ranges::PROBE_OFFSET_Z } else { ranges::Z_OFFSET };
    range.holds(s.z_offset(store).saturating_add(by))
}

/// Why z may not stand aside by so much more, or the kept offset not change so.
fn misfit<P: PortSet, W: Pend>(
    main_loop: &MainLoop<'_, P, W>,
    by: Mm,
    store: Option<ZStore>,
) -> Option<Answer<'static>> {
    let s = &main_loop.settings;
    if store.is_some_and(|store| !may_be_kept(s, store, by)) {
        return Some(TOO_FAR);
    }
    let aside = main_loop.first_layer.aside(s).saturating_add(by);
    (!ranges::Z_OFFSET.holds(aside)).then_some(TOO_FAR_ASIDE)
}

impl<P: PortSet, W: Pend> Moves<'_, '_, P, W> {
    /// M290. It waits for nothing but power.
    pub async fn babystep(&mut self, by: Option<Number>, is_kept: bool) -> Result<Answer<'static>, Interrupt> {
        let Some(by) = by else { return Ok(Answer::ZOffset) };
        let Some(by) = self.clamps.length_of(self.modal, ["M290", "Z"], by, MOST, None) else {
            return Ok(Answer::Nothing);
        };
        let store = self.main_loop.settings.store_of_shifts();
        self.shift(by, is_kept.then_some(store)).await
    }

    /// SET_GCODE_OFFSET, in mm even after G20.
    pub async fn z_offset(&mut self, words: OffsetWords) -> Result<Answer<'static>, Interrupt> {
        let kept = self.main_loop.settings.bed.z_offset;
        let read = |number: Number| Mm::saturating_from_num(number.value());
        let by = match (words.to, words.by) {
            (Some(to), _) => read(to).saturating_sub(kept),
            (None, Some(by)) => read(by),
            (None, None) => return Ok(Answer::ZOffset),
        };
        let [.., is_homed] = self.main_loop.homed.axes();
        if words.moves && is_homed {
            return self.shift(by, Some(ZStore::Program)).await;
        }
        if !may_be_kept(&self.main_loop.settings, ZStore::Program, by) {
            return Ok(TOO_FAR);
        }
        let_z_stand(self.main_loop, by);
        Ok(Answer::Nothing)
    }

    /// Z moves by so much, as soon as its limits leave room for it.
    async fn shift(&mut self, by: Mm, store: Option<ZStore>) -> Result<Answer<'static>, Interrupt> {
        if by == Mm::ZERO {
            return Ok(Answer::Nothing);
        }
        if let Some(answer) = misfit(self.main_loop, by, store) {
            return Ok(answer);
        }
        if !self.may_move([false, false, true]).await? {
            return Ok(Answer::NotHomed);
        }
        let [.., is_homed] = self.main_loop.homed.axes();
        let [_, _, end, _] = self.main_loop.motion.end_mm();
        if is_homed && self.main_loop.settings.soft_endstops && end.saturating_add(by) > z_reach(self.main_loop).most {
            return Ok(Answer::Line(packed!("echo:ignored: Z would leave its axis")));
        }
        let motors = self.main_loop.motion.groups().mechanism().motors_of(2);
        if !self.main_loop.power.is_on(motors) {
            self.main_loop.power_up(self.main_loop.motion.groups().fitted()).await?;
        }
        shift_z(self.main_loop, by, store);
        Ok(Answer::Nothing)
    }
}
