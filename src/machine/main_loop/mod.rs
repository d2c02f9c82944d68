//! The main loop: all work that continues during every wait of a command.
//!
//! ```text
//!   a command ── owners: job, motion, heat, power, hosts, ...         at once
//!        └────── waits: plan, finish, power_up, reply, ... ──▶ turn ──▶ bytes in ▶ emergencies ▶ drivers
//!                                                                   ▶ moves ▶ settings ▶ heat ▶ replies out
//! ```
//!
//! A waiting command holds `&mut MainLoop` and the states that it names, and nothing else. The main loop is a struct of
//! owners. Each has private fields, a file of its own, and methods that keep its rules; it gets values of other owners
//! as arguments. A command uses the owners by their names. What takes several of them, or time, is a method of the main
//! loop. Nothing here uses `commands`; `halted` alone reads lines, after the machine has stopped.
//!
//! | file or folder | for |
//! |---|---|
//! | this one | the owners, and a turn |
//! | [`input`] | input of lines from hosts |
//! | [`reply`] | output of answers, as soon as there is room for them |
//! | [`place`] | where the program or the tool is, as hosts read it |
//! | [`motion`] | the look-ahead, the queue to the step generator, and where the machine stands |
//! | [`stream`] | the waits for room in the look-ahead and for the machine to rest |
//! | [`shift_axis`] | a move of one axis that a switch or the probe may end |
//! | [`sweep`](mod@sweep) | the sweep of a resonance test |
//! | [`settings`] | the settings in use |
//! | [`apply_settings`] | settings with effects beyond the next plan |
//! | [`offsets`] | the offsets of z and of home, live and kept |
//! | [`regroup`] | a belt, or one motor of it, takes the place of z |
//! | [`surface`] | the mesh of the bed, and whether z follows it |
//! | [`trim`], [`phase`] | turning of one motor of a belt alone; alignment of its motors as they get power |
//! | [`power`], [`powering`] | power for the motors, and exchanges with their drivers; the waits for it |
//! | [`heaters`], [`heat_poll`] | orders for heaters and fans; their part of a turn |
//! | [`scrub`] | whether settings in RAM are unchanged |
//! | [`limp`] | a motor of a belt has failed, and the others park the tool |
//! | [`halted`] | after a stop: replies to hosts until M999 |
//!
//! | word | means |
//! |---|---|
//! | turn | all other contexts run, and then every part of the main loop, once |

mod apply_settings;
pub(in crate::machine) mod halted;
mod heat_poll;
mod heaters;
pub(in crate::machine) mod input;
pub(in crate::machine) mod limp;
mod motion;
pub(in crate::machine) mod offsets;
pub(in crate::machine) mod phase;
pub(in crate::machine) mod place;
mod power;
mod powering;
pub(in crate::machine) mod regroup;
mod reply;
mod scrub;
pub(in crate::machine) mod settings;
pub(in crate::machine) mod shift_axis;
mod stream;
pub(in crate::machine) mod surface;
pub(in crate::machine) mod sweep;
pub(in crate::machine) mod trim;

use self::heaters::Heaters;
use self::motion::Motion;
use self::motion::hand_on::Fed;
use self::power::Power;
use self::settings::SettingsInUse;
use crate::kinematics::Groupings;
use crate::machine::answers::reply_writer::Progress;
use crate::machine::hosts::host::HostMemory;
use crate::machine::hosts::serving::Hosts;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::{PortSet, Ports};
use crate::machine::state::circulation::Circulation;
use crate::machine::state::commanded::Commanded;
use crate::machine::state::first_layer::FirstLayer;
use crate::machine::state::job::Job;
use crate::machine::state::known_bed::KnownBed;
use crate::machine::state::limping::Limping;
use crate::machine::state::paused_stream::PausedStream;
use crate::machine::state::pauses::Pauses;
use crate::machine::state::position::Homed;
use crate::machine::state::probing::Probing;
use crate::machine::state::trimming::Trimming;
use crate::motion::{Link, MoveMemory};
use crate::port::{Clock, Wake};
use crate::protocol::Replies;
use crate::settings::Settings;
use crate::status::{Known, Status};
use crate::thermal::Orders;
use crate::units::{Instant, Mm};
use core::future::poll_fn;
use core::task::Poll;

/// The state of the main loop, which runs during every wait.
///
/// In this order: an instruction reaches 4 KB from the begin, and two are shorter than what reaches farther. So the
/// largest owners are the last.
#[repr(C)]
pub(in crate::machine) struct MainLoop<'m, P: PortSet, W: Wake> {
    /// The atomics that all contexts share.
    pub status: &'m Status,
    /// The wait of the present command.
    pub pauses: Pauses,
    /// Which axes are homed.
    pub homed: Homed,
    /// Where the program has sent the tool.
    pub commanded: Commanded,
    /// The state of the print.
    pub job: Job,
    /// How far z stands from the place that the program names.
    pub first_layer: FirstLayer,
    /// How far a closed belt has run round.
    pub circulation: Circulation,
    /// Whether the motors of one belt agree.
    pub trimming: Trimming,
    /// The Z probe.
    pub probing: Probing,
    clock: P::Clock,
    /// There is more to do at once: the next turn is wanted before anything happens.
    comes_again: bool,
    /// When the present turn began. A turn takes some tens of us, and the clock is not read for each part of it.
    turn_began: Instant,
    /// The progress of the present answer.
    progress: Progress,
    /// A motor of the belt has failed, and the others park the tool.
    limping: Limping,
    /// M999 came after M112.
    is_to_restart: bool,
    /// The print's stream in a pause.
    pub stream: PausedStream,
    pub settings: SettingsInUse<'m>,
    pub motion: Motion<'m, W>,
    pub heat: Heaters<'m>,
    pub power: Power<P>,
    /// The servo of the probe.
    pub servo: P::Servo,
    /// Facts of the board.
    pub board: P::Board,
    pub accelerometer: P::Accelerometer,
    /// Memory for settings.
    pub storage: P::Storage,
    /// The mesh of the bed.
    pub bed: KnownBed,
    /// The lines of the hosts.
    pub hosts: Hosts<'m, P::Serial>,
}

impl<'m, P: PortSet, W: Wake> MainLoop<'m, P, W> {
    /// The main loop of a machine with these groups of motors. If `start` is known, the machine stands there as if
    /// homed.
    pub fn new(
        settings: &'m Settings,
        start: Option<[Mm; 3]>,
        (memory, hosts): (&'m mut MoveMemory, &'m mut HostMemory),
        orders: Orders<'m>,
        groupings: &'m Groupings,
        link: Link<'m, W>,
        ports: Ports<P>,
    ) -> Self {
        let [x, y, z] = start.unwrap_or_default();
        let Ports { serial, motors, drivers: bus, servo, board, clock, storage, accelerometer } = ports;
        let (now, status) = (clock.now(), link.status());
        Self {
            hosts: Hosts::new(serial, hosts),
            job: Job::new(),
            stream: PausedStream::new(),
            pauses: Pauses::new(),
            settings: SettingsInUse::new(settings, now),
            motion: Motion::new(link, memory, groupings, settings, [x, y, z, Mm::ZERO]),
            commanded: Commanded::new([x, y, z], settings.home_offsets()),
            homed: Homed::new([start.is_some(); 3]),
            first_layer: FirstLayer::new(settings),
            circulation: Circulation::new(),
            trimming: Trimming::new(),
            probing: Probing::new(),
            bed: KnownBed::new(),
            power: Power::new(motors, bus, settings, now),
            servo,
            board,
            heat: Heaters::new(status.heat(), orders, &settings.thermal, now),
            storage,
            accelerometer,
            status,
            clock,
            comes_again: false,
            turn_began: now,
            progress: Progress::default(),
            limping: Limping::new(),
            is_to_restart: false,
        }
    }
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// There is more to do at once: the next turn is wanted before anything happens.
    pub const fn come_again(&mut self) {
        self.comes_again = true;
    }

    /// The time.
    pub fn now(&self) -> Instant {
        self.clock.now()
    }

    /// When the present turn began.
    pub const fn turn_began(&self) -> Instant {
        self.turn_began
    }

    /// Lets the world go round once, without waiting for anything to happen.
    async fn poll_again(&mut self) -> Result<(), Interrupt> {
        self.come_again();
        self.poll().await
    }

    /// Lets the world go round once.
    pub async fn poll(&mut self) -> Result<(), Interrupt> {
        let comes_again = core::mem::take(&mut self.comes_again);
        yield_once(comes_again).await;
        if !comes_again {
            // Time has passed.
            self.motion.follow_stream();
        }
        self.go_on()
    }

    /// Waits until `done`.
    async fn until(&mut self, done: fn(&mut Self) -> bool) -> Result<(), Interrupt> {
        while !done(self) {
            self.poll().await?;
        }
        Ok(())
    }

    /// One turn of the main loop. Bounded by the received bytes. Emergencies are read first and returned last, after
    /// all other work of the turn: the abort that follows drops moves that are still handed on after M112.
    fn go_on(&mut self) -> Result<(), Interrupt> {
        self.status.heat().beat_of_console();
        let now = self.now();
        self.turn_began = now;
        let emergency = self.receive();
        self.hosts.greet(Replies::start);
        self.tell_known();
        self.tend_drivers(now)?;
        self.feed_motion(now);
        self.scrub(now);
        self.tend_heat(now)?;
        let keepalive_ms = u32::from(self.settings.keepalive_s) * 1000;
        self.status.set_awaiting_user(self.job.is_paused());
        self.hosts.keep_alive(now, keepalive_ms);
        let (may_owe, may_schedule) = self.hosts.may_get_unasked();
        if may_owe {
            self.answer_early();
        }
        if may_schedule {
            self.report_unasked(now);
        }
        self.hosts.send();
        match emergency {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// The part of every turn that hands moves on.
    fn feed_motion(&mut self, now: Instant) {
        match self.motion.feed(&self.settings, now) {
            Fed::Nothing => {}
            Fed::More => self.come_again(),
            Fed::Move => {
                // It may be over before the next check for idleness.
                self.power.note_motion(now);
                self.come_again();
            }
        }
    }
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Tells the other contexts what is known of the place of the tool.
    fn tell_known(&self) {
        let bed = self.probing.awaited();
        let below = bed.map_or_else(|| self.first_layer.below(), |z| -z);
        let below_um = ((below.to_bits() * 1000) >> 32) as i32;
        let touches = bed.is_some();
        self.status.set_known(Known { homed: self.homed.axes(), touches, below_um });
    }
}

/// Gives all other contexts a turn; wakes itself if it wants the next one at once.
async fn yield_once(comes_again: bool) {
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
