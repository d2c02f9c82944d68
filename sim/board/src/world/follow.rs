//! What the world tells of its motion: to the sink, the pins, and the log of a mesh.

use super::World;
use corehbot::motors::EndstopSet;

impl World<'_> {
    /// Follows the moves that the generator has begun, and hands on those that have ended.
    pub(super) fn follow_moves(&mut self) {
        let Some(tap) = &mut self.tap else { return };
        let (now, is_met) = (self.stepper.tick(), !self.status.triggered().is_empty());
        tap.after_generator(self.generator.under_way(), now, self.status.epoch(), is_met);
        tap.end(now);
        while let Some(change) = tap.reshaped() {
            self.stepper.port().sink.reshaped(&change);
        }
        while let Some(made) = tap.judged() {
            self.stepper.port().sink.moved(&made);
        }
    }

    /// Hands on the moves that have ended; a move that has not is what there is of it.
    pub(super) fn end_moves(&mut self) {
        self.follow_moves();
        let Some(tap) = &mut self.tap else { return };
        tap.finish(self.stepper.tick());
        while let Some(made) = tap.judged() {
            self.stepper.port().sink.moved(&made);
        }
    }

    /// Tells the log of a mesh, if there is one, that z follows another surface, or that the firmware has given another
    /// name to a place.
    pub(super) fn note_surface(&mut self) {
        let origin = self.generator.origin();
        let pins = self.stepper.port();
        let Some(log) = &pins.mesh_log else { return };
        let surface = self.generator.surface();
        if origin == self.origin && !log.is_news(surface) {
            return;
        }
        self.origin = origin;
        let made = self.counts.read();
        let counts = std::array::from_fn(|group| made[group].wrapping_add(origin[group]));
        pins.note_surface(&self.turned.coupling.motor_counts(counts), surface);
    }

    /// Reports to the pins which switches have ended a motion since the last time.
    pub(super) fn tell_met(&mut self) {
        let met = self.status.triggered();
        if met != self.met {
            let fresh = EndstopSet(met.0 & !self.met.0);
            self.met = met;
            let tick = self.stepper.tick();
            self.stepper.port().meet(fresh, tick);
        }
    }

    /// Tells the sink that the machine has halted.
    pub(super) fn tell_halt(&mut self) {
        let is_halted = self.status.is_halted();
        if std::mem::replace(&mut self.was_halted, is_halted) != is_halted {
            let tick = self.stepper.tick();
            self.stepper.port().sink.stopped(tick);
        }
    }
}
