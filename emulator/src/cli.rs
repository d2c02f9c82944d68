//! Command line of `corehbot-emulator`.
//!
//! 0: the image printed the file with the host's steps. 1: it did not. 2: nothing was run.

use crate::compare::{self, Lateness, Timing};
use crate::driver_line::DriverLines;
use crate::eeprom::At24c32;
use crate::firmware::Firmware;
use crate::line::Manner;
use crate::run::{Request, Seen, run};
use crate::steps::StepEvent;
use crate::timer::NS_PER_TICK;
use crate::watch::{End, Patience};
use crate::wiring::OCTOPUS;
use anyhow::{Context, Result};
use clap::Parser;
use corehbot::settings::Settings;
use corehbot_sim::trace::TraceWriter;
use corehbot_sim::vcd::VcdWriter;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A virtual second in ns.
const SECOND: u64 = 1_000_000_000;

/// Runs a flashable Octopus image on an emulated board and compares its steps with the host simulator's.
#[derive(Parser)]
#[command(name = "corehbot-emulator", version)]
struct Cli {
    /// The release ELF file, as `cargo xtask build octopus` made it.
    elf: PathBuf,
    /// G-code file to print.
    file: PathBuf,
    /// Writes the step events as they are on the pins: ticks are real time in 0.1 us since reset.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Writes the step events as VCD, for GTKWave and PulseView.
    #[arg(long, value_name = "V.vcd")]
    vcd: Option<PathBuf>,
    /// The rate at which the image talks; the run fails if it is another.
    #[arg(long, value_name = "N", default_value_t = 250_000)]
    baud: u32,
    /// Prints the conversation.
    #[arg(long)]
    talk: bool,
    /// Virtual time after which the run is given up, in s.
    #[arg(long, value_name = "S", default_value_t = 3600)]
    limit: u64,
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    match prepare(&cli).map(|(firmware, gcode)| execute(&cli, &firmware, &gcode)) {
        Ok(Ok(true)) => ExitCode::SUCCESS,
        Ok(Ok(false)) => ExitCode::from(1),
        Ok(Err(error)) => complain(&error, 1),
        Err(error) => complain(&error, 2),
    }
}

fn complain(error: &anyhow::Error, status: u8) -> ExitCode {
    eprintln!("corehbot-emulator: {error:#}");
    ExitCode::from(status)
}

fn prepare(cli: &Cli) -> Result<(Firmware, String)> {
    let firmware = Firmware::read(&cli.elf)?;
    let bytes = std::fs::read(&cli.file).with_context(|| format!("cannot open {}", cli.file.display()))?;
    Ok((firmware, String::from_utf8_lossy(&bytes).into_owned()))
}

fn execute(cli: &Cli, firmware: &Firmware, gcode: &str) -> Result<bool> {
    println!("image     {}", firmware.path.display());
    println!("sha256    {}", firmware.sha256);
    let settings = Settings::prototype();
    let patience = Patience { whole: cli.limit * SECOND, silent: 30 * SECOND, after_reset: SECOND };
    let (drivers, eeprom) = (DriverLines::new(&OCTOPUS), At24c32::default());
    let request = Request {
        firmware,
        wiring: &OCTOPUS,
        settings: &settings,
        gcode,
        second: None,
        manner: Manner::default(),
        patience,
        injection: None,
        drivers: &drivers,
        eeprom: &eeprom,
        thermistors: &[],
        stuck: None,
    };
    let seen = run(&request)?;
    write_files(cli, &settings, &seen.recorder.events)?;
    print_run(cli, &seen);
    let host = compare::scheduled(gcode, &settings)?;
    let pins = &seen.recorder.events;
    let mut ok = seen.end == End::Done && seen.line.failure.is_none() && seen.resets.is_empty();
    ok &= seen.safety.dangers.is_empty() && seen.gaps.found.is_empty();
    ok &= seen.recorder.unpowered == 0 && seen.recorder.split_pairs == 0;
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
    if let Err(error) = seen.check_baud(cli.baud) {
        println!("baud      {error}");
        ok = false;
    }
    Ok(ok)
}

fn print_run(cli: &Cli, seen: &Seen) {
    if cli.talk {
        for line in &seen.line.said {
            println!("said      {line}");
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
        println!("odd       {warning}");
    }
    if let Some(failure) = &seen.line.failure {
        println!("FAILED    {failure}");
    }
    for reset in &seen.resets {
        println!("RESET     {:.3} ms, {:?}", ms(reset.at.0), reset.cause);
    }
    for (at, danger) in &seen.safety.dangers {
        println!("DANGER    {:.3} ms, {danger:?}", ms(*at));
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
    println!(
        "schedule  {} alarms are the host's tick, {} are not, {} events without an alarm",
        timing.exact_alarms, timing.other_alarms, timing.no_alarm
    );
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

fn write_files(cli: &Cli, settings: &Settings, events: &[StepEvent]) -> Result<()> {
    let create = |path: &Path| {
        File::create(path).map(BufWriter::new).with_context(|| format!("cannot write {}", path.display()))
    };
    if let Some(path) = &cli.trace {
        let mut trace = TraceWriter::new(Some(create(path)?), settings.into());
        for event in events {
            trace.event(event.at / NS_PER_TICK, event.steps, event.forward);
        }
        trace.finish()?;
    }
    if let Some(path) = &cli.vcd {
        let mut vcd = VcdWriter::new(create(path)?)?;
        for event in events {
            vcd.event(event.at / NS_PER_TICK, event.steps, event.forward);
        }
        vcd.finish()?;
    }
    Ok(())
}
