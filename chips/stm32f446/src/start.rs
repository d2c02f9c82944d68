//! Start-up: safe levels first, then clocks, then the core.

use core::fmt::Write as _;

use corehbot::app::StepPorts;
use corehbot::fault::{Cause, Fault, Record};
use corehbot::kinematics::Groups;
use corehbot::machine::Ports;
use corehbot::port::{FANS, Lines, Serial as _};
use corehbot::units::TICKS_PER_SECOND;
use cortex_m::Peripherals;
use defmt_rtt as _;
use static_cell::StaticCell;

use crate::accelerometer::SpiSensor;
use crate::assembly::{Handles, assemble};
use crate::board_facts::ThisBoard;
use crate::board_heat::BoardHeat;
use crate::board_storage::BoardStorage;
use crate::contexts;
use crate::drivers::Drivers;
use crate::fans::Fans;
use crate::host_serial::HostSerial;
use crate::machine_at_start::{Start, machine_at_start};
use crate::motor_power::EnableLines;
use crate::reset_reason::{self, ResetReason};
use crate::servo::ServoLine;
use crate::step_pins::{Dirs, StepPins};
use crate::step_timer::{BoardClock, StepTimer};
use crate::usart::UsartLine;
use crate::usb::{self, UsbLine, UsbPort};
use crate::wiring::{Board, Image, Input, Mark, OF_144_PINS, SerialPort};
use crate::{
    after_bootloader, clock_check, clocks, fault, plain_serial, ports, priorities, ram_walk, safe_levels, servo,
    stack_guard, supply, time, watchdog,
};
use corehbot_board_support::memory::Memory;

/// Ticks of the core's time in a microsecond.
const MICRO: u64 = TICKS_PER_SECOND as u64 / 1_000_000;

defmt::timestamp!("{=u64:us}", time::now().0 / MICRO);

static DIRS: StaticCell<[Dirs; 2]> = StaticCell::new();

/// The message to hosts at a start after a heater switch that stuck.
const SUPPLY_OFF: &str = "echo:the power supply stays off, for a heater could not be switched off: mend it, then cut all power \
    (USB too) or send M999 once more\n";

/// Cycles of a bootloader's 180 MHz until an input with a resistor of 40 kOhm (STM32F446 datasheet, weak pull-up) and
/// some 100 pF has settled, with a margin of ten.
const SETTLE: u32 = 10_000;

/// A function that finds the memory of a board, when its clocks run. A board's `main` passes it, so the linker leaves
/// the other driver out.
type Find = fn(&'static Board) -> &'static mut dyn Memory;

/// Runs the firmware on the board that the image is on, with the memory for settings that `find` finds there.
pub fn run(image: &'static Image, find: Find) -> ! {
    let (handles, usb, counts_asleep) = make_ready(image, find);
    contexts::start(handles, usb, !counts_asleep)
}

/// Everything before the contexts begin. A function of its own, so that its 3 KiB of the stack are free afterwards.
#[inline(never)]
fn make_ready(image: &'static Image, find: Find) -> (Handles, Option<UsbPort>, bool) {
    let Some(mut peripherals) = Peripherals::take() else { fault::give_up(Cause::Panic, "start-up runs once") };
    stack_guard::start(&mut peripherals.MPU, &mut peripherals.SCB);
    // Without a board no pin is driven.
    let Some(board) = image.board() else { fault::give_up(Cause::Panic, "the image does not know its board") };
    ports::switch_on();
    ports::release_debug_port();
    // Before any output is driven: a level that is safe here may switch a heater on elsewhere.
    let found = look_at(board);
    if found == Found::Right {
        safe_levels::adopt(board);
    }
    watchdog::start();
    let past = reset_reason::take();
    peripherals.DCB.enable_trace();
    peripherals.DWT.enable_cycle_counter();
    after_bootloader::leave_plls();
    after_bootloader::reset_peripherals();
    priorities::reset(&mut peripherals);
    supply::wait();
    if let Err(cause) = clocks::start(board.crystal) {
        plain_serial::tell(ports_of(board, found), &["Error:", cause, ", this board cannot print\n"]);
    }
    time::start();
    clock_check::start();
    supply::watch();
    if found != Found::Right {
        let (lines, usb) = open_lines(board, found, None, past.reason);
        contexts::only_talk(lines, usb, refusal(board));
    }
    if let Some(row) = ram_walk::walk_all() {
        let (lines, usb) = open_lines(board, found, None, past.reason);
        contexts::only_talk(lines, usb, damage(row));
    }
    board.inputs.iter().for_each(pull);
    if let Some(record) = past.record.filter(Record::is_series) {
        // Stored settings may cause the faults, so they are not read here, not even for the baud rate.
        let (lines, usb) = open_lines(board, found, None, past.reason);
        let mut fans = Fans::start(board.fans, [0; FANS]);
        (0..fans.len()).for_each(|fan| fans.set_fan(fan, u16::MAX));
        contexts::only_talk(lines, usb, series(record.fault));
    }
    let mut storage = BoardStorage(find(board));
    let Start { settings, plugged, refusal } = machine_at_start(image, board, &mut storage);
    let (mut lines, usb) = open_lines(board, found, Some(settings.baud), past.reason);
    if past.is_supply_off {
        tell(&mut lines, SUPPLY_OFF);
    }
    // Of two connectors on one pin, the one in use decides.
    plugged.each_input(pull);
    safe_levels::take_debug_pins(plugged);
    let (timer, counts_asleep) = StepTimer::start(peripherals.SYST);
    let coupling = Groups::new(&settings.mechanism).coupling();
    let [dirs, spare] = DIRS.init_with(|| [(); 2].map(|()| Dirs::new(plugged, &coupling)));
    let ports = Ports {
        serial: lines,
        motors: EnableLines::new(plugged, spare),
        drivers: Drivers::start(plugged),
        servo: ServoLine { is_there: plugged.servo.is_some() },
        board: ThisBoard { connectors: board.connectors, texts: image.texts(), refusal },
        clock: BoardClock,
        storage,
        accelerometer: SpiSensor::new(board.accelerometer),
    };
    let heat = BoardHeat::start(plugged, !past.is_supply_off);
    // After the heaters, which take their timers.
    if let Some(servo) = plugged.servo {
        servo::start(servo);
    }
    let step_ports = StepPorts { pins: StepPins::new(plugged, dirs, &coupling), clock: timer };
    (assemble(settings, step_ports, heat, ports), usb, counts_asleep)
}

/// Makes an input, pulled to the level that an open contact has in its circuit.
#[inline(never)]
fn pull(input: &Input) {
    ports::make_input(input.pin, input.circuit.is_high_when_open());
}

/// The board that we are on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Found {
    /// The one that we are for.
    Right,
    /// One with a processor of that size, and other resistors.
    Similar,
    /// One with another processor: any of its pins may lead anywhere.
    Foreign,
}

/// Looks for the resistors that we know the board by. No pin is driven, and all stay inputs.
fn look_at(board: &Board) -> Found {
    if is_high(&OF_144_PINS) != board.has_144_pins {
        return Found::Foreign;
    }
    if board.marks.iter().all(|mark| is_high(mark) == mark.is_high) { Found::Right } else { Found::Similar }
}

/// Whether a pin of the mark is high against its internal resistor.
fn is_high(mark: &Mark) -> bool {
    mark.pins.iter().fold(false, |is_high, pin| {
        ports::make_input(*pin, mark.is_pulled_up);
        cortex_m::asm::delay(SETTLE);
        let is_this = ports::is_high(*pin);
        ports::float(*pin);
        is_high | is_this
    })
}

/// The serial ports that may be opened. On a foreign board these are the ports that the processor's own bootloader
/// tries on any board.
fn ports_of(board: &'static Board, found: Found) -> impl Iterator<Item = &'static SerialPort> + Clone {
    board.serial.iter().filter(move |port| found != Found::Foreign || port.is_of_bootloader())
}

/// Starts all lines, and reports the last reset. Headers have the rate of the machine, if that is known.
fn open_lines(
    board: &'static Board,
    found: Found,
    baud: Option<u32>,
    reason: Option<ResetReason>,
) -> (Lines<HostSerial>, Option<UsbPort>) {
    let ports = ports_of(board, found).map(|port| SerialPort { baud: baud.unwrap_or(port.baud), ..*port });
    let mut lines: Lines<_> = ports.map(|port| HostSerial::Usart(UsartLine::start(&port))).collect();
    report(&mut lines, reason.as_ref());
    let usb = open_usb(board, reason).map(|(line, port)| {
        // A board's table has no more lines than there is room for.
        let _ = lines.push(HostSerial::Usb(line));
        port
    });
    (lines, usb)
}

/// Starts USB, if the board has it.
fn open_usb(board: &'static Board, reason: Option<ResetReason>) -> Option<(UsbLine, UsbPort)> {
    if !board.has_usb || !clocks::start_usb(board.crystal) {
        return None;
    }
    usb::start(board, reason)
}

/// The message of a board that is not the one we are for. No output is driven, and nothing can change that.
fn refusal(board: &Board) -> contexts::Message {
    message(format_args!("Error:this board is not a {}, flash the firmware that is meant for it\n", board.name))
}

/// The message of a board with damaged memory.
fn damage(row: u32) -> contexts::Message {
    message(format_args!(
        "Error:memory at {row:08x} does not keep its bits, heaters and motors stay off: replace the board\n"
    ))
}

/// The message of a board with too many faults.
fn series(fault: Fault) -> contexts::Message {
    message(format_args!(
        "Error:three faults within a minute ({fault}), heaters and motors stay off: send M999 or switch off\n"
    ))
}

/// A text as far as it fits.
fn message(text: core::fmt::Arguments<'_>) -> contexts::Message {
    let mut message = contexts::Message::new();
    let _ = message.write_fmt(text);
    message
}

/// Reports to the hosts why the last reset happened, unless the reset was intended, and what the board lacks.
fn report(lines: &mut [HostSerial], reason: Option<&ResetReason>) {
    if let Some(reason) = reason {
        defmt::error!("the last reset came after {=str}", reason.as_str());
        reason.parts().iter().for_each(|part| tell(lines, part));
    }
    supply::warning_parts().for_each(|part| tell(lines, part));
}

/// Says a text to all hosts.
#[inline(never)]
fn tell(lines: &mut [HostSerial], text: &str) {
    lines.iter_mut().for_each(|line| _ = line.send(text.as_bytes()));
}
