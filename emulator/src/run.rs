//! One run: an image, a file to print, and everything that was seen.

use crate::board::{Emulated, FACTORY, FACTORY_WORDS};
use crate::clock_rules::Breach;
use crate::clock_tree::Defect;
use crate::driver_line::DriverLines;
use crate::eeprom::At24c32;
use crate::firmware::Firmware;
use crate::flash::{FlashSectors, SECTORS};
use crate::half_periods::Laps;
use crate::heat_pins::{Climate, HeatWatch};
use crate::line::{HostLine, Manner};
use crate::mechanics::Mechanics;
use crate::safety::Safety;
use crate::sensor::Sensor;
use crate::servo_line::ServoLine;
use crate::steps::Recorder;
use crate::terminal::Terminal;
use crate::unmodelled_accesses::Gaps;
use crate::watch::{End, Flip, Injection, Patience, Watch};
use crate::wiring::{BRR, HostPort, PORTS, Pin, SettingsMemory, Wiring};
use anyhow::{Context, Result, bail};
use corehbot::settings::Settings;
use corehbot_sim::belt::BeltSetup;
use corehbot_sim::belt::figures::BeltFigures;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::wiring_mistakes::Plugs;
use rigless::emulator::{self, Start};
use rigless::image::Image;
use rigless::mcu::Operate;
use rigless::session::{Reset, Session};
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::path::Path;
use std::time::{Duration, Instant};

/// A baud rate counts as another rate if it is off by more than 2 %, half of a UART's tolerance.
const BAUD_TOLERANCE: f64 = 0.02;

/// RCC_AHB1ENR, APB1ENR and APB2ENR (RM0390 rev 6, section 6.3.28).
const CLOCKED: [u64; 3] = [0x4002_3830, 0x4002_3840, 0x4002_3844];

/// The image and its surroundings.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The image.
    pub firmware: &'a Firmware,
    /// The board that it is for.
    pub wiring: &'static Wiring,
    /// The machine: as the image's defaults have it, or as it is stored in the EEPROM.
    pub settings: &'a Settings,
    /// The file to print.
    pub gcode: &'a str,
    /// The file that the host on the second serial port prints at the same time, if there is one.
    pub second: Option<&'a str>,
    /// How they talk.
    pub manner: Manner,
    /// The address at which a real computer finds the board's USB port, in place of all hosts here.
    pub network: Option<&'a str>,
    /// How long it may take.
    pub patience: Patience,
    /// A fault to inject.
    pub injection: Option<Injection>,
    /// The motor drivers.
    pub drivers: &'a DriverLines,
    /// The EEPROM, if the board has one.
    pub eeprom: &'a At24c32,
    /// The sectors for settings, if the board keeps them in flash.
    pub flash: &'a FlashSectors,
    /// Channels of ADC3 that have another voltage than at room temperature, in mV.
    pub thermistors: &'a [(u8, u32)],
    /// The machine's thermal surroundings, if it has heat.
    pub climate: Climate,
    /// The heaters' true values, and their accidents.
    pub heat: &'a HeatSetup,
    /// The belt that the motors turn; without one the machine is rigid.
    pub belt: Option<&'a BeltSetup>,
    /// Mistakes of the wiring between the board and a rigid machine.
    pub plugs: Option<&'a Plugs>,
    /// The rate of the slow oscillator in Hz, if it differs from the data sheet.
    pub slow_oscillator: Option<u64>,
    /// The accelerometer in the board's connector for one.
    pub sensor: Option<&'a Sensor>,
    /// A pin that something holds high or low all the time.
    pub stuck: Option<(Pin, bool)>,
    /// The defect of the clocks.
    pub defect: Defect,
}

/// Everything that was seen.
#[derive(Debug)]
pub struct Seen {
    /// Why it ended.
    pub end: End,
    /// Step events.
    pub recorder: Recorder,
    /// Accesses of the step interrupt to peripherals on APB.
    pub slow_accesses: u64,
    /// Pins that the image has driven, itself or by a peripheral, in each port.
    pub driven: [u16; PORTS],
    /// Enable lines and heaters.
    pub safety: Safety,
    /// The firmware's clock.
    pub laps: Laps,
    /// The machine's heat.
    pub heat: HeatWatch,
    /// The motor drivers.
    pub drivers: DriverLines,
    /// The servo's line.
    pub servo: ServoLine,
    /// The accelerometer as it was left.
    pub sensor: Option<Sensor>,
    /// What the firmware did to it, or to its bus, against the manuals.
    pub sensor_breaches: Vec<&'static str>,
    /// The belt's figures.
    pub belt: Option<BeltFigures>,
    /// Requests that the model could not serve.
    pub gaps: Gaps,
    /// Rules for clocks that were broken.
    pub breaches: Vec<Breach>,
    /// What the firmware did to the USB core against the manual.
    pub usb_breaches: Vec<corehbot_usb_model::Breach>,
    /// Resets of the chip.
    pub resets: Vec<Reset>,
    /// After a supply that fell, the firmware waited for it before it set its clocks.
    pub has_waited: bool,
    /// When the injected fault happened, in ns.
    pub injected: Option<u64>,
    /// When a context fell into the trap that the fault sprang, in ns.
    pub fallen: Option<u64>,
    /// Bits of registers that flipped.
    pub flips: Vec<Flip>,
    /// When the firmware greeted its host, in ns.
    pub started: Option<u64>,
    /// The conversation.
    pub line: LineSeen,
    /// That on the second serial port.
    pub second: Option<LineSeen>,
    /// The EEPROM as it was left.
    pub eeprom: At24c32,
    /// The sectors for settings as they were left.
    pub flash: FlashSectors,
    /// Pins of the debug port that are its own at the end: SWDIO and SWCLK (PA13, PA14), from the lowest bit.
    pub debug_pins: u16,
    /// Bytes of the stack that were never used, its guard among them.
    pub stack_free: u32,
    /// Core clock in Hz at the end.
    pub core_hz: u64,
    /// RCC_AHB1ENR, APB1ENR and APB2ENR at the end.
    pub clocked: [u64; 3],
    /// Virtual time in ns.
    pub virtual_ns: u64,
    /// Instructions.
    pub instructions: u64,
    /// Real time.
    pub wall: Duration,
}

/// The traffic on the serial line.
#[derive(Clone, Default, Debug)]
pub struct LineSeen {
    /// The first lines that the board said.
    pub said: Vec<String>,
    /// Bytes to the board and from it.
    pub bytes: [u64; 2],
    /// Why the print failed, if it did.
    pub failure: Option<String>,
    /// Warnings of the simulated printer.
    pub warnings: Vec<String>,
    /// Commands sent again.
    pub resends: u32,
    /// The rate that the firmware set, in baud.
    pub baud: f64,
}

/// Runs an image.
///
/// # Errors
/// If the image does not fit the board, or the emulator fails.
pub fn run(request: &Request<'_>) -> Result<Seen> {
    serve(request, None)
}

/// Runs an image. With a terminal, the host there has the first serial line, in place of all hosts here, until the
/// terminal is over.
///
/// # Errors
/// If the image does not fit the board, or the emulator or the terminal fails.
pub fn serve(request: &Request<'_>, terminal: Option<Terminal>) -> Result<Seen> {
    let begin = Instant::now();
    let is_outside = request.network.is_some() || terminal.is_some();
    let texts = [Some(request.gcode), request.second].into_iter().flatten().filter(|_| !is_outside);
    let mut hosts: Vec<_> = texts.map(|gcode| HostLine::new(gcode, request.manner)).collect();
    hosts.extend(terminal.iter().map(|_| HostLine::open()));
    let on_usb = request.manner.usb.map(|habits| (habits, hosts.drain(..).collect()));
    let mut board = Emulated::new(request.wiring, hosts, request.eeprom.clone(), request.flash.clone())?;
    if let Some((habits, hosts)) = on_usb {
        board.plug(habits, hosts);
    }
    if let Some(address) = request.network {
        board.plug_network(address)?;
    }
    board.heat(request.thermistors)?;
    if let Some(sensor) = request.sensor {
        board.plug_sensor(sensor.clone())?;
    }
    board.weaken(request.defect);
    if let Some((pin, high)) = request.stuck {
        board.drive(VirtualNanos(0), pin, high);
    }
    if let Some(hz) = request.slow_oscillator {
        board.mcu.calibrate_slow_oscillator(hz);
    }
    let session = Session::new(Box::new(board), 0, VirtualNanos(1))?;
    let mut watch = Watch::new(
        request.wiring,
        (request.firmware.symbol("STEPPER")?, request.firmware.function("SysTick")?),
        request.settings,
        request.patience,
        request.injection,
        request.manner.baud,
        request.drivers.clone(),
    );
    if let Some(setup) = request.belt {
        watch.mechanics = Mechanics::with_belt(request.settings, setup)?;
    }
    watch.mechanics.plugs = request.plugs.cloned();
    for motor in request.plugs.iter().flat_map(|plugs| plugs.silent.iter()) {
        watch.drivers.chip(motor).is_silent = true;
    }
    watch.terminal = terminal;
    watch.stack_end = request.firmware.symbol("_stack_end")?;
    watch.heat = HeatWatch::new(request.wiring, request.settings, &request.climate, request.heat);
    let mut images = request.firmware.images(request.wiring)?;
    images.push(Image::new(Path::new("factory"), FACTORY.as_flattened().to_vec(), Some(FACTORY_WORDS))?);
    if request.wiring.settings == SettingsMemory::Flash {
        images.push(Image::new(Path::new("settings"), request.flash.cells.clone(), Some(SECTORS.start))?);
    }
    let finished = emulator::run(session, &Start::new(&images), watch).context("the emulator")?;
    let (mut session, mut watch) = (finished.session, finished.driver);
    if let Some(failure) = watch.terminal.take().and_then(|terminal| terminal.failure) {
        return Err(failure);
    }
    let stop = finished.stop.context("the emulator ended by itself")?;
    if !watch.is_injectable {
        bail!("the fault could not be injected");
    }
    let gaps = Gaps::of(&session);
    let resets = session.resets().to_vec();
    let board = session.board_mut();
    let bauds = request.wiring.host_ports.iter().map(|port| baud(board, port, stop.at)).collect::<Result<Vec<_>>>()?;
    let usb_breaches = board.mcu.usb.core.breaches().to_vec();
    let sensor = board.sensor().cloned();
    let mut sensor_breaches = watch.sensor_bus.breaches;
    sensor_breaches.extend(sensor.iter().flat_map(|sensor| &sensor.breaches));
    let [core_hz, ..] = board.mcu.rates();
    let debug_pins = board.port(0).alternate >> 13 & 3;
    let mut clocked = [0; 3];
    for (enabled, address) in clocked.iter_mut().zip(CLOCKED) {
        *enabled = board.mcu.peek(stop.at, address, Width::W32)?;
    }
    let eeprom = board.eeprom().cloned().unwrap_or_default();
    let flash = board.mcu.flash.as_ref().map(|flash| flash.sectors.clone()).unwrap_or_default();
    let mut lines = board.hosts().zip(bauds).map(|(line, baud)| LineSeen::of(line, baud));
    let line = lines.next().unwrap_or_default();
    let second = lines.next();
    drop(lines);
    let started = board.hosts().next().and_then(|host| host.started);
    Ok(Seen {
        end: watch.end,
        started,
        recorder: watch.recorder,
        slow_accesses: watch.slow_accesses,
        driven: watch.driven,
        safety: watch.safety,
        laps: watch.laps,
        heat: watch.heat,
        drivers: watch.drivers,
        servo: watch.servo,
        sensor,
        sensor_breaches,
        belt: watch.mechanics.figures(),
        gaps,
        breaches: watch.clock_rules.breaches,
        usb_breaches,
        resets,
        has_waited: watch.has_waited,
        injected: watch.injected,
        fallen: watch.fallen,
        flips: watch.flips,
        line,
        second,
        eeprom,
        flash,
        debug_pins,
        stack_free: watch.stack_free,
        core_hz,
        clocked,
        virtual_ns: stop.at.0,
        instructions: stop.instruction_count,
        wall: begin.elapsed(),
    })
}

/// The baud rate of a serial port as the firmware set it.
fn baud(board: &mut Emulated, port: &HostPort, at: VirtualNanos) -> Result<f64> {
    const CR1: u64 = 0x0C;
    const OVER8: u64 = 1 << 15;
    let brr = board.mcu.peek(at, port.base + BRR, Width::W32)?;
    let cr1 = board.mcu.peek(at, port.base + CR1, Width::W32)?;
    // RM0390 rev 6, section 25.4.4.
    let divider = if cr1 & OVER8 == 0 { brr } else { (brr >> 4 << 3) + (brr & 7) };
    Ok(board.bus_hz(port) as f64 / divider as f64)
}

impl LineSeen {
    fn of(line: &HostLine, baud: f64) -> Self {
        Self {
            said: line.said.clone(),
            bytes: line.bytes,
            failure: line.host.failure().map(ToString::to_string),
            warnings: line.host.warnings().iter().map(ToString::to_string).collect(),
            resends: line.host.resends(),
            baud,
        }
    }
}

impl Seen {
    /// Holds the firmware's baud rate to the stated one.
    ///
    /// # Errors
    /// If it is another.
    pub fn check_baud(&self, stated: u32) -> Result<()> {
        let stated = f64::from(stated);
        if (self.line.baud - stated).abs() > stated * BAUD_TOLERANCE {
            bail!("the image talks at {:.0} baud, not at {stated:.0}", self.line.baud);
        }
        Ok(())
    }
}
