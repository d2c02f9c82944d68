//! The console: lines in, replies out, one command after the other.

use super::flow::Flow;
use super::limits::Homed;
use super::modal::Modal;
use crate::gcode;
use crate::motion::{Link, Planner};
use crate::port::{Clock, DriverBus, MotorSet, Pend, Serial, Storage, ThermalPort};
use crate::protocol::{Emergency, Incoming, NoRoom, Receiver, Replies};
use crate::settings::Settings;
use crate::units::{Instant, Mm};
use core::convert::Infallible;
use core::fmt;
use core::future::poll_fn;
use core::task::Poll;
use heapless::Vec;

/// A command's text, copied out of the receiver so that lines can go on arriving while it is carried out.
type Text = Vec<u8, 320>;

/// Motors lose power when nothing has moved for this long, unless M84 S says otherwise; Klipper's
/// idle_timeout is as long.
const IDLE_TIMEOUT_S: u32 = 600;

/// What the Console needs of a board.
pub struct Ports<S: Serial, D: DriverBus, K: Clock, T: Storage, H: ThermalPort> {
    /// The line to the host.
    pub serial: S,
    /// The motor drivers.
    pub drivers: D,
    /// The clock.
    pub clock: K,
    /// Memory for settings; [`NoStorage`](crate::port::NoStorage) if there is none.
    pub storage: T,
    /// The temperature sensors; [`NoSensors`](crate::port::NoSensors) if there are none.
    pub sensors: H,
}

/// The types of a set of [`Ports`], so that one parameter names them all.
pub trait PortSet {
    /// The line to the host.
    type Serial: Serial;
    /// The motor drivers.
    type Drivers: DriverBus;
    /// The clock.
    type Clock: Clock;
    /// Memory for settings.
    type Storage: Storage;
    /// The temperature sensors.
    type Sensors: ThermalPort;
}

impl<S: Serial, D: DriverBus, K: Clock, T: Storage, H: ThermalPort> PortSet for Ports<S, D, K, T, H> {
    type Serial = S;
    type Drivers = D;
    type Clock = K;
    type Storage = T;
    type Sensors = H;
}

/// The ports that have the types of `P`, which is `P` itself.
type PortsOf<P> = Ports<
    <P as PortSet>::Serial,
    <P as PortSet>::Drivers,
    <P as PortSet>::Clock,
    <P as PortSet>::Storage,
    <P as PortSet>::Sensors,
>;

/// Why a command ends before it is done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Interrupt {
    /// M112, or a fault that only a reset ends.
    Halt,
    /// M410.
    QuickStop,
}

/// The Console.
pub struct Console<'m, P: PortSet, W: Pend> {
    pub(super) ports: PortsOf<P>,
    receiver: Receiver,
    pub(super) replies: Replies,
    pub(super) link: Link<'m, W>,
    pub(super) planner: Planner,
    pub(super) flow: Flow,
    pub(super) settings: Settings,
    /// The settings that the machine was made with.
    pub(super) defaults: Settings,
    pub(super) modal: Modal,
    pub(super) homed: Homed,
    /// Position of each motor group at count 0, in steps.
    pub(super) origin: [i32; 4],
    /// Motors that have power.
    pub(super) powered: MotorSet,
    /// Seconds without motion until they lose it; 0 is never.
    pub(super) idle_timeout_s: u32,
    pub(super) last_motion: Instant,
    /// A received line has not been answered yet, since when.
    owes_ok: Option<Instant>,
    /// M108 came since the present command began.
    pub(super) continued: bool,
    /// Lines up to this place of the receiver came before a quick stop, which forgets them.
    forgotten: Option<u32>,
    /// An axis is being homed.
    pub(super) is_homing: bool,
    /// The host was told of a target beyond the edge.
    pub(super) told_of_edge: bool,
    /// The host was told that there are no heaters.
    pub(super) told_of_heaters: bool,
}

impl<'m, S: Serial, D: DriverBus, K: Clock, T: Storage, H: ThermalPort, W: Pend> Console<'m, Ports<S, D, K, T, H>, W> {
    /// A Console of a machine that stands at `start` if that is known, as if homed.
    pub fn new(settings: Settings, start: Option<[Mm; 3]>, link: Link<'m, W>, ports: Ports<S, D, K, T, H>) -> Self {
        let [x, y, z] = start.unwrap_or_default();
        let now = ports.clock.now();
        Self {
            ports,
            receiver: Receiver::new(),
            replies: Replies::new(),
            link,
            planner: Planner::new(&settings, [x, y, z, Mm::ZERO]),
            flow: Flow::new(),
            settings,
            defaults: settings,
            modal: Modal::new([x, y, z]),
            homed: Homed([start.is_some(); 3]),
            origin: [0; 4],
            powered: MotorSet::NONE,
            idle_timeout_s: IDLE_TIMEOUT_S,
            last_motion: now,
            owes_ok: None,
            continued: false,
            forgotten: None,
            is_homing: false,
            told_of_edge: false,
            told_of_heaters: false,
        }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// The settings as they are now.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Serves the host for ever. Poll it when bytes arrived, when a queue moved, and every millisecond.
    pub async fn run(&mut self) -> Infallible {
        self.ports.drivers.enable(MotorSet::NONE);
        loop {
            let interrupt = match self.start_and_serve().await {
                Ok(never) => match never {},
                Err(interrupt) => interrupt,
            };
            if interrupt == Interrupt::Halt || self.quick_stop().await.is_err() {
                self.stay_halted().await;
            }
        }
    }

    async fn start_and_serve(&mut self) -> Result<Infallible, Interrupt> {
        if self.link.is_fresh() {
            let found = self.load_at_start().await?;
            self.adopt_position(self.planner.end()).await?;
            self.answer(Replies::start).await?;
            self.say(format_args!("echo:corehbot {}", env!("CARGO_PKG_VERSION"))).await?;
            self.report_start(found).await?;
        }
        // A command that an emergency ended is answered all the same.
        if self.owes_ok.is_some() {
            self.answer(Replies::ok).await?;
            self.owes_ok = None;
            self.continued = false;
        }
        self.serve().await
    }

    async fn serve(&mut self) -> Result<Infallible, Interrupt> {
        loop {
            let now = self.ports.clock.now();
            let mut text = Text::new();
            let Some(incoming) = self.receiver.next_line(now) else {
                self.link.status().set_awaiting_input(true);
                self.turn().await?;
                continue;
            };
            let answer = match incoming {
                Incoming::Command(line) => {
                    let kept = line.get(..text.capacity()).unwrap_or(line);
                    let _ = text.extend_from_slice(kept);
                    None
                }
                Incoming::Acknowledge => Some(Answer::Ok),
                Incoming::LineNumber { report } => Some(Answer::LineNumber(report)),
                Incoming::TooLong => Some(Answer::TooLong),
                Incoming::Resend { reason, last } => Some(Answer::Resend(reason, last)),
            };
            self.link.status().set_awaiting_input(false);
            self.owes_ok = Some(now);
            self.forgotten = self.forgotten.filter(|place| self.receiver.is_within(*place));
            match answer {
                None if self.forgotten.is_some() => self.answer(Replies::ok).await?,
                None => self.carry_out(&text).await?,
                Some(Answer::Ok) => self.answer(Replies::ok).await?,
                Some(Answer::LineNumber(report)) => {
                    self.told_of_edge = false;
                    self.answer(|r| r.line_number(report)).await?;
                }
                Some(Answer::TooLong) => self.answer(Replies::too_long).await?,
                Some(Answer::Resend(reason, last)) => self.answer(|r| r.resend(reason, last)).await?,
            }
            self.owes_ok = None;
            self.continued = false;
        }
    }

    async fn carry_out(&mut self, text: &[u8]) -> Result<(), Interrupt> {
        match gcode::parse(text) {
            gcode::Command::Unknown(what) => self.answer(|r| r.unknown(what)).await,
            // The temperatures stand in the line of the ok itself.
            gcode::Command::ReportTemperatures => self.report_temperatures().await,
            command => {
                self.execute(&command).await?;
                self.answer(Replies::ok).await
            }
        }
    }

    /// Writes an answer as soon as there is room for it.
    pub(super) async fn answer(&mut self, write: impl Fn(&mut Replies) -> Result<(), NoRoom>) -> Result<(), Interrupt> {
        while write(&mut self.replies).is_err() {
            self.turn().await?;
        }
        self.send();
        Ok(())
    }

    /// Writes one line as soon as there is room for it.
    pub(super) async fn say(&mut self, line: fmt::Arguments<'_>) -> Result<(), Interrupt> {
        self.answer(|replies| replies.line(line)).await
    }

    /// Lets the world go round once.
    pub(super) async fn turn(&mut self) -> Result<(), Interrupt> {
        yield_once().await;
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
        self.feed_motion();
        self.keep_alive();
        self.watch_idleness();
        self.send();
        match emergency {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }

    fn receive(&mut self) -> Option<Interrupt> {
        let mut found = None;
        while self.receiver.has_room() {
            let Some(received) = self.ports.serial.recv() else {
                break;
            };
            match self.receiver.feed(received) {
                Some(Emergency::Stop) => return Some(Interrupt::Halt),
                Some(Emergency::QuickStop) => {
                    self.forgotten = Some(self.receiver.place());
                    found = Some(Interrupt::QuickStop);
                }
                Some(Emergency::Continue) => self.continued = true,
                None => {}
            }
        }
        found
    }

    fn send(&mut self) {
        loop {
            let pending = self.replies.pending();
            if pending.is_empty() {
                return;
            }
            let sent = self.ports.serial.send(pending);
            if sent == 0 {
                return;
            }
            self.replies.sent(sent);
        }
    }

    /// A host that waits for an `ok` is told from time to time that there is somebody.
    fn keep_alive(&mut self) {
        let every = u32::from(self.settings.keepalive_s) * 1000;
        let now = self.ports.clock.now();
        if let Some(since) = self.owes_ok
            && every > 0
            && now >= since.after_ms(every)
            && self.replies.busy().is_ok()
        {
            self.owes_ok = Some(now);
        }
    }

    fn watch_idleness(&mut self) {
        let now = self.ports.clock.now();
        if !self.link.is_idle() || !self.planner.is_empty() {
            self.last_motion = now;
        } else if self.idle_timeout_s > 0
            && !self.powered.is_empty()
            && now >= self.last_motion.after_ms(self.idle_timeout_s.saturating_mul(1000))
        {
            self.unpower(MotorSet::ALL);
        }
    }

    /// The Console after M112: it answers, but nothing else, until a reset.
    async fn stay_halted(&mut self) -> Infallible {
        self.link.status().set_halted();
        self.ports.drivers.enable(MotorSet::NONE);
        self.link.abort();
        self.link.status().set_awaiting_input(true);
        let _ = self.replies.killed();
        loop {
            yield_once().await;
            self.receive();
            let now = self.ports.clock.now();
            while self.receiver.next_line(now).is_some() {
                let _ = self.replies.killed();
            }
            self.send();
        }
    }
}

enum Answer {
    Ok,
    LineNumber(Option<i32>),
    TooLong,
    Resend(crate::protocol::ResendReason, i32),
}

/// Gives the rest of the world a turn.
async fn yield_once() {
    let mut yielded = false;
    poll_fn(|_| if core::mem::replace(&mut yielded, true) { Poll::Ready(()) } else { Poll::Pending }).await;
}
