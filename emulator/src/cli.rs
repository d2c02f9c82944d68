//! Command line of `corehbot-emulator`.
//!
//! | exit status | meaning |
//! |---|---|
//! | 0 | the image printed the file with the host's steps, or did nothing forbidden at the terminal |
//! | 1 | it did not |
//! | 2 | nothing was run |

use crate::clock_tree::Defect;
use crate::compare::{self, Lateness, Timing};
use crate::driver_line::DriverLines;
use crate::eeprom::At24c32;
use crate::firmware::Firmware;
use crate::flash::FlashSectors;
use crate::heat_pins::Climate;
use crate::line::Manner;
use crate::run::{Request, Seen, serve};
use crate::sensor::Sensor;
use crate::steps::StepEvent;
use crate::terminal::Terminal;
use crate::tick::NS_PER_TICK;
use crate::watch::{End, Patience};
use crate::wiring::{NUCLEO, OCTOPUS, SettingsMemory, Wiring};
use anyhow::{Result, bail, ensure};
use clap::Parser;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot_host::accident_args::AccidentArgs;
use corehbot_host::heat_args::HeatArgs;
use corehbot_host::input::{self, Plate};
use corehbot_host::output::{Outputs, STANDARD, Stream};
use corehbot_host::plant_args::PlantArgs;
use corehbot_host::say::println;
use corehbot_host::serial::{Port, Surroundings};
use corehbot_host::stop::Stop;
use corehbot_machine_file as machine_file;
use corehbot_machine_file::printable;
use corehbot_sim::belt::BeltSetup;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::trace::TraceWriter;
use corehbot_sim::vcd::VcdWriter;
use corehbot_sim::wiring_mistakes::Plugs;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A virtual second in ns.
const SECOND: u64 = 1_000_000_000;

/// Runs a flashable image on an emulated board and compares its steps with the host simulator's.
#[derive(Parser)]
#[command(name = "corehbot-emulator", version)]
struct Cli {
    /// The release ELF file, as `cargo xtask build octopus` or `nucleo` made it.
    elf: PathBuf,
    /// G-code file to print.
    #[arg(required_unless_present = "pty")]
    file: Option<PathBuf>,
    /// Is a printer at the end of a serial line until Ctrl-C, and makes a link to it here: a pseudo-terminal at the
    /// board's UART, for hosts and `corehbot bringup`.
    #[arg(long, value_name = "PATH", conflicts_with_all = ["file", "usbip"])]
    pty: Option<PathBuf>,
    /// The board that the image is for.
    #[arg(long, value_enum, default_value_t = Board::Octopus)]
    board: Board,
    /// The machine, stored in the EEPROM of the Octopus, or put into the image of the Nucleo; without it, the CoreH-bot
    /// prototype.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    settings: Option<PathBuf>,
    /// Writes the step events as they are on the pins: ticks are real time in 0.1 us since reset.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Writes the step events as VCD, for GTKWave and PulseView.
    #[arg(long, value_name = "V.vcd")]
    vcd: Option<PathBuf>,
    /// The rate at which the image talks; the run fails if it is another.
    #[arg(long, value_name = "N", default_value_t = 250_000)]
    baud: u32,
    /// A Linux computer prints FILE over USB: `usbip attach -r HOST -b 1-1`, and then it sends FILE to the new ttyACM.
    #[arg(long, value_name = "HOST:3240")]
    usbip: Option<String>,
    /// Prints the conversation.
    #[arg(long)]
    talk: bool,
    #[command(flatten)]
    around: Surroundings,
    /// The load on the motors.
    #[command(flatten)]
    plant: PlantArgs,
    #[command(flatten)]
    accidents: AccidentArgs,
    #[command(flatten)]
    heat: HeatArgs,
    /// Virtual time after which a print is given up, in s.
    #[arg(long, value_name = "S", default_value_t = 3600)]
    limit: u64,
}

/// A board with an image that runs here.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Board {
    /// BTT Octopus V1.0 or V1.1.
    Octopus,
    /// Nucleo-F446RE with a CNC shield v3, which has no motors for Z and the extruder.
    Nucleo,
}

impl Board {
    const fn wiring(self) -> &'static Wiring {
        match self {
            Self::Octopus => &OCTOPUS,
            Self::Nucleo => &NUCLEO,
        }
    }
}

/// The print, and its machine.
struct Prepared {
    firmware: Firmware,
    gcode: String,
    /// The machine, and the EEPROM that holds it, if it differs from the image's machine.
    settings: Settings,
    eeprom: Eeprom,
    heat: HeatSetup,
    plugs: Option<Plugs>,
    belt: Option<BeltSetup>,
    terminal: Option<Terminal>,
    outputs: Outputs,
    trace: Option<BufWriter<Stream>>,
    vcd: Option<BufWriter<Stream>>,
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    match prepare(&cli).map(|prepared| execute(&cli, prepared)) {
        Ok(Ok(true)) => ExitCode::SUCCESS,
        Ok(Ok(false)) => ExitCode::from(1),
        Ok(Err(error)) => complain(&error, 1),
        Err(error) => complain(&error, 2),
    }
}

fn complain(error: &anyhow::Error, status: u8) -> ExitCode {
    eprintln!("corehbot-emulator: {}", printable::lines(&format!("{error:#}")));
    ExitCode::from(status)
}

fn prepare(cli: &Cli) -> Result<Prepared> {
    let mut eeprom = Eeprom::blank();
    // A board without a machine gives no motor power.
    let (mut settings, twin) = match &cli.settings {
        Some(path) => machine_file::read(path).map(|machine| (machine.settings, machine.twin))?,
        None => (Settings::prototype(), Default::default()),
    };
    let mut firmware = Firmware::read(&cli.elf)?;
    match cli.board.wiring().settings {
        SettingsMemory::Eeprom => eeprom.save(&settings)?,
        SettingsMemory::Flash => firmware.put_machine(&mut settings)?,
    }
    let gcode = cli.file.as_deref().map(|file| input::read(file, Plate::default())).transpose()?.unwrap_or_default();
    let breaks = cli.accidents.read(&settings, cli.plant.has_belts())?;
    ensure!(breaks.probe.is_empty(), "--break: a probe does not break here; `corehbot serve` has that");
    let belt = cli.plant.setup(&twin, &breaks)?;
    let (heat, plugs) = (cli.heat.setup(&settings, breaks.heat)?, cli.around.plugs(&settings)?);
    let inputs = [Some(&cli.elf), cli.file.as_ref(), cli.settings.as_ref()];
    let mut outputs = Outputs::new(inputs.into_iter().flatten().map(PathBuf::as_path), Stop::default());
    let mut open = |path: &Option<PathBuf>| match path.as_deref() {
        Some(path) if path == Path::new(STANDARD) => {
            bail!("standard output is for what was seen: a trace needs a file")
        }
        path => path.map(|path| outputs.open(path)).transpose(),
    };
    let (trace, vcd) = (open(&cli.trace)?, open(&cli.vcd)?);
    let hand = cli.around.hand();
    ensure!(hand.is_none() || cli.pty.is_some(), "--hand needs --pty: a print waits for nobody");
    let open_terminal = |path: &PathBuf| -> Result<_> {
        Ok(Terminal::new(Port::open(Some(path))?, cli.around.speed, Stop::at_signals()?, hand))
    };
    let terminal = cli.pty.as_ref().map(open_terminal).transpose()?;
    Ok(Prepared { firmware, gcode, settings, eeprom, heat, plugs, belt, terminal, outputs, trace, vcd })
}

fn execute(cli: &Cli, prepared: Prepared) -> Result<bool> {
    let Prepared { firmware, gcode, settings, mut eeprom, heat, plugs, belt, terminal, outputs, trace, vcd } = prepared;
    if let Some(path) = &cli.pty {
        println(format_args!("{}", path.display()))?;
    }
    println!("image     {}", firmware.path.display());
    println!("sha256    {}", firmware.sha256);
    if let Some(path) = &cli.settings {
        let place = match cli.board.wiring().settings {
            SettingsMemory::Eeprom => "stored in the EEPROM",
            SettingsMemory::Flash => "put into the image",
        };
        println!("settings  {}, {place}", printable::line(&path.to_string_lossy()));
    }
    let limit = if terminal.is_some() { u64::MAX } else { cli.limit * SECOND };
    let patience = Patience { whole: limit, silent: 30 * SECOND, after_reset: SECOND };
    let wiring = cli.board.wiring();
    let sensor = settings.accelerometer.kind.filter(|_| wiring.sensor.is_some()).map(Sensor::new);
    let (drivers, chip) = (DriverLines::new(wiring), At24c32::holding(eeprom.cells().to_vec()));
    let request = Request {
        firmware: &firmware,
        wiring,
        settings: &settings,
        gcode: &gcode,
        second: None,
        manner: Manner::default(),
        network: cli.usbip.as_deref(),
        patience,
        injection: None,
        drivers: &drivers,
        eeprom: &chip,
        flash: &FlashSectors::default(),
        thermistors: &[],
        climate: Climate::default(),
        heat: &heat,
        plugs: plugs.as_ref(),
        belt: belt.as_ref(),
        slow_oscillator: None,
        sensor: sensor.as_ref(),
        stuck: None,
        defect: Defect::None,
    };
    let seen = serve(&request, terminal)?;
    write_files(trace, vcd, &settings, &seen.recorder.events)?;
    outputs.keep()?;
    print_run(cli, &seen);
    if cli.pty.is_some() {
        return Ok(is_sound(&seen));
    }
    let host = match &cli.settings {
        Some(_) if wiring.settings == SettingsMemory::Eeprom => {
            compare::scheduled_stored(&gcode, &settings, &mut eeprom, belt.as_ref())?
        }
        _ => compare::scheduled_with(&gcode, &settings, NoStorage, belt.as_ref())?,
    };
    let host = compare::of_motors(&host, wiring.motors());
    let pins = &seen.recorder.events;
    let mut ok = seen.end == End::Done && seen.line.failure.is_none() && seen.resets.is_empty() && is_sound(&seen);
    match compare::difference(pins, &host) {
        None => {
            println!("sequence  equal to the host's: {} events", pins.len());
            print_timing(&compare::timing(pins, &host), &seen);
        }
        Some(difference) => {
            ok = false;
            println!("sequence  NOT the host's ({} events, host {}): {difference}", pins.len(), host.len());
            let same = difference.event;
            print_timing(&compare::timing(&pins[..same], &host[..same]), &seen);
        }
    }
    // USB has no rate.
    if let Err(error) = seen.check_baud(cli.baud)
        && cli.usbip.is_none()
    {
        println!("baud      {error}");
        ok = false;
    }
    Ok(ok)
}

/// Whether the image did nothing that is forbidden.
fn is_sound(seen: &Seen) -> bool {
    let is_safe = seen.safety.dangers.is_empty() && seen.gaps.found.is_empty();
    let keeps_rules = seen.breaches.is_empty() && seen.flash.faults.is_empty() && seen.usb_breaches.is_empty();
    is_safe
        && keeps_rules
        && seen.sensor_breaches.is_empty()
        && seen.recorder.unpowered == 0
        && seen.recorder.split_pairs == 0
}

fn print_run(cli: &Cli, seen: &Seen) {
    if cli.talk {
        for line in &seen.line.said {
            println!("said      {}", printable::line(line));
        }
    }
    let ms = |ns: u64| ns as f64 / 1e6;
    println!("end       {:?} at {:.3} ms, {} instructions", seen.end, ms(seen.virtual_ns), seen.instructions);
    println!("wall      {:.2} s", seen.wall.as_secs_f64());
    println!("clock     {} MHz, host line {:.0} baud", seen.core_hz / 1_000_000, seen.line.baud);
    match seen.started {
        Some(ns) => println!("greeting  {:.3} ms after reset", ms(ns)),
        None => println!("greeting  none"),
    }
    println!(
        "line      {} bytes in, {} bytes out, {} resends",
        seen.line.bytes[0], seen.line.bytes[1], seen.line.resends
    );
    for warning in &seen.line.warnings {
        println!("odd       {}", printable::line(warning));
    }
    if let Some(failure) = &seen.line.failure {
        println!("FAILED    {}", printable::line(failure));
    }
    if let Some(figures) = &seen.belt {
        print!("{figures}");
    }
    for reset in &seen.resets {
        println!("RESET     {:.3} ms, {:?}", ms(reset.at.0), reset.cause);
    }
    for (at, danger) in &seen.safety.dangers {
        println!("DANGER    {:.3} ms, {danger:?}", ms(*at));
    }
    for breach in &seen.breaches {
        println!("CLOCK     {breach}");
    }
    for breach in &seen.usb_breaches {
        println!("usb       {breach:?}");
    }
    for breach in &seen.sensor_breaches {
        println!("SENSOR    {breach}");
    }
    for fault in &seen.flash.faults {
        println!("FLASH     {fault}");
    }
    for gap in &seen.gaps.found {
        println!("GAP       {gap}");
    }
    for gap in &seen.gaps.allowed {
        println!("allowed   {gap}");
    }
}

fn print_lateness(name: &str, late: &Lateness) {
    let us = |share: f64| late.quantile(share) as f64 / 1000.0;
    println!(
        "{name:<9} {} events: min {:.3}, median {:.3}, 90 % {:.3}, 99 % {:.3}, 99.9 % {:.3}, max {:.3} us",
        late.0.len(),
        us(0.0),
        us(0.5),
        us(0.9),
        us(0.99),
        us(0.999),
        us(1.0),
    );
}

fn print_timing(timing: &Timing, seen: &Seen) {
    print_lateness("lateness", &timing.late);
    print_lateness("longest", &timing.longest);
    println!("starts    {}, {} events stretched time", timing.starts, timing.stretched);
    println!("schedule  {} events at the host's tick, {} at another", timing.exact, timing.inexact);
    let recorder = &seen.recorder;
    let shown = |ns: u64| if ns == u64::MAX { "-".to_owned() } else { format!("{ns}") };
    println!(
        "edges     {} split pairs, {} steps without power, spread {} ns; high {}, low {}, dir to step {} ns at least",
        recorder.split_pairs,
        recorder.unpowered,
        timing.spread,
        shown(recorder.pulse.high),
        shown(recorder.pulse.low),
        shown(recorder.pulse.set_up),
    );
}

fn write_files(
    trace: Option<BufWriter<Stream>>,
    vcd: Option<BufWriter<Stream>>,
    settings: &Settings,
    events: &[StepEvent],
) -> Result<()> {
    if let Some(out) = trace {
        let mut trace = TraceWriter::new(Some(out), settings.into());
        for event in events {
            trace.event(event.at / NS_PER_TICK, event.steps, event.forward);
        }
        trace.finish()?;
    }
    if let Some(out) = vcd {
        let mut vcd = VcdWriter::new(out, &settings.motor_names)?;
        for event in events {
            vcd.event(event.at / NS_PER_TICK, event.steps, event.forward);
        }
        vcd.finish()?;
    }
    Ok(())
}
