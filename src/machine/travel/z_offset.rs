//! The first layer: the offset of z, shifted while moves are under way (M290, SET_GCODE_OFFSET).
//!
//! `main_loop::offsets` shifts it, the generator makes the steps (`motion::stepgen::z_count`). SET_GCODE_OFFSET
//! changes the program's offset and no other. M290 changes that of the probe where it homes z, otherwise the program's.
//! Without P0 the change is kept over homing, and M500 stores it.

use super::moves::Moves;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::words::Facts;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::{let_z_stand, shift_z, z_reach};
use crate::machine::numbers::Hundredths;
use crate::machine::numbers::{exact, shortest_with};
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::settings::{Range, Settings, ZStore, ranges};
use crate::units::Mm;

/// What a line asks for; a report without a number.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Shift {
    /// M290.
    Live {
        /// Z or S.
        by: Option<Number>,
        /// Without P0: the change is kept.
        is_kept: bool,
    },
    /// SET_GCODE_OFFSET, in mm.
    Kept {
        /// Z: the offset.
        to: Option<Number>,
        /// Z_ADJUST: more than now. It does not count beside Z.
        by: Option<Number>,
        /// MOVE=1: z moves at once.
        moves: bool,
    },
}

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
fn misfit<P: PortSet, W: Wake>(
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

impl<P: PortSet, W: Wake> Moves<'_, '_, P, W> {
    /// M290 and SET_GCODE_OFFSET. They wait for nothing but power.
    pub async fn offset_z(&mut self, shift: Shift) -> Result<Answer<'static>, Interrupt> {
        let shift = match shift {
            Shift::Live { by, is_kept } => self.babystep(by, is_kept),
            Shift::Kept { to, by, moves } => self.z_offset(to, by, moves),
        };
        let (by, store) = match shift {
            Ok(shift) => shift,
            Err(answer) => return Ok(answer),
        };
        if let Some(answer) = self.refuse_shift(by, store) {
            return Ok(answer);
        }
        let motors = self.main_loop.motion.groups().mechanism().motors_of(2);
        if !self.main_loop.power.is_on(motors) {
            self.main_loop.power_up(self.main_loop.motion.groups().fitted()).await?;
        }
        shift_z(self.main_loop, by, store);
        Ok(Answer::Nothing)
    }

    /// The shift of M290, or the answer if there is none.
    fn babystep(&mut self, by: Option<Number>, is_kept: bool) -> Result<(Mm, Option<ZStore>), Answer<'static>> {
        let Some(by) = by else { return Err(self.tell_z_offset()) };
        let Some(by) = self.states.clamps.length_of(&self.states.modal, ["M290", "Z"], by, MOST, None) else {
            return Err(Answer::Nothing);
        };
        let store = self.main_loop.settings.store_of_shifts();
        Ok((by, is_kept.then_some(store)))
    }

    /// The shift of SET_GCODE_OFFSET, in mm even after G20, or the answer if nothing moves.
    fn z_offset(
        &mut self,
        to: Option<Number>,
        by: Option<Number>,
        moves: bool,
    ) -> Result<(Mm, Option<ZStore>), Answer<'static>> {
        let kept = self.main_loop.settings.bed.z_offset;
        let read = |number: Number| Mm::saturating_from_num(number.value());
        let by = match (to, by) {
            (Some(to), _) => read(to).saturating_sub(kept),
            (None, Some(by)) => read(by),
            (None, None) => return Err(self.tell_z_offset()),
        };
        let [.., is_homed] = self.main_loop.homed.axes();
        if moves && is_homed {
            return Ok((by, Some(ZStore::Program)));
        }
        if !may_be_kept(&self.main_loop.settings, ZStore::Program, by) {
            return Err(TOO_FAR);
        }
        let_z_stand(self.main_loop, by);
        Err(Answer::Nothing)
    }

    /// The sum of all shifts since z was homed (Marlin's words), and the kept offsets. These are the probe's offset if
    /// it homes z, the program's offset, and the sum by which both lift the nozzle.
    fn tell_z_offset(&mut self) -> Answer<'static> {
        let shifted = self.main_loop.motion.shifted_z();
        let are_stored = self.main_loop.first_layer.are_stored(&self.main_loop.settings);
        self.main_loop.tell(|to, Facts { settings: s, .. }| {
            to.say(text!("echo:Babystep Z{}", Hundredths::of(shifted)));
            let [news, news_of_probe] =
                are_stored.map(|is_stored| if is_stored { "" } else { ", not saved: M500 keeps it" });
            let kept = exact(s.bed.z_offset);
            if s.homes_z_by_probe() {
                to.say(text!("echo:Probe Offset Z{}{news_of_probe}", exact(s.probe.offset.z)));
                // The sum of two rounded decimals is a bit or two off the decimal that it means.
                let sum = shortest_with(s.probe_in_program().offset.z.into(), 24);
                to.say(text!("echo:Z offset {kept}, the sum is {sum}{news}"));
            } else {
                to.say(text!("echo:Z offset {kept}{news}"));
            }
        });
        Answer::Said
    }

    /// Why z does not move by so much; it moves as soon as its limits leave room for it.
    fn refuse_shift(&mut self, by: Mm, store: Option<ZStore>) -> Option<Answer<'static>> {
        if by == Mm::ZERO {
            return Some(Answer::Nothing);
        }
        if let Some(answer) = misfit(self.main_loop, by, store) {
            return Some(answer);
        }
        if !self.may_move([false, false, true]) {
            return Some(Answer::NotHomed);
        }
        let [.., is_homed] = self.main_loop.homed.axes();
        let [_, _, end, _] = self.main_loop.motion.end_mm();
        let is_beyond = end.saturating_add(by) > z_reach(self.main_loop).most;
        (is_homed && self.main_loop.settings.soft_endstops && is_beyond)
            .then_some(Answer::Line(packed!("echo:ignored: Z would leave its axis")))
    }
}
