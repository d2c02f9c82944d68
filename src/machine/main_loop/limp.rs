//! Limp: a motor of the belt has failed during a print, and the others take the nozzle off the print.
//!
//! Motors that can pull against each other are more than it takes to hold x and y: without one of them the others still
//! do. So if one driver fails, its motor alone loses its power, at once, because a driver that was reset makes other
//! steps and pulls against the others. The motion brakes along its path, z is raised, and the tool goes next to its
//! switches. Then all power is cut and the machine is halted as after any other fault. Heaters are off from the first
//! moment on.
//!
//! It needs the tool's position: all axes are homed, and no homing, measurement, trim or circulation is under way. It
//! ends at once, with all power cut, in four cases: another driver fails, any other fault comes, M112 or M410 arrives,
//! or [`MOST_MS`] passes. A dip of the whole supply resets all drivers, so all others are checked before anything but
//! braking happens. Limp mode runs at most once per boot.
//!
//! `park` has the place and the lift, `halted` the words. `sim/board/tests/belt/limp.rs` tests both,
//! `emulator/tests/drivers.rs` the lift and the words. docs/explanation/belt/limp.md describes the place and the
//! times, docs/explanation/safety.md the times.

use crate::driver;
use crate::fault::{self, Cause};
use crate::kinematics::Grouping;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Motor, MotorSet, Wake};
use crate::settings::{HomedAxis, Settings};
use crate::units::{Mm, MmPerSec, MmPerSec2};
use core::pin::pin;

/// Speed of the tool on its path to its place. There is no hurry once z is raised. A motor at a turn a second of a
/// pulley of 40 mm has all its torque (docs/research/twin.md, torque at speed).
const SPEED: MmPerSec = MmPerSec::const_from_int(40);

/// Acceleration on that path: a tenth of the value with four motors. On a diagonal a single motor drives a tool of 0.6
/// kg and four rotors of 0.134 kg each. That takes 1 N of its 63 (docs/research/twin.md).
const ACCELERATION: MmPerSec2 = MmPerSec2::const_from_int(500);

/// It is over after this many ms at the latest: braking, raising and the longest diagonal take 25 s with the settings
/// of the prototype.
const MOST_MS: u32 = 60_000;

/// The tool rings at 57 Hz, and with one motor less more softly, before it is let go.
const RING_MS: u32 = 200;

/// Parks the tool, if no other fault comes. Afterwards all power is to be cut.
pub(in crate::machine) async fn limp<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    main_loop.limping.go();
    let parked = apart(pin!(main_loop.park())).await;
    // In both cases nothing moves from here on.
    main_loop.stop_and_cut();
    if let Ok(raised) = parked {
        main_loop.limping.park(raised);
    }
    main_loop.limping.end();
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// A driver has failed. Either its motor alone loses its power and the tool brakes for parking by the others, or
    /// the motion ends and all motors lose their power, at once.
    pub(super) fn meet_driver_fault(&mut self, fault: driver::Fault) {
        let driver::Fault { motor, name, .. } = fault;
        let cause = fault::Fault { cause: Cause::Driver, subject: motor.number(), value: 0, limit: 0 };
        if !self.may_limp(motor) {
            self.stop_and_cut();
            self.status.fault().set(cause);
            return;
        }
        self.power.go_on_without(motor);
        self.motion.brake();
        let faults = self.status.fault();
        faults.set(cause);
        self.limping.begin(self.now().after_ms(MOST_MS), faults.more());
        self.homed.release(MotorSet::of(motor), self.motion.groups().mechanism());
        self.trimming.forget();
        self.hosts.notify_all(text!("echo:{fault}; motor {name} is off, the others park the tool"));
    }

    /// Whether the tool can be parked without this motor.
    fn may_limp(&self, motor: Motor) -> bool {
        let mechanism = self.motion.groups().mechanism();
        let needed = mechanism.belt_motors().with(mechanism.motors_of(2));
        self.settings.belt.limp_lift > Mm::ZERO
            && self.power.fault().is_none_or(|first| first.motor == motor)
            && !self.status.fault().is_set()
            && self.settings.residuals().motors().has(motor)
            && !mechanism.motors_of(2).has(motor)
            && self.homed.axes() == [true; 3]
            && self.motion.grouping() == Grouping::Tool
            && !self.trimming.is_measuring()
            && self.power.is_on(needed)
    }

    async fn park(&mut self) -> Result<Mm, Interrupt> {
        self.slow_down().await?;
        self.drop_motion().await?;
        // A dip of the whole supply has reset the others as well.
        self.until(|c| !c.power.are_unseen()).await?;
        let mut place = self.motion.end_mm();
        let [x, y, z, _] = &mut place;
        let raised = self.settings.belt.limp_lift.min(z_reach(self).most.saturating_sub(*z)).max(Mm::ZERO);
        *z = z.saturating_add(raised);
        let [beside_x, beside_y] = [HomedAxis::X, HomedAxis::Y].map(|axis| self.beside_switch(axis));
        let raise = place_of([*x, *y], &place);
        let park = place_of([beside_x, beside_y], &place);
        self.go_gently(raise, self.settings.axes.z.max_speed).await?;
        self.go_gently(park, SPEED).await?;
        let quiet = self.now().after_ms(RING_MS);
        self.settle(quiet).await?;
        Ok(raised)
    }

    /// Where an axis stands when it has just left its switch.
    fn beside_switch(&self, axis: HomedAxis) -> Mm {
        let s = &self.settings;
        let (endstop, homing) = (s.endstops.of(axis), s.homing.of(axis));
        s.reach(axis).clamp(endstop.position - endstop.towards(homing.back_off))
    }

    /// Goes to a place with a speed and acceleration that three motors hold easily. The motor that has failed has no
    /// power, so the move does not require it.
    async fn go_gently(&mut self, position: [Mm; 4], speed: MmPerSec) -> Result<(), Interrupt> {
        while !self.motion.replan() {
            self.poll_again().await?;
        }
        let target = Target { position, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE };
        self.motion.push(&target, &gentle(&self.settings));
        self.finish().await
    }
}

/// The same height and filament at another place.
fn place_of([x, y]: [Mm; 2], other: &[Mm; 4]) -> [Mm; 4] {
    let [_, _, z, e] = *other;
    [x, y, z, e]
}

/// The same settings with less acceleration in x and y.
#[inline(never)]
fn gentle(settings: &Settings) -> Settings {
    let mut s = *settings;
    for axis in [&mut s.axes.x, &mut s.axes.y] {
        axis.max_acceleration = axis.max_acceleration.min(ACCELERATION);
    }
    s
}
