//! The scrub, a part of every turn: the motion settings in RAM, and the values derived from them, are checked twice a
//! second. A value that has changed by itself is a fault, which ends motion and heat.

use crate::fault::{Cause, Fault};
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::units::Instant;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Takes legal changes for right, and looks whether there were others.
    pub(super) fn scrub(&mut self, now: Instant) {
        if self.settings.is_scrub_due(now) && !(self.settings.is_whole() && self.motion.is_whole(&self.settings)) {
            self.status.fault().set(Fault::plain(Cause::SettingsDamaged));
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use crate::driver::Tmc2209;
    use crate::fault::Cause;
    use crate::kinematics::{Groupings, Mechanism};
    use crate::machine::hosts::host::HostMemory;
    use crate::machine::interrupt::Interrupt;
    use crate::machine::main_loop::MainLoop;
    use crate::machine::ports::{PortSet, Ports};
    use crate::motion::{Link, MoveMemory, MoveQueue, StepQueue};
    use crate::port::{
        AnyBoard, Clock, Lines, MotorPower, MotorSet, NoAccelerometer, NoBus, NoServo, NoStorage, Received, Serial,
        Wake,
    };
    use crate::settings::{Kept, Settings};
    use crate::status::Status;
    use crate::thermal::OrderQueue;
    use crate::units::{Instant, MmPerSec, MmPerSec2, StepsPerMm};
    use core::cell::Cell;
    use std::boxed::Box;

    struct Nothing;

    impl Serial for Nothing {
        fn recv(&mut self) -> Option<Received> {
            None
        }

        fn send(&mut self, bytes: &[u8]) -> usize {
            bytes.len()
        }
    }

    impl MotorPower for Nothing {
        fn enable(&mut self, _on: MotorSet) {}

        // Nothing steps.
        fn couple(&mut self, _coupling: &crate::motors::Coupling) {}
    }

    struct Time<'t>(&'t Cell<Instant>);

    impl Clock for Time<'_> {
        fn now(&self) -> Instant {
            self.0.get()
        }
    }

    #[derive(Clone, Copy)]
    struct NoWake;

    impl Wake for NoWake {
        fn wake_generator(&self) {}
        fn wake_stepper(&self) {}
    }

    impl<'t> PortSet for Time<'t> {
        type Serial = Nothing;
        type Motors = Nothing;
        type Drivers = NoBus;
        type Chip = Tmc2209;
        type Servo = NoServo;
        type Board = AnyBoard;
        type Clock = Self;
        type Storage = NoStorage;
        type Accelerometer = NoAccelerometer;
    }

    type Machine<'m> = MainLoop<'m, Time<'m>, NoWake>;

    /// The results of a main loop with the groups of a mechanism within a second after each of the changes.
    fn find(mechanism: &Mechanism, changes: &[fn(&mut Machine<'_>)]) -> Option<(u32, Cause)> {
        let settings = Settings::prototype();
        let (mut moves, mut events, mut orders) = (MoveQueue::new(), StepQueue::new(), OrderQueue::new());
        let (mut memory, status) = (Box::new(MoveMemory::new()), Status::new());
        let mut hosts = HostMemory::new();
        let groupings = Groupings::new(mechanism);
        let (moves_in, _moves) = moves.split();
        let (_events, events_out) = events.split();
        let (orders_in, _orders) = orders.split();
        let link = Link::new(moves_in, &status, events_out.counts(&status), NoWake);
        let now = Cell::new(Instant::default());
        let serial: Lines<_> = [Nothing].into_iter().collect();
        let ports = Ports {
            serial,
            motors: Nothing,
            drivers: NoBus,
            servo: NoServo,
            board: AnyBoard,
            clock: Time(&now),
            storage: NoStorage,
            accelerometer: NoAccelerometer,
        };
        let mut main_loop: Machine<'_> =
            MainLoop::new(&settings, None, (&mut memory, &mut hosts), orders_in, &groupings, link, ports);
        for change in changes {
            for ms in 0..=1000 {
                now.set(now.get().after_ms(1));
                match main_loop.go_on() {
                    Ok(()) => assert_eq!(status.fault().fault(), None, "a fault ends the turn"),
                    Err(interrupt) => {
                        assert_eq!(interrupt, Interrupt::Halt);
                        return status.fault().fault().map(|fault| (ms, fault.cause));
                    }
                }
                if ms == 0 {
                    change(&mut main_loop);
                }
            }
        }
        None
    }

    const LEGAL: fn(&mut Machine<'_>) = |c| now(c).print_acceleration = MmPerSec2::ONE;

    fn now<'c>(c: &'c mut Machine<'_>) -> &'c mut Kept<Settings> {
        c.settings.now_mut()
    }

    #[test]
    fn f40_motion_settings_that_change_by_themselves_halt_the_machine_within_a_second() {
        let whole = Mechanism::corehbot();
        let flips: [fn(&mut Machine<'_>); 5] = [
            |c| now(c).damage().axes.x.max_speed += MmPerSec::DELTA,
            |c| now(c).damage().soft_endstops ^= true,
            |c| now(c).damage().mechanism.rows[0][0] ^= 2,
            |c| {
                let mut damaged = *c.settings.defaults();
                damaged.homing.z.fast += MmPerSec::DELTA;
                c.settings.damage_made_with(Box::leak(Box::new(damaged)));
            },
            // The planner's values derived from the settings, here from wrong ones.
            |c| {
                let mut settings = *c.settings;
                settings.axes.y.steps_per_mm += StepsPerMm::DELTA;
                c.motion.set_resolution(&settings);
            },
        ];
        for flip in flips {
            let found = find(&whole, &[LEGAL, flip]);
            assert!(matches!(found, Some((..1000, Cause::SettingsDamaged))), "{found:?}");
            let found = find(&whole, &[flip, LEGAL]);
            assert!(matches!(found, Some((..1000, Cause::SettingsDamaged))), "{found:?}");
        }
        let legal: [fn(&mut Machine<'_>); 3] = [
            LEGAL,
            |c| now(c).thermal.fan_run_on_s += 1,
            |c| {
                now(c).axes.x.steps_per_mm = StepsPerMm::from_num(81);
                let settings = *c.settings;
                c.motion.set_resolution(&settings);
            },
        ];
        assert_eq!(find(&whole, &legal), None);
        let mut damaged = whole;
        damaged.rows[5][2] ^= 2;
        assert!(find(&damaged, &[LEGAL]).is_some(), "the second Z screw would turn backward");
    }
}
