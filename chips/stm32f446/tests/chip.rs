//! Compares the boards' tables and the crate's own with stm32-metapac's data of the chip: pins, alternate functions,
//! channels of the converter, DMA streams, timers and interrupts.
//!
//! stm32-metapac describes one chip in a build, so the Octopus's chip stands for all: they are one die in three
//! packages.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use corehbot_boards::{entries, octopus};
use corehbot_stm32f446::resources::{self, Channel, SOURCES, TIMERS};
use corehbot_stm32f446::wiring::{Board, FanPin, HeaterPin, Pin, SensorPins, USB, Usart};
use stm32_metapac::metadata::{METADATA, Peripheral};

/// Pins of the package with 100 pins by port, a bit for each (STM32F446 datasheet, pin definitions, LQFP100;
/// stm32-metapac 21.0.0 has the same for stm32f446ve).
const LQFP100: [(char, u16); 5] = [('A', 0xFFFF), ('B', 0xF7FF), ('C', 0xFFFF), ('D', 0xFFFF), ('E', 0xFFFF)];

/// Pins of the package with 64 pins by port, a bit for each (STM32F446 datasheet, pin definitions, LQFP64;
/// stm32-metapac 21.0.0 has the same for stm32f446re).
const LQFP64: [(char, u16); 4] = [('A', 0xFFFF), ('B', 0xF7FF), ('C', 0xFFFF), ('D', 1 << 2)];

fn name(pin: Pin) -> String {
    format!("P{:?}{}", pin.port, pin.number())
}

fn peripheral(name: &str) -> &'static Peripheral {
    METADATA.peripherals.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("the chip has no {name}"))
}

/// The problem of a pin for a peripheral's signal, if any.
fn misplaced(pin: Pin, owner: &str, signal: &str, function: Option<u8>) -> Option<String> {
    let name = name(pin);
    let found = peripheral(owner).pins.iter().find(|p| p.pin == name && p.signal == signal);
    match found {
        None => Some(format!("{name} is not {owner}'s {signal}")),
        Some(p) if p.af != function => Some(format!("{name} is {owner}'s {signal} by {:?}, not {function:?}", p.af)),
        Some(_) => None,
    }
}

/// The problem of a stream for a peripheral's signal, if any.
fn misdirected(channel: Channel, owner: &str, signal: &str) -> Option<String> {
    let stream = format!("DMA{}_CH{}", channel.controller, channel.stream);
    let is_there = peripheral(owner)
        .dma_channels
        .iter()
        .any(|c| c.signal == signal && c.channel == Some(&*stream) && c.request == Some(u32::from(channel.request)));
    (!is_there).then(|| format!("{stream} does not carry {owner}'s {signal} by request {}", channel.request))
}

/// Every DMA stream in use.
fn streams() -> Vec<Channel> {
    Usart::all()
        .map(resources::receiver)
        .chain([resources::CONVERTER, resources::SENSOR_INPUT, resources::SENSOR_OUTPUT])
        .collect()
}

/// The pins of an accelerometer, with their signals.
fn sensor_pins(pins: &SensorPins) -> [(Pin, &'static str); 4] {
    let SensorPins { clock, miso, mosi, select } = *pins;
    [(clock, "SCK"), (miso, "MISO"), (mosi, "MOSI"), (select, "NSS")]
}

/// Every pin in the table, with its purpose.
fn pins(board: &Board) -> Vec<(Pin, String)> {
    // Lists all fields by name, so that a new field must be classified here: does it have pins? The pins of heaters and
    // fans are among the loads.
    let Board {
        name: _,
        connectors: _,
        crystal: _,
        sockets,
        inputs,
        thermistors,
        loads,
        heaters,
        fans,
        supply_pins,
        servo,
        accelerometer,
        serial,
        has_usb,
        eeprom,
        has_144_pins: _,
        marks: _,
    } = *board;
    // A second pin of a heater or fan would need a check too; so this lists all their fields.
    heaters.iter().for_each(|HeaterPin { output: _, pin: _, timer: _, channel: _ }| {});
    fans.iter().for_each(|FanPin { pin: _, timer: _, channel: _ }| {});
    let mut pins = Vec::new();
    for (n, slot) in sockets.iter().enumerate() {
        pins.extend([(slot.step, "step"), (slot.dir, "dir")].map(|(pin, what)| (pin, format!("{what} {n}"))));
        pins.extend(slot.uart.map(|pin| (pin, format!("uart {n}"))));
    }
    // One line may enable several drivers.
    for slot in sockets {
        if !pins.iter().any(|(pin, what)| *pin == slot.enable && what == "enable") {
            pins.push((slot.enable, "enable".into()));
        }
    }
    for (at, input) in inputs.iter().enumerate() {
        // Two connectors may lead to one pin.
        if inputs.iter().take(at).all(|earlier| earlier.pin != input.pin) {
            pins.push((input.pin, "input".into()));
        }
    }
    pins.extend(thermistors.iter().map(|t| (t.pin, format!("{:?}", t.sensor))));
    pins.extend(loads.iter().map(|pin| (*pin, "load".into())));
    pins.extend(supply_pins.iter().map(|pin| (*pin, "supply switch".into())));
    pins.extend(servo.map(|pin| (pin, "servo".into())));
    pins.extend(accelerometer.iter().flat_map(sensor_pins).map(|(pin, signal)| (pin, signal.into())));
    pins.extend(serial.iter().flat_map(|port| [(port.tx, "tx".into()), (port.rx, "rx".into())]));
    pins.extend(eeprom.into_iter().flatten().map(|pin| (pin, "eeprom".into())));
    pins.extend(USB.into_iter().filter(|_| has_usb).map(|pin| (pin, "usb".into())));
    pins
}

/// Everything that is wrong with a board's table.
fn problems(board: &Board, has_pin: impl Fn(Pin) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    let pins = pins(board);
    for (n, (pin, what)) in pins.iter().enumerate() {
        if !has_pin(*pin) {
            found.push(format!("the package has no {} ({what})", name(*pin)));
        }
        if let Some((_, other)) = pins[..n].iter().find(|(other, _)| other == pin) {
            found.push(format!("{} is {what} and {other}", name(*pin)));
        }
    }
    for port in board.serial {
        let function = Some(resources::USART_FUNCTION);
        found.extend(misplaced(port.tx, port.usart.name(), "TX", function));
        found.extend(misplaced(port.rx, port.usart.name(), "RX", function));
    }
    for thermistor in board.thermistors {
        found.extend(misplaced(thermistor.pin, "ADC3", &format!("IN{}", thermistor.channel), None));
    }
    for heater in board.heaters {
        let (timer, function) = resources::heater_timer(heater.timer);
        found.extend(misplaced(heater.pin, timer, &format!("CH{}", heater.channel), Some(function)));
    }
    for fan in board.fans {
        if let Some((timer, function, letter)) = resources::fan_timer(fan.timer) {
            found.extend(misplaced(fan.pin, timer, &format!("CH{}{letter}", fan.channel), Some(function)));
        }
    }
    for (pin, signal) in board.accelerometer.iter().flat_map(sensor_pins).filter(|(_, signal)| *signal != "NSS") {
        found.extend(misplaced(pin, resources::SENSOR_BUS, signal, Some(resources::SPI_FUNCTION)));
    }
    if let Some([clock, data]) = board.eeprom {
        let function = Some(resources::I2C_FUNCTION);
        found.extend(misplaced(clock, "I2C1", "SCL", function));
        found.extend(misplaced(data, "I2C1", "SDA", function));
    }
    if board.has_usb {
        let [minus, plus] = USB;
        found.extend(misplaced(minus, "USB_OTG_FS", "DM", Some(resources::USB_FUNCTION)));
        found.extend(misplaced(plus, "USB_OTG_FS", "DP", Some(resources::USB_FUNCTION)));
    }
    found
}

fn has_lqfp144(pin: Pin) -> bool {
    METADATA.pins.iter().any(|p| p.name == name(pin))
}

fn has_lqfp100(pin: Pin) -> bool {
    is_in(&LQFP100, pin)
}

fn has_lqfp64(pin: Pin) -> bool {
    is_in(&LQFP64, pin)
}

fn is_in(package: &[(char, u16)], pin: Pin) -> bool {
    package.iter().any(|(port, bits)| format!("{:?}", pin.port) == port.to_string() && bits >> pin.number() & 1 != 0)
}

/// Whether a processor has a pin. The letter of its package follows 446 in its name (STM32F446 datasheet, ordering
/// information).
fn package(chip: &str) -> fn(Pin) -> bool {
    match chip.strip_prefix("STM32F446").and_then(|rest| rest.chars().next()) {
        Some('Z') => has_lqfp144,
        Some('V') => has_lqfp100,
        Some('R') => has_lqfp64,
        _ => panic!("{chip} is no processor of ours"),
    }
}

#[test]
fn every_board_uses_pins_as_its_chip_has_them() {
    for entry in entries() {
        assert_eq!(problems(entry.board, package(entry.chip)), Vec::<String>::new(), "{}", entry.board.name);
    }
    assert!(problems(&octopus::BOARD, has_lqfp100).len() > 10, "ports F and G are not in that package");
}

#[test]
fn the_smaller_packages_have_pins_of_the_largest() {
    assert!(LQFP64.iter().chain(&LQFP100).all(|(port, bits)| {
        let all = (0..16).filter(|n| bits >> n & 1 != 0);
        all.into_iter().all(|n| METADATA.pins.iter().any(|p| p.name == format!("P{port}{n}")))
    }));
}

#[test]
fn a_table_that_errs_is_found_out() {
    use corehbot_stm32f446::wiring::{FanPin, FanTimer, HeaterPin, Port, SerialPort, ThermistorPin};
    let good = octopus::BOARD;
    let wrong = |board: Board| problems(&board, has_lqfp144).len();
    let swapped = [SerialPort { tx: good.serial[0].rx, rx: good.serial[0].tx, ..good.serial[0] }];
    let elsewhere = [SerialPort { usart: Usart::One, ..good.serial[0] }];
    let channel = [ThermistorPin { channel: 4, ..good.thermistors[0] }];
    let eeprom = good.eeprom.map(|[clock, data]| [data, clock]);
    let accelerometer = good.accelerometer.map(|pins| SensorPins { clock: pins.miso, miso: pins.clock, ..pins });
    let heater = [HeaterPin { channel: 3, ..good.heaters[0] }];
    let fan = [FanPin { timer: FanTimer::Four, ..good.fans[0] }];
    let mut sockets = good.sockets.to_vec();
    sockets[0].dir = Pin::new(Port::G, 6);
    assert_eq!(wrong(Board { serial: Box::leak(Box::new(swapped)), ..good }), 2);
    assert_eq!(wrong(Board { serial: Box::leak(Box::new(elsewhere)), ..good }), 2);
    assert_eq!(wrong(Board { thermistors: Box::leak(Box::new(channel)), ..good }), 1);
    assert_eq!(wrong(Board { heaters: Box::leak(Box::new(heater)), ..good }), 1);
    assert_eq!(wrong(Board { fans: Box::leak(Box::new(fan)), ..good }), 1);
    assert_eq!(wrong(Board { eeprom, ..good }), 2);
    assert_eq!(wrong(Board { accelerometer, ..good }), 2);
    assert_eq!(wrong(Board { sockets: sockets.leak(), ..good }), 1, "a direction line on the X switch");
    assert!(problems(&good, has_lqfp64).len() > 20, "most pins of the Octopus are not in the small package");
}

#[test]
fn streams_carry_what_they_are_meant_to() {
    for usart in Usart::all() {
        assert_eq!(misdirected(resources::receiver(usart), usart.name(), "RX"), None);
    }
    assert_eq!(misdirected(resources::CONVERTER, "ADC3", "ADC3"), None);
    assert_eq!(misdirected(resources::SENSOR_INPUT, resources::SENSOR_BUS, "RX"), None);
    assert_eq!(misdirected(resources::SENSOR_OUTPUT, resources::SENSOR_BUS, "TX"), None);
    let distinct: BTreeSet<_> = streams().iter().map(|c| (c.controller, c.stream)).collect();
    assert_eq!(distinct.len(), streams().len(), "a stream serves two");
    let wrong = Channel { request: 3, ..resources::CONVERTER };
    assert!(misdirected(wrong, "ADC3", "ADC3").is_some());
}

#[test]
fn timers_and_lines_are_on_the_buses_that_their_rates_are_computed_for() {
    let bus = |name| peripheral(name).rcc.as_ref().expect("a clock").bus_clock;
    for (timer, apb) in TIMERS {
        assert_eq!(bus(timer), format!("PCLK{apb}"), "{timer}");
    }
    for usart in Usart::all() {
        let hz = if bus(usart.name()) == "PCLK2" { 90_000_000 } else { 45_000_000 };
        assert_eq!(usart.bus_hz(), hz, "{usart:?}");
    }
    assert_eq!((bus("I2C1"), bus("ADC3"), bus(resources::SENSOR_BUS)), ("PCLK1", "PCLK2", "PCLK1"));
}

#[test]
fn interrupts_have_the_numbers_of_their_sources() {
    let number = |name: &str| METADATA.interrupts.iter().find(|i| i.name == name).map(|i| i.number);
    for source in SOURCES {
        let interrupt = match source.peripheral {
            "PVD" => "PVD",
            owner => {
                let found = peripheral(owner).interrupts.iter().find(|i| i.signal == source.signal);
                found.unwrap_or_else(|| panic!("{owner} has no {}", source.signal)).interrupt
            }
        };
        assert_eq!(number(interrupt), Some(u32::from(source.number)), "{source:?}");
    }
    let is_in_use = |owner: &str, signal: &str| SOURCES.iter().any(|s| s.peripheral == owner && s.signal == signal);
    for usart in Usart::all() {
        let Channel { controller, stream, .. } = resources::receiver(usart);
        assert!(is_in_use(usart.name(), "GLOBAL"), "{usart:?} has no interrupt");
        assert!(
            is_in_use(&format!("DMA{controller}"), &format!("CH{stream}")),
            "the receiver of {usart:?} has no interrupt"
        );
    }
}

/// Boards that are not there (docs/reference/boards.md): a heater needs a timer that ends its pulses, and TIM2 keeps
/// the time.
#[test]
fn no_timer_is_left_for_the_heaters_of_a_leviathan_nor_for_e0_of_an_s6() {
    let timers = |pin: &str| -> Vec<_> {
        let timers = METADATA.peripherals.iter().filter(|timer| timer.name.starts_with("TIM"));
        timers.filter(|timer| timer.pins.iter().any(|p| p.pin == pin)).map(|timer| timer.name).collect()
    };
    assert_eq!((timers("PG10"), timers("PG11")), (vec![], vec![]));
    assert_eq!(timers("PB3"), [resources::TIME]);
    assert!(timers("PB15").contains(&"TIM12"), "the list knows timers");
}

/// An interrupt without a handler ends in the default handler, which halts the board. embassy handles the interrupt of
/// its own time.
#[test]
fn every_interrupt_has_a_handler() {
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/src")).unwrap();
    let files =
        folder.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|kind| kind == "rs"));
    let code: String = files.map(|path| std::fs::read_to_string(path).unwrap()).collect();
    for source in SOURCES.iter().filter(|source| source.peripheral != resources::TIME) {
        let interrupt = METADATA.interrupts.iter().find(|interrupt| interrupt.number == u32::from(source.number));
        let name = interrupt.expect("the chip has it").name;
        let handler = format!("#[interrupt]\nfn {name}() {{");
        let (_, body) = code.split_once(&handler).unwrap_or_else(|| panic!("{source:?}: {handler}"));
        let body = body.split_once("\n}").expect("its end").0;
        // Interrupts above the generator count their calls, except for the supply's, which never returns.
        let counts = body.contains(&format!("count_call(Interrupt::{name}, &RATE);"))
            || body.contains("count_call(IRQ, &RATE);");
        let is_below = ["PVD", "CAN2_SCE", "TIM5"].contains(&name);
        assert_eq!(counts, !is_below, "{name}: {body}");
        // ARM erratum 838869.
        assert_eq!(body.ends_with("finish_stores();"), name != "PVD", "{name}: {body}");
    }
}
