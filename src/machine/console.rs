//! The Console: lines in, replies out, one command after the other.
//!
//! Its loop is `serve`: take a line, carry it out, tell the answer, say `ok`. Its crank turns in every wait of every
//! command. The state that commands keep has owners of its own, with private fields; the Console holds them.

use crate::connectors::HEATERS;
use crate::driver::Drivers;
use crate::gcode;
use crate::kinematics::Groupings;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::speaker::Progress;
use crate::machine::hosts::host::{Asked, Text};
use crate::machine::hosts::serving::Hosts;
use crate::machine::interrupt::Interrupt;
use crate::machine::interrupt::Restart;
use crate::machine::ports::Devices;
pub use crate::machine::ports::{PortSet, Ports};
use crate::machine::release::policy::ReleasePolicy;
use crate::machine::state::advance_in_use::AdvanceInUse;
use crate::machine::state::circulation::Circulation;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::fan_schedule::FanSchedule;
use crate::machine::state::heat_orders::HeatOrders;
use crate::machine::state::idle_timeout::IdleTimeout;
use crate::machine::state::machine_pieces::MachinePieces;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::Notices;
use crate::machine::state::pauses::Pauses;
use crate::machine::state::position::{Homed, RealPosition};
use crate::machine::state::retraction::Retraction;
use crate::machine::state::self_tests::SelfTests;
use crate::machine::state::trimming::Trimming;
use crate::motion::{Link, MoveMemory, Planner};
use crate::port::{Clock, DriverBus, MotorSet, Pend, Serial, Storage};
use crate::protocol::{Activity, Replies};
use crate::settings::{Kept, Settings};
use crate::thermal::Orders;
use crate::units::{Celsius, Instant, Mm};
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::Poll;

/// The Console.
pub struct Console<'m, P: PortSet, W: Pend> {
    pub(super) ports: Devices<P>,
    pub(super) hosts: Hosts<P::Serial>,
    pub(super) link: Link<'m, W>,
    pub(super) planner: Planner<'m>,
    pub(super) policy: ReleasePolicy,
    /// There is more to do at once: the next turn is wanted before anything happens.
    comes_again: bool,
    /// How far the present answer has been written.
    pub(super) progress: Progress,
    pub(super) settings: Kept<Settings>,
    /// The settings that the machine was made with.
    pub(super) defaults: Kept<Settings>,
    /// When they are looked at next.
    pub(super) scrub_due: Instant,
    pub(super) modal: Modal,
    pub(super) retraction: Retraction,
    pub(super) homed: Homed,
    pub(super) real: RealPosition<'m>,
    pub(super) circulation: Circulation,
    pub(super) trimming: Trimming,
    /// What the motor drivers hold, and which motors have power.
    pub(super) drivers: Drivers,
    pub(super) idle_timeout: IdleTimeout,
    pub(super) pauses: Pauses,
    pub(super) advance_in_use: AdvanceInUse,
    /// M999 came after M112.
    pub(super) is_to_restart: bool,
    pub(super) notices: Notices,
    /// Values of the present command that were out of range.
    pub(super) clamps: Clamps,
    /// To the heaters and fans, and what is yet to go there.
    pub(super) orders: Orders<'m>,
    pub(super) heat_orders: HeatOrders,
    pub(super) fan_schedule: FanSchedule,
    pub(super) self_tests: SelfTests,
    pub(super) machine_pieces: MachinePieces,
    /// When heaters were last used, and what they were at before they went off while the user was waited for.
    pub(super) heaters_used: Instant,
    pub(super) targets_before: Option<[Celsius; HEATERS]>,
    /// M302 P1: filament may move at any temperature.
    pub(super) allows_cold: bool,
    /// When heat is looked after next, and when the filament in the look-ahead is told next.
    pub(super) heat_due: Instant,
    pub(super) ahead_due: Instant,
}

impl<'m, S: Serial, D: DriverBus, K: Clock, T: Storage, W: Pend> Console<'m, Ports<S, D, K, T>, W> {
    /// A Console of a machine with these groups of motors that stands at `start` if that is known, as if homed.
    pub fn new(
        settings: Settings,
        start: Option<[Mm; 3]>,
        memory: &'m mut MoveMemory,
        orders: Orders<'m>,
        groupings: &'m Groupings,
        link: Link<'m, W>,
        ports: Ports<S, D, K, T>,
    ) -> Self {
        let [x, y, z] = start.unwrap_or_default();
        let Ports { serial, drivers: bus, clock, storage } = ports;
        let now = clock.now();
        let drivers = Drivers::new(bus.lines(), &settings);
        Self {
            ports: Devices { drivers: bus, clock, storage },
            hosts: Hosts::new(serial),
            link,
            planner: Planner::new(memory, &settings, [x, y, z, Mm::ZERO]),
            policy: ReleasePolicy::new(),
            comes_again: false,
            progress: Progress::default(),
            settings: Kept::new(settings),
            defaults: Kept::new(settings),
            scrub_due: now,
            modal: Modal::new([x, y, z]),
            retraction: Retraction::new(),
            homed: Homed::new([start.is_some(); 3]),
            real: RealPosition::new(groupings),
            circulation: Circulation::new(),
            trimming: Trimming::new(),
            drivers,
            idle_timeout: IdleTimeout::new(now),
            pauses: Pauses::new(),
            advance_in_use: AdvanceInUse::new(),
            is_to_restart: false,
            notices: Notices::new(),
            clamps: Clamps::new(),
            orders,
            heat_orders: HeatOrders::new(&settings.thermal),
            fan_schedule: FanSchedule::new(),
            self_tests: SelfTests::new(),
            machine_pieces: MachinePieces::new(),
            heaters_used: now,
            targets_before: None,
            allows_cold: false,
            heat_due: now,
            ahead_due: now,
        }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// The settings as they are now.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Serves the hosts. Poll it when bytes arrived, when a queue moved, and every millisecond.
    /// It ends when the machine is to begin anew, after a stop: have the board reset then.
    pub async fn run(&mut self) -> Restart {
        self.ports.drivers.enable(MotorSet::NONE);
        self.hosts.open(self.ports.clock.now());
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
                if let Some(why) = self.ports.drivers.refusal() {
                    self.tell(Answer::NoMachine(why)).await?;
                }
                self.tell(found).await?;
            }
        }
        // A command that an emergency ended is answered all the same.
        if self.hosts.owes_ok() {
            self.tell(Answer::Ok).await?;
            self.end_line();
        }
        self.serve().await
    }

    async fn serve(&mut self) -> Result<Infallible, Interrupt> {
        let mut text = Text::new();
        loop {
            let now = self.ports.clock.now();
            let patience = (u32::from(self.settings.patience_ms), self.activity());
            // The note of a passed self-test is written at rest: flash may stop the processor while it is written.
            if self.self_tests.has_news() && !self.has_motion() {
                self.note_self_test().await?;
            }
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
                    self.notices.renew_for_print();
                    Answer::LineNumber(number)
                }
                Asked::TooLong => Answer::TooLong,
                Asked::Question(last) => Answer::Question(last),
                Asked::Resend(reason, last) => Answer::Resend(reason, last),
            };
            self.tell(answer).await?;
            if !answer.has_ok() {
                self.tell(Answer::Ok).await?;
            }
            self.end_line();
        }
    }

    /// The line is answered.
    const fn end_line(&mut self) {
        self.hosts.note_answered();
        self.pauses.end_command();
    }

    /// What the machine is about while a host is silent.
    fn activity(&self) -> Activity {
        if self.has_motion() {
            Activity::Moving
        } else if !self.policy.has_waited() {
            Activity::Resting
        } else if self.pauses.is_print_paused() {
            Activity::Paused
        } else {
            Activity::Waited
        }
    }

    async fn carry_out<'a>(&mut self, text: &'a [u8]) -> Result<Answer<'a>, Interrupt> {
        self.clamps.clear();
        match self.execute(&gcode::parse(text)).await {
            // Why, `power` has told.
            Err(Interrupt::NoPower) => Ok(Answer::Nothing),
            Ok(answer) => self.tell_clamps().await.map(|()| answer),
            Err(interrupt) => Err(interrupt),
        }
    }

    /// The settings that the machine was made with.
    pub(super) fn defaults(&self) -> &Settings {
        &self.defaults
    }

    /// There is more to do at once: the next turn is wanted before anything happens.
    pub(super) const fn come_again(&mut self) {
        self.comes_again = true;
    }

    /// Lets the world go round once, without waiting for anything to happen.
    pub(super) async fn turn_again(&mut self) -> Result<(), Interrupt> {
        self.come_again();
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

    /// Everything that must go on whatever the Console waits for. Bounded by what has arrived. Emergencies are heard first and
    /// returned last, when all else has had its turn: moves that M112 may still hand on are dropped by the abort that follows.
    pub(super) fn crank(&mut self) -> Result<(), Interrupt> {
        self.link.status().heat().beat_of_console();
        let emergency = self.receive();
        self.hosts.greet(Replies::start);
        self.tend_drivers()?;
        self.feed_motion();
        let now = self.ports.clock.now();
        self.scrub(now);
        self.tend_heat(now)?;
        let keepalive_ms = u32::from(self.settings.keepalive_s) * 1000;
        self.hosts.keep_alive(now, keepalive_ms, self.pauses.is_for_user());
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
        self.pauses.note(urgent.go_on, urgent.resume);
        if urgent.stop {
            self.is_to_restart = urgent.restart;
            return Some(Interrupt::Halt);
        }
        urgent.quick_stop.then_some(Interrupt::QuickStop)
    }
}

/// Gives everybody else a turn; has itself woken if it wants the next one at once.
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
