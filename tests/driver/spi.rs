//! A chip of another kind, on SPI: the room needs nothing of the TMC2209.
//!
//! Its frames are a TMC5160's (datasheet rev 1.17, section 4.1): an address and 32 bits. A value comes with the next
//! frame. It counts no writes, so its scripts read everything back.

use corehbot::driver::{Check, Chip, DriverError, DriverJob, Drivers, Held, News, Reading, Scripts, Shown, Step};
use corehbot::motors::{Coupling, Motor, MotorSet, prototype};
use corehbot::port::{BusError, DriverBus, Frame, MotorPower};
use corehbot::settings::Settings;
use corehbot::units::Instant;
use std::collections::BTreeMap;

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Register {
    Gconf = 0x00,
    Gstat = 0x01,
    Ioin = 0x04,
    Chopconf = 0x6C,
    Status = 0x6F,
}

const VERSION: u32 = 0x30;
const FLAGS: Step<Register> = Step::Read(Register::Gstat, Check::Flags);
const STATUS: Step<Register> = Step::Read(Register::Status, Check::Status);
const CHOPPER: Step<Register> = Step::Read(Register::Chopconf, Check::Same);

#[derive(Debug)]
struct OnSpi;

impl Chip for OnSpi {
    type Register = Register;
    /// MRES.
    type Config = u32;

    const SCRIPTS: Scripts<Register> = Scripts {
        configure: &[
            Step::Read(Register::Ioin, Check::Chip),
            Step::Tell(Register::Gstat),
            Step::Write(Register::Gconf),
            Step::Write(Register::Chopconf),
            Step::Read(Register::Gconf, Check::Same),
            CHOPPER,
            FLAGS,
        ],
        check: &[FLAGS, CHOPPER],
        adjust: &[STATUS, FLAGS, Step::Write(Register::Chopconf), CHOPPER, FLAGS],
        poll: &[STATUS, FLAGS, CHOPPER],
        read: &[Step::Read(Register::Chopconf, Check::Any), Step::Read(Register::Status, Check::Any)],
        load: &[],
        phase: &[],
        flags: &[FLAGS],
        status: &[STATUS],
        chopper: &[CHOPPER],
    };

    fn config(motor: Motor, settings: &Settings) -> u32 {
        8 - settings.driver_of(motor).microsteps.ilog2()
    }

    fn value(config: &u32, register: Register) -> u32 {
        match register {
            Register::Chopconf => config << 24 | 3,
            Register::Gstat => 7,
            _ => 0,
        }
    }

    fn held(config: &u32) -> Held {
        Held { microsteps: 256 >> config, run_ma: 0, hold_ma: 0, quiet_steps_per_s: None }
    }

    fn read(register: Register) -> (Frame, usize) {
        (frame(register as u8, 0), 5)
    }

    fn write(register: Register, value: u32) -> (Frame, usize) {
        (frame(register as u8 | 0x80, value), 0)
    }

    fn reply(reply: &[u8], _register: Register) -> Option<u32> {
        let [_status, value @ ..] = reply else { return None };
        value.try_into().ok().map(u32::from_be_bytes)
    }

    fn other_chip(value: u32) -> Option<DriverError> {
        (value >> 24 != VERSION).then_some(DriverError::WrongChip("TMC5160", (value >> 24) as u8))
    }

    fn error_of_flags(flags: u32) -> Option<DriverError> {
        (flags & 1 != 0).then_some(DriverError::LostConfiguration)
    }

    fn error_of_status(status: u32) -> Option<DriverError> {
        (status & 1 << 25 != 0).then_some(DriverError::OverTemperature)
    }

    fn difference(_register: Register, value: u32, wanted: u32) -> Option<DriverError> {
        (value != wanted).then_some(DriverError::Microsteps)
    }

    fn note(reading: &mut Reading, register: Register, value: u32) {
        if register == Register::Chopconf {
            reading.registers.chopper = value;
        }
    }

    fn shown(reading: &Reading) -> Shown {
        Shown {
            microsteps: Some(256 >> (reading.registers.chopper >> 24 & 0xF)),
            interpolates: true,
            mode: "spreadCycle",
            is_quiet: false,
            temperature: "",
            is_hot: false,
            seems_open: false,
            problem: None,
        }
    }
}

fn frame(address: u8, value: u32) -> Frame {
    let [a, b, c, d] = value.to_be_bytes();
    Frame::from_slice(&[address, a, b, c, d]).unwrap()
}

/// One chip's end of the bus.
#[derive(Default)]
struct Registers {
    values: BTreeMap<u8, u32>,
    /// The register that the last frame named.
    named: u8,
}

impl Registers {
    /// A frame goes in, and the register that the frame before named comes out.
    fn shift(&mut self, request: &[u8]) -> Vec<u8> {
        let value = self.values.get(&self.named).copied().unwrap_or_default();
        let (address, sent) = (request[0] & 0x7F, u32::from_be_bytes(request[1..].try_into().unwrap()));
        if request[0] & 0x80 != 0 {
            let held = self.values.entry(address).or_default();
            *held = if address == Register::Gstat as u8 { *held & !sent } else { sent };
        }
        self.named = address;
        [&[0][..], &value.to_be_bytes()].concat()
    }
}

struct Bus {
    chips: BTreeMap<usize, Registers>,
    powered: MotorSet,
    reply: Option<Result<Frame, BusError>>,
}

impl Bus {
    fn new() -> Self {
        let reset = || Registers { values: [(0x04, VERSION << 24), (0x01, 1)].into(), named: 0 };
        let chips = Motor::ALL.map(|motor| (motor.index(), reset())).into();
        Self { chips, powered: MotorSet::NONE, reply: None }
    }

    fn chip(&mut self, motor: Motor) -> &mut Registers {
        self.chips.get_mut(&motor.index()).unwrap()
    }
}

impl MotorPower for Bus {
    fn enable(&mut self, on: MotorSet) {
        self.powered = on;
    }

    // There are no step pins here.
    fn couple(&mut self, _coupling: &Coupling) {}
}

impl DriverBus for Bus {
    fn lines(&self) -> MotorSet {
        prototype::ALL
    }

    /// A read is sent twice: the value comes with the second frame.
    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize) {
        let chip = self.chip(motor);
        chip.shift(request);
        let said = if reply > 0 { chip.shift(request) } else { Vec::new() };
        self.reply = Some(Ok(Frame::from_slice(&said).unwrap()));
    }

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        self.reply.take()
    }
}

struct Bench {
    bus: Bus,
    drivers: Drivers<OnSpi>,
    ms: u32,
    news: Vec<News>,
}

impl Bench {
    fn new() -> Self {
        let bus = Bus::new();
        let drivers = Drivers::new(bus.lines(), &Settings::prototype());
        Self { bus, drivers, ms: 0, news: Vec::new() }
    }

    fn run(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms += 1;
            self.news.extend(self.drivers.step(&mut self.bus, Instant::default().after_ms(self.ms)));
        }
    }

    fn verify(&mut self, motor: Motor) -> Result<(), DriverError> {
        self.drivers.ask(DriverJob::Verify, motor);
        self.run(50);
        self.drivers.answer().unwrap().map(|_| ())
    }

    fn power(&mut self, on: MotorSet) -> Result<(), Motor> {
        self.drivers.power(on, &mut self.bus, Instant::default().after_ms(self.ms))
    }
}

const M1: MotorSet = MotorSet::of(prototype::M1);

#[test]
fn a_chip_on_spi_proves_its_configuration_before_its_motor_gets_power() {
    let mut bench = Bench::new();
    assert_eq!(bench.power(M1), Err(prototype::M1));
    assert_eq!(bench.verify(prototype::M1), Ok(()));
    assert_eq!(bench.bus.chip(prototype::M1).values[&0x6C], 4 << 24 | 3, "16 microsteps");
    assert_eq!(bench.power(M1), Ok(()));
    bench.run(1000);
    assert_eq!((bench.bus.powered, bench.news.len()), (M1, 0));
    bench.drivers.ask(DriverJob::Read, prototype::M1);
    bench.run(50);
    let reading = bench.drivers.answer().unwrap().unwrap();
    assert_eq!(bench.drivers.shown(&reading).microsteps, Some(16));
}

#[test]
fn a_chip_on_spi_that_was_reset_stops_the_motion() {
    let mut bench = Bench::new();
    assert_eq!((bench.verify(prototype::M1), bench.power(M1)), (Ok(()), Ok(())));
    bench.run(100);
    let values = &mut bench.bus.chip(prototype::M1).values;
    values.insert(0x01, 1);
    values.insert(0x6C, 0);
    bench.run(300);
    let Some(News::Stopped(fault)) = bench.news.first() else { panic!("{:?}", bench.news) };
    assert_eq!((fault.motor, fault.error), (prototype::M1, DriverError::LostConfiguration));
}

#[test]
fn another_chip_at_the_same_plug_is_named() {
    let mut bench = Bench::new();
    bench.bus.chip(prototype::M1).values.insert(0x04, 0x11 << 24);
    let error = bench.verify(prototype::M1).unwrap_err();
    assert_eq!(error.to_string(), "is not a TMC5160: its version is 0x11");
}
