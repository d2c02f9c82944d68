//! The console: lines in, replies out, one command after the other.

use crate::driver::Drivers;
use crate::gcode;
use crate::kinematics::Groups;
use crate::machine::commands::clamps::Clamps;
use crate::machine::commands::pauses::Wait;
use crate::machine::commands::retraction::Retraction;
pub use crate::machine::hosts::halted::Restart;
use crate::machine::hosts::serving::{Asked, Hosts, Text};
use crate::machine::ports::Devices;
pub use crate::machine::ports::{PortSet, Ports};
use crate::machine::reports::answer::{Answer, Progress};
use crate::machine::state::modal::Modal;
use crate::machine::state::soft_endstops::Homed;
use crate::machine::stream::release_policy::ReleasePolicy;
use crate::motion::{Link, MoveMemory, Planner};
use crate::motors::MOST_GROUPS;
use crate::port::{Clock, DriverBus, MotorSet, Pend, Serial, Storage, ThermalPort};
use crate::protocol::{Activity, Replies};
use crate::settings::Settings;
use crate::units::{Instant, Mm};
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::Poll;

/// Motors lose power when nothing has moved for this long, unless M84 S says otherwise; Klipper's
/// idle_timeout is as long.
const IDLE_TIMEOUT_S: u32 = 600;

/// Why a command ends before it is done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Interrupt {
    /// M112, or a fault that only a reset ends.
    Halt,
    /// M410.
    QuickStop,
    /// Motors may not have power; the host was told why. Nothing was planned.
    NoPower,
}

/// The Console.
pub struct Console<'m, P: PortSet, W: Pend> {
    pub(super) ports: Devices<P>,
    pub(super) hosts: Hosts<P::Serial>,
    pub(super) link: Link<'m, W>,
    pub(super) planner: Planner<'m>,
    pub(super) policy: ReleasePolicy,
    /// There is more to do at once: the next turn is wanted before anything happens.
    pub(super) comes_again: bool,
    /// How far the present answer has been written.
    pub(super) telling: Progress,
    pub(super) settings: Settings,
    /// The settings that the machine was made with.
    pub(super) defaults: Settings,
    pub(super) modal: Modal,
    pub(super) retraction: Retraction,
    pub(super) homed: Homed,
    /// The motor groups.
    pub(super) groups: &'m Groups,
    /// Position of each of them at count 0, in steps.
    pub(super) origin: [i32; MOST_GROUPS],
    /// What the motor drivers hold, and which of them have power.
    pub(super) drivers: Drivers,
    /// Seconds without motion until they lose it; 0 is never.
    pub(super) idle_timeout_s: u32,
    pub(super) last_motion: Instant,
    /// What the present command waits for beside the motion, and what has come of it.
    pub(super) wait: Wait,
    /// M25 has paused the print, and no M24 has resumed it.
    pub(super) is_paused: bool,
    /// The generator follows the taps of the pressure advance. Once it does, that stays so: all axes are as late as these
    /// need, and an advance of 0 is one like any other.
    pub(super) has_advance: bool,
    /// An axis is being homed.
    pub(super) is_homing: bool,
    /// M999 came after M112.
    pub(super) is_to_restart: bool,
    /// The host was told of a target beyond the edge.
    pub(super) told_of_edge: bool,
    /// The host was told that there are no heaters.
    pub(super) told_of_heaters: bool,
    /// The host was told of motion before homing.
    pub(super) told_of_homing: bool,
    /// The host was told of words of M205 that do not count.
    pub(super) told_of_corners: bool,
    /// Values of the present command that were out of range.
    pub(super) clamps: Clamps,
}

impl<'m, S: Serial, D: DriverBus, K: Clock, T: Storage, H: ThermalPort, W: Pend> Console<'m, Ports<S, D, K, T, H>, W> {
    /// A Console of a machine with these motor groups that stands at `start` if that is known, as if homed.
    pub fn new(
        settings: Settings,
        start: Option<[Mm; 3]>,
        memory: &'m mut MoveMemory,
        groups: &'m Groups,
        link: Link<'m, W>,
        ports: Ports<S, D, K, T, H>,
    ) -> Self {
        let [x, y, z] = start.unwrap_or_default();
        let Ports { serial, drivers: bus, clock, storage, sensors } = ports;
        let now = clock.now();
        let drivers = Drivers::new(bus.lines(), &settings);
        Self {
            ports: Devices { drivers: bus, clock, storage, sensors },
            hosts: Hosts::new(serial, now),
            link,
            planner: Planner::new(memory, &settings, [x, y, z, Mm::ZERO]),
            policy: ReleasePolicy::new(),
            comes_again: false,
            telling: Progress::default(),
            settings,
            defaults: settings,
            modal: Modal::new([x, y, z]),
            retraction: Retraction::new(),
            homed: Homed([start.is_some(); 3]),
            groups,
            origin: [0; MOST_GROUPS],
            drivers,
            idle_timeout_s: IDLE_TIMEOUT_S,
            last_motion: now,
            wait: Wait::new(),
            is_paused: false,
            has_advance: false,
            is_homing: false,
            is_to_restart: false,
            told_of_edge: false,
            told_of_heaters: false,
            told_of_homing: false,
            told_of_corners: false,
            clamps: Clamps::new(),
        }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// The settings as they are now.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Serves the hosts. Poll it when bytes arrived, when a queue moved, and every millisecond.
    /// It ends when the machine is to begin anew, after a stop: have the board reset then.
    pub async fn run(&mut self) -> Restart {
        self.ports.drivers.enable(MotorSet::NONE);
        loop {
            let mut stopped = match self.start_and_serve().await {
                Ok(never) => match never {},
                Err(interrupt) => Err(interrupt),
            };
            while stopped == Err(Interrupt::QuickStop) {
                stopped = self.quick_stop().await;
            }
            if stopped.is_err() {
                return self.stay_halted().await;
            }
        }
    }

    async fn start_and_serve(&mut self) -> Result<Infallible, Interrupt> {
        if self.link.is_fresh() {
            let found = self.load_at_start().await?;
            self.adopt_position(self.planner.end()).await?;
            for host in 0..self.hosts.len() {
                self.hosts.turn_to(host);
                self.tell(Answer::Start).await?;
                self.tell(found).await?;
            }
        }
        // A command that an emergency ended is answered all the same.
        if self.hosts.owes_ok() {
            self.tell(Answer::Ok).await?;
            self.hosts.settle();
            self.wait = Wait::new();
        }
        self.serve().await
    }

    async fn serve(&mut self) -> Result<Infallible, Interrupt> {
        let mut text = Text::new();
        loop {
            let now = self.ports.clock.now();
            let patience = (u32::from(self.settings.patience_ms), self.activity());
            let Some(asked) = self.hosts.next_line(now, patience, &mut text) else {
                self.link.status().set_awaiting_input(true);
                self.turn().await?;
                continue;
            };
            self.link.status().set_awaiting_input(false);
            let answer = match asked {
                Asked::Command => self.carry_out(&text).await?,
                Asked::Nothing => Answer::Nothing,
                Asked::LineNumber(number) => {
                    self.told_of_edge = false;
                    self.told_of_homing = false;
                    self.told_of_corners = false;
                    Answer::LineNumber(number)
                }
                Asked::TooLong => Answer::TooLong,
                Asked::Probe(last) => Answer::Probe(last),
                Asked::Resend(reason, last) => Answer::Resend(reason, last),
            };
            self.tell(answer).await?;
            if !answer.has_ok() {
                self.tell(Answer::Ok).await?;
            }
            self.hosts.settle();
            self.wait = Wait::new();
        }
    }

    /// What the machine is about while a host is silent.
    fn activity(&self) -> Activity {
        if self.has_motion() {
            Activity::Moving
        } else if !self.policy.has_waited() {
            Activity::Resting
        } else if self.is_paused {
            Activity::Paused
        } else {
            Activity::Waited
        }
    }

    async fn carry_out<'a>(&mut self, text: &'a [u8]) -> Result<Answer<'a>, Interrupt> {
        self.clamps.clear();
        match self.execute(&gcode::parse(text)).await {
            Err(Interrupt::NoPower) => Ok(Answer::Nothing),
            Ok(answer) => self.tell_clamps().await.map(|()| answer),
            Err(interrupt) => Err(interrupt),
        }
    }

    /// Lets the world go round once, without waiting for anything to happen.
    pub(super) async fn turn_again(&mut self) -> Result<(), Interrupt> {
        self.comes_again = true;
        self.turn().await
    }

    /// Lets the world go round once.
    pub(super) async fn turn(&mut self) -> Result<(), Interrupt> {
        let comes_again = core::mem::take(&mut self.comes_again);
        yield_once(comes_again).await;
        if !comes_again {
            // Time has passed.
            self.follow_stream();
        }
        self.crank()
    }

    /// Waits until `done`.
    pub(super) async fn until(&mut self, done: fn(&mut Self) -> bool) -> Result<(), Interrupt> {
        while !done(self) {
            self.turn().await?;
        }
        Ok(())
    }

    /// Everything that must go on whatever the Console waits for. Bounded by what has arrived.
    fn crank(&mut self) -> Result<(), Interrupt> {
        let emergency = self.receive();
        self.hosts.greet(Replies::start);
        self.tend_drivers()?;
        self.feed_motion();
        let keepalive_ms = u32::from(self.settings.keepalive_s) * 1000;
        self.hosts.keep_alive(self.ports.clock.now(), keepalive_ms, self.wait.is_for_user);
        self.report_unasked();
        self.watch_idleness();
        self.hosts.send();
        match emergency {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }

    fn receive(&mut self) -> Option<Interrupt> {
        let urgent = self.hosts.receive();
        self.wait.is_over |= urgent.go_on || (urgent.resume && self.wait.is_for_user);
        self.wait.is_answered |= urgent.resume;
        if urgent.stop {
            self.is_to_restart = urgent.restart;
            return Some(Interrupt::Halt);
        }
        urgent.quick_stop.then_some(Interrupt::QuickStop)
    }

    fn watch_idleness(&mut self) {
        let now = self.ports.clock.now();
        if self.wait.is_for_user || self.has_motion() {
            self.last_motion = now;
        } else if self.idle_timeout_s > 0
            && !self.drivers.powered().is_empty()
            && now >= self.last_motion.after_ms(self.idle_timeout_s.saturating_mul(1000))
        {
            self.unpower(MotorSet::ALL);
        }
    }
}

/// Gives the rest of the world a turn; has itself woken if it wants the next one at once.
pub(super) async fn yield_once(comes_again: bool) {
    let mut yielded = false;
    poll_fn(|context| {
        if core::mem::replace(&mut yielded, true) {
            return Poll::Ready(());
        }
        if comes_again {
            context.waker().wake_by_ref();
        }
        Poll::Pending
    })
    .await;
}
