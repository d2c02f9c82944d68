//! Drivers on a bus that answers as a test wants.

use corehbot::driver::{DriverError, DriverJob, Drivers, News, Register, Tmc2209};
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::port::{BusError, Coupling, DriverBus, Frame, MotorPower};
use corehbot::settings::Settings;
use corehbot::units::Instant;

/// Drivers that hold what is written to them, unless told otherwise; all share their registers.
pub struct Bus {
    pub registers: [u32; 128],
    pub powered: MotorSet,
    /// Requests, as motor and bytes.
    pub requests: Vec<(Motor, Vec<u8>)>,
    /// Results of the requests with these numbers, instead of the right ones.
    pub mishaps: Vec<(usize, Result<Frame, BusError>)>,
    /// A register that writes never reach.
    pub lost: Option<usize>,
    /// Motors with drivers that do not answer.
    pub silent: MotorSet,
    /// An exchange takes this many steps.
    pub slowness: usize,
    /// The result of the exchange under way, and the steps until then.
    pub outcome: Option<(usize, Result<Frame, BusError>)>,
}

pub const GSTAT: usize = Register::Gstat as usize;
pub const IFCNT: usize = Register::Ifcnt as usize;
pub const CHOPCONF: usize = Register::Chopconf as usize;

impl Bus {
    fn new() -> Self {
        let mut registers = [0; 128];
        registers[Register::Ioin as usize] = 0x2100_0000;
        registers[GSTAT] = 1;
        let (powered, requests, mishaps) = (MotorSet::NONE, Vec::new(), Vec::new());
        Self { registers, powered, requests, mishaps, lost: None, silent: MotorSet::NONE, slowness: 1, outcome: None }
    }

    /// Bit by bit, as section 4.2 of the datasheet has it.
    fn checksum(bytes: &[u8]) -> u8 {
        bytes
            .iter()
            .flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1))
            .fold(0, |crc: u8, bit| if crc >> 7 ^ bit == 1 { crc << 1 ^ 7 } else { crc << 1 })
    }

    fn obey(&mut self, request: &[u8]) -> Result<Frame, BusError> {
        let (sum, body) = request.split_last().unwrap();
        assert_eq!((Self::checksum(body), body[0], body[1]), (*sum, 5, 0));
        let register = usize::from(body[2] & 0x7F);
        if body[2] & 0x80 == 0 {
            let mut reply = vec![5, 0xFF, body[2]];
            reply.extend(self.registers[register].to_be_bytes());
            reply.push(Self::checksum(&reply));
            return Ok(Frame::from_slice(&reply).unwrap());
        }
        if self.lost == Some(register) {
            return Ok(Frame::new());
        }
        let value = u32::from_be_bytes(body[3..7].try_into().unwrap());
        self.registers[IFCNT] = (self.registers[IFCNT] + 1) % 256;
        if register == GSTAT {
            self.registers[GSTAT] &= !value;
        } else {
            self.registers[register] = value;
        }
        Ok(Frame::new())
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

    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize) {
        assert_eq!(reply, if request.len() == 8 { 0 } else { 8 });
        let number = self.requests.len();
        self.requests.push((motor, request.to_vec()));
        let mishap = self.mishaps.iter().find(|(at, _)| *at == number).map(|(_, outcome)| outcome.clone());
        self.outcome = Some((
            self.slowness,
            mishap.unwrap_or_else(|| if self.silent.has(motor) { Err(BusError::Silent) } else { self.obey(request) }),
        ));
    }

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        let (steps, outcome) = self.outcome.take()?;
        if steps > 1 {
            self.outcome = Some((steps - 1, outcome));
            return None;
        }
        Some(outcome)
    }
}

pub struct Bench {
    pub bus: Bus,
    pub drivers: Drivers<Tmc2209>,
    pub ms: u32,
    pub news: Vec<News>,
    /// After a fault the other motors continue.
    pub is_limping: bool,
}

impl Bench {
    pub fn new() -> Self {
        let bus = Bus::new();
        let drivers = Drivers::new(bus.lines(), &Settings::prototype());
        Self { bus, drivers, ms: 0, news: Vec::new(), is_limping: false }
    }

    /// With power for Z1.
    pub fn powered() -> Self {
        let mut bench = Self::new();
        assert_eq!(bench.verify(prototype::Z1), Ok(()));
        assert_eq!(bench.power(Z1), Ok(()));
        bench.bus.requests.clear();
        bench
    }

    /// The number of reads or writes of a register; a write is the register plus 0x80.
    pub fn count(&self, register: u8) -> usize {
        self.bus.requests.iter().filter(|(_, bytes)| bytes[2] == register).count()
    }

    pub fn now(&self) -> Instant {
        Instant::default().after_ms(self.ms)
    }

    pub fn run(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms += 1;
            let now = self.now();
            let news = self.drivers.step(&mut self.bus, now);
            match news {
                Some(News::Stopped(fault)) if self.is_limping => self.drivers.go_on_without(fault.motor, &mut self.bus),
                Some(News::Stopped(_)) => self.drivers.cut(&mut self.bus),
                Some(News::Hot(_)) | None => {}
            }
            self.news.extend(news);
        }
    }

    /// Until something has come to pass, which takes less than a second.
    pub fn run_until(&mut self, is_so: impl Fn(&Self) -> bool) {
        let begin = self.ms;
        while !is_so(self) {
            assert!(self.ms < begin + 1000, "still not so: {:?}", self.bus.requests);
            self.run(1);
        }
    }

    pub fn verify(&mut self, motor: Motor) -> Result<(), DriverError> {
        self.drivers.ask(DriverJob::Verify, motor);
        self.run(200);
        self.drivers.answer().unwrap().map(|_| ())
    }

    pub fn power(&mut self, on: MotorSet) -> Result<(), Motor> {
        let now = self.now();
        self.drivers.power(on, &mut self.bus, now)
    }
}

pub const Z1: MotorSet = MotorSet::of(prototype::Z1);
