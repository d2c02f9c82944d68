//! `corehbot serve`: the firmware as a printer at the end of a serial line, in real time or faster.
//!
//! The loop runs the same world as `corehbot run`, but with a real host at a pseudo-terminal, and virtual time keeps
//! step with the wall clock. After M112, M999 restarts on the same line. It ends with a signal, which is not a failure.

mod echo;
mod keep;
mod screen;
mod wire;

use anyhow::{Context as _, Result, ensure};
use clap::Args;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_host::accident_args::AccidentArgs;
use corehbot_host::bed_args::BedArgs;
use corehbot_host::heat_args::HeatArgs;
use corehbot_host::output::{Outputs, STANDARD, Stream};
use corehbot_host::plant_args::PlantArgs;
use corehbot_host::printer::Printer;
use corehbot_host::say::println;
use corehbot_host::serial::{Hand, Pace, Port, Surroundings};
use corehbot_host::status::DONE;
use corehbot_host::stop::Stop;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::accident::Accident;
use corehbot_sim::belt::BeltPlant;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::trace::TraceWriter;
use corehbot_sim::user_actions::Act;
use corehbot_sim::wiring_mistakes::Plugs;
use corehbot_sim::world::{Desk, Outcome, SimBoard, Sink, World};
use echo::Echo;
use screen::Screen;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use wire::Delay;

/// At full speed the port is polled no more often than this: a poll takes a microsecond, and so does a virtual
/// millisecond.
const LOOK: Duration = Duration::from_micros(100);

/// The printer to run, and its port.
#[derive(Args)]
pub(crate) struct Serve {
    /// Makes a link to the serial port here; without it, the port's own name is printed.
    #[arg(long, value_name = "PATH")]
    pty: Option<PathBuf>,
    /// Sends and receives bytes no faster than a UART at this rate; without it, the line takes no time.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=10_000_000))]
    baud: Option<u32>,
    #[command(flatten)]
    around: Surroundings,
    #[command(flatten)]
    plant: PlantArgs,
    #[command(flatten)]
    accidents: AccidentArgs,
    #[command(flatten)]
    heat: HeatArgs,
    #[command(flatten)]
    bed: BedArgs,
    #[command(flatten)]
    printer: Printer,
    /// Echoes typed text, for terminal programs without an echo of their own; not for hosts.
    #[arg(long)]
    echo: bool,
    /// Writes every step event as CSV.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
}

/// Everything that can be wrong before there is a printer.
pub(crate) struct Prepared {
    settings: Settings,
    board: SimBoard,
    belt: Option<Box<BeltPlant>>,
    heat: HeatSetup,
    bed: Option<Box<BedPlant>>,
    probe_accidents: Vec<Accident>,
    plugs: Option<Plugs>,
    eeprom: Option<Eeprom>,
    /// Held as long as it is served, so that no other printer keeps its settings there.
    lock: Option<File>,
    trace: TraceWriter<BufWriter<Stream>>,
    outputs: Outputs,
    port: Port,
    stop: Stop,
}

impl Prepared {
    pub fn new(args: &Serve) -> Result<Self> {
        let machine = args.printer.machine()?;
        let breaks = args.accidents.read(&machine.settings, args.plant.has_belts())?;
        let belt = args.plant.belt(&machine, args.printer.assume_homed, &breaks)?;
        let (name, settings, board) = (machine.name, machine.settings, SimBoard::of(&machine.texts));
        let (heat, probe_accidents) = (args.heat.setup(&settings, breaks.heat)?, breaks.probe);
        let bed = args.bed.plant(&settings)?;
        let plugs = args.around.plugs(&settings)?;
        let mut outputs = Outputs::new(args.printer.files().chain(args.heat.file()), Stop::default());
        let is_standard = args.trace.as_deref() == Some(Path::new(STANDARD));
        ensure!(!is_standard, "standard output is for the port's name and the figures: the trace needs a file");
        let trace = args.trace.as_deref().map(|path| outputs.open(path)).transpose()?;
        let stop = Stop::at_signals()?;
        let port = Port::open(args.pty.as_deref())?;
        // Last: a command that is refused leaves nothing behind.
        let (eeprom, lock) = match args.printer.says_storage() {
            true => (args.printer.eeprom()?, None),
            false => keep::eeprom(name.as_deref(), &settings),
        };
        let trace = TraceWriter::new(trace, (&settings).into());
        Ok(Self { settings, board, belt, heat, bed, probe_accidents, plugs, eeprom, lock, trace, outputs, port, stop })
    }

    /// Is a printer until a signal comes.
    pub fn run(self, args: &Serve) -> Result<u8> {
        let Self { settings, board, mut belt, heat, mut bed, mut probe_accidents, plugs, .. } = self;
        let Self { mut eeprom, lock: _lock, mut trace, outputs, port, stop, .. } = self;
        println(format_args!("{}", port.path().display()))?;
        let drivers = Drivers::new();
        for motor in plugs.iter().flat_map(|plugs| plugs.silent.iter()) {
            drivers.chip(motor).is_silent = true;
        }
        let mut start = args.printer.assume_homed;
        let mut place = start.unwrap_or(corehbot_rig::AT_POWER_UP);
        let mut total = Total::default();
        let mut server = Server {
            port,
            pace: Pace::new(args.around.speed),
            begin: Instant::now(),
            inbound: Delay::new(args.baud),
            outbound: Delay::new(args.baud),
            echo: args.echo.then(Echo::default),
            hand: args.around.hand(),
        };
        let (mut now, mut plant) = (0, None);
        loop {
            let mut desk = Desk::at(1, now);
            (desk.belt, desk.heat, desk.plant) = (belt.take(), heat.clone(), plant.take());
            (desk.bed, desk.probe_accidents) = (bed.take(), std::mem::take(&mut probe_accidents));
            (desk.board, desk.is_strict) = (board, false);
            desk.plugs.clone_from(&plugs);
            let mut sink = Later { trace: &mut trace, ticks: total.ticks };
            let mut world = match &mut eeprom {
                Some(eeprom) => World::standing(&mut desk, &settings, Some(place), start, eeprom, &drivers, &mut sink),
                None => World::standing(&mut desk, &settings, Some(place), start, NoStorage, &drivers, &mut sink),
            };
            let mut screen = Screen::new(&settings, place);
            let left = server.serve(&mut world, &mut screen, &stop)?;
            screen.close();
            let outcome = world.outcome();
            total.add(&outcome);
            if let Some(beyond) = world.beyond() {
                println(format_args!("violation: {beyond}"))?;
            }
            let ended = world.now();
            plant = world.take_plant();
            drop(world);
            (belt, bed) = (desk.belt.take(), desk.bed.take());
            // Those that are over are not repeated.
            probe_accidents = std::mem::take(&mut desk.probe_accidents);
            probe_accidents.retain(|accident| accident.at_s * f64::from(TICKS_PER_SECOND) > ended as f64);
            if left == Left::Off {
                break;
            }
            // The next one begins where the tool stands, and does not know where that is.
            (place, start, now) = (screen.place(outcome.counts).map(Mm::from_num), None, ended);
        }
        let trace = trace.finish().context("cannot write the trace")?;
        outputs.keep()?;
        println(format_args!("motion time  {:.3} s", total.ticks as f64 / f64::from(TICKS_PER_SECOND)))?;
        println(format_args!("moves        {}, underruns {}", total.moves, total.underruns))?;
        println(format_args!("sha256       {}", trace.sha256))?;
        if let Some(mut plant) = belt {
            plant.ring_out();
            println(format_args!("\n{}", plant.figures().to_string().trim_end()))?;
        }
        Ok(DONE)
    }
}

/// Totals of all starts of a printer.
#[derive(Default)]
struct Total {
    ticks: u64,
    moves: u32,
    underruns: u32,
}

impl Total {
    const fn add(&mut self, outcome: &Outcome) {
        self.ticks += outcome.ticks;
        self.moves += outcome.moves;
        self.underruns += outcome.underruns;
    }
}

/// A trace that continues after a restart; the restart begins motion time at 0 again.
struct Later<'t> {
    trace: &'t mut TraceWriter<BufWriter<Stream>>,
    ticks: u64,
}

impl Sink for Later<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.trace.event(self.ticks + tick, steps, forward);
    }
}

/// Why a printer is served no longer.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Left {
    /// It begins anew.
    Restarted,
    /// A signal has come, or it was switched off.
    Off,
}

/// The line between a printer and the world outside.
struct Server {
    port: Port,
    pace: Pace,
    begin: Instant,
    inbound: Delay,
    outbound: Delay,
    echo: Option<Echo>,
    hand: Option<Hand>,
}

impl Server {
    /// Serves a printer until a signal comes, or until the printer restarts.
    fn serve(&mut self, world: &mut World<'_>, screen: &mut Screen, stop: &Stop) -> Result<Left> {
        let mut look = Duration::ZERO;
        while !(stop.is_set() || world.has_ended()) {
            let wall = self.begin.elapsed();
            if wall >= look {
                self.hear_host(world)?;
                if let Some(left) = self.obey_hand(world) {
                    return Ok(left);
                }
                screen.show(wall, world);
                look = wall + LOOK;
            }
            self.talk(world, screen)?;
            let is_on_the_way = !(self.inbound.is_empty() && self.outbound.is_empty());
            let is_awaiting_host = !is_on_the_way && world.is_awaiting_hosts();
            let wait = self.pace.wait(wall, world.now(), is_awaiting_host);
            if wait.is_zero() {
                world.advance();
            } else {
                self.port.wait(wait, None)?;
                look = Duration::ZERO;
            }
        }
        Ok(if world.has_ended() { Left::Restarted } else { Left::Off })
    }

    /// Does what a hand does.
    fn obey_hand(&mut self, world: &mut World<'_>) -> Option<Left> {
        let now = world.now();
        for act in self.hand.iter_mut().flat_map(|hand| hand.acts(now)) {
            match act {
                Act::Reset => return Some(Left::Restarted),
                Act::Off => return Some(Left::Off),
                act => act.touch(world),
            }
        }
        None
    }

    fn hear_host(&mut self, world: &World<'_>) -> Result<()> {
        let now = world.now();
        let mut bytes = Vec::new();
        self.port.read(&mut bytes)?;
        if !bytes.is_empty() {
            self.pace.hear(world.status().planned().0);
            if let Some(echo) = &mut self.echo {
                self.outbound.send(now, echo.show(&bytes));
            }
            self.inbound.send(now, bytes);
        }
        Ok(())
    }

    /// Bytes arrive on both ends of the wire.
    fn talk(&mut self, world: &mut World<'_>, screen: &mut Screen) -> Result<()> {
        let now = world.now();
        for wire in world.wires() {
            wire.put(self.inbound.receive(now));
            world.poll();
            let said = wire.heard();
            screen.hear(&said);
            self.outbound.send(now, said);
        }
        self.port.write(self.outbound.receive(now))
    }
}
