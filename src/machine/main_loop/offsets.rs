//! Offsets: z is shifted while moves are under way, or for the moves to come; the program counts from another zero.

use super::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::program::Program;
use crate::port::Wake;
use crate::settings::{HomedAxis, Range, ZStore};
use crate::units::Mm;

/// Where the planner may send z.
pub(in crate::machine) fn z_reach<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> Range<Mm> {
    main_loop.first_layer.reach(&main_loop.settings)
}

/// Z moves by so much from where its moves lead it, at once. The change is kept over homing if there is a store.
pub(in crate::machine) fn shift_z<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    by: Mm,
    store: Option<ZStore>,
) {
    if let Some(store) = store {
        main_loop.settings.shift_z_offset(store, by);
    }
    match store {
        Some(ZStore::Program) => {}
        Some(ZStore::Probe) => main_loop.first_layer.shift_with_probe(by),
        None => main_loop.first_layer.shift(by),
    }
    let [.., steps, _] = main_loop.motion.to_steps([by; 4]);
    main_loop.homed.note_shifted(steps);
    main_loop.motion.shift_z(by, &main_loop.settings.axes.z);
}

/// The program's offset changes by so much, and z stands until its next move: the program's zero is there now.
pub(in crate::machine) fn let_z_stand<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, by: Mm) {
    main_loop.settings.shift_z_offset(ZStore::Program, by);
    main_loop.first_layer.shift(-by);
    move_origin(main_loop, [Mm::ZERO, Mm::ZERO, by]);
}

/// An axis was homed: it has the machine's own zero again but for its home offset, and no shift.
pub(in crate::machine) fn name_home<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, axis: usize) {
    main_loop.commanded.forget_origin(axis, main_loop.settings.home_offsets());
    if axis == HomedAxis::Z as usize {
        main_loop.motion.forget_shifts();
        main_loop.first_layer.forget();
        main_loop.homed.note_bed(None);
    }
}

/// From now on the program counts so much more than the machine.
pub(in crate::machine) fn use_home_offsets<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, offsets: [Mm; 3]) {
    let before = main_loop.settings.home_offsets();
    main_loop.settings.replace_home_offsets(offsets);
    move_origins(main_loop, before);
}

/// The program's zero moves by so much, and that of a program which is paused.
fn move_origin<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, by: [Mm; 3]) {
    main_loop.commanded.move_origin(by);
    main_loop.in_pause(|program| program.commanded.move_origin(by));
}

/// The program's zero moves, because the home offsets were others `before`.
pub(super) fn move_origins<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, before: [Mm; 3]) {
    let mut by = before;
    for (by, now) in by.iter_mut().zip(main_loop.settings.home_offsets()) {
        *by = by.saturating_sub(now);
    }
    move_origin(main_loop, by);
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// The same change for the program that a pause keeps, and as far as its stream has come.
    pub(super) fn in_pause(&mut self, change: impl Fn(&mut Program)) {
        self.job
            .paused_mut()
            .map(|paused| &mut paused.program)
            .into_iter()
            .chain(self.stream.program_mut())
            .for_each(change);
    }
}

/// Tells hosts once that the kept offset is not stored.
pub(in crate::machine) fn tell_of_z_offset<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    if main_loop.first_layer.tells(&main_loop.settings) {
        main_loop.hosts.notify_all(text!("echo:the offset of Z is not saved: M500 keeps it"));
    }
}
