//! The drivers' room against a bus that answers as a test wants.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::driver::{Config, DriverError, Drivers, Fault, Job, News, Reading, Register};
use corehbot::motors::{Motor, MotorSet};
use corehbot::port::{BusError, Coupling, DriverBus, Frame};
use corehbot::settings::Settings;
use corehbot::units::Instant;

/// Drivers that take what they are told, unless told otherwise; all share their registers.
struct Bus {
    registers: [u32; 128],
    powered: MotorSet,
    /// Requests, as motor and bytes.
    requests: Vec<(Motor, Vec<u8>)>,
    /// What comes of the requests of these numbers, instead of what should.
    mishaps: Vec<(usize, Result<Frame, BusError>)>,
    /// A register whose writes never arrive.
    lost: Option<usize>,
    /// Motors whose drivers do not answer.
    silent: MotorSet,
    /// An exchange takes so many steps.
    slowness: usize,
    /// What comes of the exchange under way, and the steps until then.
    outcome: Option<(usize, Result<Frame, BusError>)>,
}

const GSTAT: usize = Register::Gstat as usize;
const IFCNT: usize = Register::Ifcnt as usize;
const CHOPCONF: usize = Register::Chopconf as usize;

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

impl DriverBus for Bus {
    fn enable(&mut self, on: MotorSet) {
        self.powered = on;
    }

    // There are no step pins here.
    fn couple(&mut self, _coupling: &Coupling) {}

    fn lines(&self) -> MotorSet {
        MotorSet::ALL
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

struct Bench {
    bus: Bus,
    drivers: Drivers,
    ms: u32,
    news: Vec<News>,
    /// After a fault the other motors go on.
    is_limping: bool,
}

impl Bench {
    fn new() -> Self {
        let bus = Bus::new();
        let drivers = Drivers::new(bus.lines(), &Settings::prototype());
        Self { bus, drivers, ms: 0, news: Vec::new(), is_limping: false }
    }

    /// With power for Z1.
    fn powered() -> Self {
        let mut bench = Self::new();
        assert_eq!(bench.verify(Motor::Z1), Ok(()));
        assert_eq!(bench.power(Z1), Ok(()));
        bench.bus.requests.clear();
        bench
    }

    /// How often a register was asked for or written, a write being the register plus 0x80.
    fn count(&self, register: u8) -> usize {
        self.bus.requests.iter().filter(|(_, bytes)| bytes[2] == register).count()
    }

    fn now(&self) -> Instant {
        Instant::default().after_ms(self.ms)
    }

    fn run(&mut self, ms: u32) {
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
    fn run_until(&mut self, is_so: impl Fn(&Self) -> bool) {
        let begin = self.ms;
        while !is_so(self) {
            assert!(self.ms < begin + 1000, "still not so: {:?}", self.bus.requests);
            self.run(1);
        }
    }

    fn verify(&mut self, motor: Motor) -> Result<(), DriverError> {
        self.drivers.ask(Job::Verify, motor);
        self.run(200);
        self.drivers.answer().unwrap().map(|_| ())
    }

    fn power(&mut self, on: MotorSet) -> Result<(), Motor> {
        let now = self.now();
        self.drivers.power(on, &mut self.bus, now)
    }
}

const Z1: MotorSet = MotorSet::of(Motor::Z1);

#[test]
fn the_flags_are_cleared_before_anything_is_counted_and_read_after_everything() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    let registers: Vec<u8> = bench.bus.requests.iter().map(|(_, bytes)| bytes[2]).collect();
    let writes = [0x80, 0x90, 0x91, 0x93, 0x94, 0xA2, 0xC0, 0xC2, 0xEC, 0xF0];
    let (begin, end) = ([0x83, 0x06, 0x81, 0x02], [0x02, 0x00, 0x6C, 0x70, 0x01]);
    assert_eq!(registers, [&begin[..], &writes, &end].concat());
    let config = Config::new(Motor::Z1, &Settings::prototype());
    assert_eq!(bench.drivers.known(Motor::Z1), (Some(config), 0));
    assert_eq!(bench.bus.registers[CHOPCONF], config.value(Register::Chopconf));
}

#[test]
fn power_needs_a_proof_of_every_driver_and_the_proof_must_be_new() {
    let mut bench = Bench::new();
    assert_eq!(bench.power(Z1), Err(Motor::Z1));
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.power(MotorSet::Z), Err(Motor::Z2));
    assert_eq!(bench.bus.powered, MotorSet::NONE);
    bench.run(510);
    assert_eq!(bench.power(Z1), Err(Motor::Z1), "too old");
    let before = bench.bus.requests.len();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.bus.requests.len() - before, 3, "a quick proof");
    assert_eq!(bench.power(Z1), Ok(()));
    assert_eq!(bench.bus.powered, Z1);
    // A proof is good for one time.
    assert_eq!(bench.power(MotorSet::NONE), Ok(()));
    assert_eq!(bench.power(Z1), Err(Motor::Z1));
}

#[test]
fn a_count_that_wraps_is_right_and_one_that_does_not_fit_is_not() {
    let mut bench = Bench::new();
    bench.bus.registers[IFCNT] = 250;
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    let mut bench = Bench::new();
    bench.bus.lost = Some(Register::IholdIrun as usize);
    assert_eq!(bench.verify(Motor::Z1), Err(DriverError::NotTaken));
    let counts = bench.bus.requests.iter().filter(|(_, bytes)| bytes[2] == IFCNT as u8).count();
    assert_eq!(counts, 4 * 3, "four rounds, and the wrong count was read twice in each");
}

#[test]
fn silence_is_believed_after_four_tries() {
    for (silent, expected) in [(3, Ok(())), (4, Err(DriverError::Silent))] {
        let mut bench = Bench::new();
        bench.bus.mishaps = (1..=silent).map(|n| (n, Err(BusError::Silent))).collect();
        assert_eq!(bench.verify(Motor::M1), expected);
        assert_eq!(bench.drivers.known(Motor::M1).1, silent as u16);
    }
}

#[test]
fn registers_of_drivers_with_power_are_read_in_turn_a_hundred_and_twenty_times_a_second() {
    let mut bench = Bench::new();
    for motor in [Motor::Z1, Motor::Z2] {
        assert_eq!(bench.verify(motor), Ok(()));
        let on = bench.drivers.powered().with(MotorSet::of(motor));
        assert_eq!(bench.power(on), Ok(()));
    }
    bench.run(100);
    bench.bus.requests.clear();
    bench.run(1000);
    assert!((120..=126).contains(&bench.bus.requests.len()), "{}", bench.bus.requests.len());
    // DRV_STATUS, GSTAT and CHOPCONF of one, and then of the other.
    let begin = bench.bus.requests.iter().position(|(_, bytes)| bytes[2] == 0x6F).unwrap();
    let both: Vec<_> = bench.bus.requests[begin..].chunks_exact(3).collect();
    for each in &both {
        let registers: Vec<u8> = each.iter().map(|(_, bytes)| bytes[2]).collect();
        assert_eq!(registers, [0x6F, 0x01, 0x6C]);
        assert!(each.iter().all(|(motor, _)| *motor == each[0].0));
    }
    assert!(both.windows(2).all(|pair| pair[0][0].0 != pair[1][0].0));
    assert_eq!(bench.news, []);
}

#[test]
fn a_fault_takes_the_power_from_all_and_stays() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    bench.bus.registers[GSTAT] = 1;
    bench.run(110);
    let fault = Fault { motor: Motor::Z1, error: DriverError::LostConfiguration };
    assert_eq!((bench.bus.powered, bench.drivers.powered()), (MotorSet::NONE, MotorSet::NONE));
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[News::Stopped(fault)][..], Some(fault)));
    assert_eq!(bench.power(MotorSet::NONE), Ok(()));
    let before = bench.bus.requests.len();
    bench.run(500);
    bench.drivers.ask(Job::Read, Motor::Z2);
    bench.run(500);
    assert_eq!(bench.bus.requests.len(), before, "nobody talks any more");
}

#[test]
fn other_settings_reach_a_motor_with_power_and_other_microsteps_forbid_driving_until_then() {
    let mut bench = Bench::new();
    let mut settings = Settings::prototype();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    assert!(!bench.drivers.is_configured() && bench.drivers.is_drivable());
    bench.run(50);
    assert!(bench.drivers.is_configured());
    settings.drivers.z.microsteps = 32;
    bench.drivers.want(&settings);
    assert!(!bench.drivers.is_drivable());
    bench.run(50);
    assert!(bench.drivers.is_drivable() && bench.drivers.is_configured());
    assert_eq!(bench.drivers.known(Motor::Z1).0.unwrap().microsteps(), 32);
}

#[test]
fn a_motor_with_power_that_does_not_take_its_new_settings_is_a_fault() {
    let mut bench = Bench::new();
    let mut settings = Settings::prototype();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    bench.bus.lost = Some(Register::IholdIrun as usize);
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    bench.run(300);
    let fault = Fault { motor: Motor::Z1, error: DriverError::NotTaken };
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[News::Stopped(fault)][..], Some(fault)));
    assert_eq!((bench.bus.powered, bench.drivers.powered()), (MotorSet::NONE, MotorSet::NONE));
}

#[test]
fn a_driver_that_is_being_written_has_proved_nothing() {
    let mut bench = Bench::new();
    let old = Settings::prototype();
    let mut new = old;
    new.drivers.z.current_ma = 500;
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.power(Z1), Ok(()));
    // A change under power proves what it has written; the next one is on its way when it is taken back.
    bench.drivers.want(&new);
    bench.run(60);
    assert!(bench.drivers.is_configured());
    bench.drivers.want(&old);
    bench.run_until(|bench| bench.count(0x90) == 3);
    bench.drivers.want(&new);
    bench.drivers.cut(&mut bench.bus);
    assert_eq!(bench.drivers.known(Motor::Z1).0, Some(Config::new(Motor::Z1, &new)), "held as far as is known");
    assert_eq!(bench.power(Z1), Err(Motor::Z1), "but the old current is on its way");
}

#[test]
fn an_answer_goes_to_the_last_who_asked() {
    let mut bench = Bench::new();
    bench.drivers.ask(Job::Verify, Motor::M1);
    bench.run(5);
    bench.drivers.ask(Job::Read, Motor::M4);
    bench.run(100);
    let reading = bench.drivers.answer().unwrap().unwrap();
    assert_eq!(reading.microsteps(), Some(16));
    assert!(bench.drivers.known(Motor::M1).0.is_some(), "the first job was done all the same");
    assert_eq!(bench.drivers.answer(), None);
}

#[test]
fn a_proof_is_used_up_by_the_motor_that_gets_power_and_by_no_other() {
    let mut bench = Bench::new();
    for motor in [Motor::Z1, Motor::Z2] {
        assert_eq!(bench.verify(motor), Ok(()));
    }
    assert_eq!(bench.power(Z1), Ok(()));
    assert_eq!(bench.power(MotorSet::Z), Ok(()), "Z2 has proved itself as well");
    bench.drivers.cut(&mut bench.bus);
    assert_eq!(bench.power(Z1), Err(Motor::Z1));
}

#[test]
fn while_a_driver_is_written_it_holds_nothing_that_counts() {
    let mut bench = Bench::new();
    let old = Settings::prototype();
    let mut new = old;
    new.drivers.z.current_ma = 500;
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    bench.drivers.want(&new);
    bench.drivers.ask(Job::Verify, Motor::Z1);
    bench.run(10);
    assert_eq!(bench.drivers.known(Motor::Z1).0, None, "without power all is written anew");

    let mut bench = Bench::powered();
    new.drivers.z.microsteps = 32;
    bench.drivers.want(&new);
    bench.run_until(|bench| bench.count(0xEC) > 0);
    bench.drivers.want(&old);
    assert!(!bench.drivers.is_drivable(), "the old microsteps are wanted, the new ones on their way");
    bench.run(100);
    assert!(bench.drivers.is_drivable() && bench.drivers.is_configured());
}

#[test]
fn a_driver_that_holds_something_else_is_written_anew() {
    let mut bench = Bench::new();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    let config = Config::new(Motor::Z1, &Settings::prototype());
    bench.bus.registers[CHOPCONF] = 0x1000_0053;
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.bus.registers[CHOPCONF], config.value(Register::Chopconf));
}

#[test]
fn under_power_no_flag_is_cleared_however_often_a_change_is_written() {
    let mut bench = Bench::powered();
    let mut settings = Settings::prototype();
    settings.drivers.z.current_ma = 500;
    bench.bus.lost = Some(Register::IholdIrun as usize);
    bench.drivers.want(&settings);
    bench.run_until(|bench| bench.count(0x90) == 2);
    bench.bus.lost = None;
    bench.run(100);
    assert!(bench.drivers.is_configured());
    assert_eq!((bench.count(0x81), bench.news.as_slice()), (0, &[][..]));
}

#[test]
fn on_a_slow_wire_polls_and_what_is_asked_take_turns() {
    let mut bench = Bench::powered();
    // A poll takes 45 ms, so that the next one is due when it ends.
    bench.bus.slowness = 15;
    let mut answers = 0;
    for _ in 0..30 {
        bench.drivers.ask(Job::Read, Motor::Z2);
        for _ in 0..300 {
            bench.run(1);
            if let Some(answer) = bench.drivers.answer() {
                assert!(answer.is_ok());
                answers += 1;
                break;
            }
        }
    }
    assert_eq!(answers, 30);
    let of = |wanted| bench.bus.requests.iter().filter(|(motor, _)| *motor == wanted).count();
    let (looks, reads) = (of(Motor::Z1), of(Motor::Z2));
    assert!(reads == 6 * 30 && looks.abs_diff(reads) <= 30, "{looks} {reads}");
    // However often somebody asks, motors with power are looked at.
    bench.bus.requests.clear();
    for _ in 0..1000 {
        bench.drivers.ask(Job::Read, Motor::Z2);
        bench.run(1);
    }
    assert!(bench.bus.requests.iter().filter(|(motor, bytes)| *motor == Motor::Z1 && bytes[2] == 1).count() > 5);
    // And a change gets its turn: every second exchange, after the six of a report that is under way. It has eighteen.
    let mut settings = Settings::prototype();
    settings.drivers.z.current_ma = 500;
    bench.drivers.want(&settings);
    bench.run(2 * (6 + 18) * 15);
    assert!(bench.drivers.is_configured());
}

#[test]
fn nobody_asks_a_driver_without_a_wire_or_configures_one_whose_motor_has_power() {
    let settings = Settings::prototype();
    let mut bench = Bench::new();
    bench.drivers = Drivers::new(MotorSet::Z, &settings);
    for job in [Job::Verify, Job::Read] {
        bench.drivers.ask(job, Motor::M1);
        bench.run(10);
        assert_eq!(bench.drivers.answer(), Some(Ok(Reading::default())), "{job:?}");
    }
    assert_eq!(bench.bus.requests, []);
    let mut bench = Bench::powered();
    assert_eq!(bench.verify(Motor::Z1), Ok(()));
    assert_eq!(bench.count(0x81), 0, "its flags stay");
    bench.drivers.ask(Job::Read, Motor::Z1);
    bench.run(100);
    assert_eq!(bench.drivers.answer().unwrap().unwrap().microsteps(), Some(16), "but it may be read");
}

#[test]
fn what_a_look_finds_after_the_power_has_gone_is_no_fault() {
    let mut bench = Bench::powered();
    bench.bus.registers[GSTAT] = 1;
    bench.run_until(|bench| bench.count(GSTAT as u8) > 0);
    bench.drivers.cut(&mut bench.bus);
    bench.run(100);
    assert_eq!((bench.news.as_slice(), bench.drivers.fault()), (&[][..], None));
    assert_eq!(bench.drivers.known(Motor::Z1).0, None, "but it has everything to prove");
}

#[test]
fn heat_is_reported_once() {
    let mut bench = Bench::powered();
    bench.run(100);
    assert_eq!(bench.news, []);
    // The pre-warning, bit 0 of DRV_STATUS.
    bench.bus.registers[Register::DrvStatus as usize] = 1;
    bench.run(500);
    assert_eq!(bench.news, [News::Hot(Motor::Z1)]);
    assert_eq!(bench.bus.powered, Z1, "it is still at work");
}

/// The four motors of a belt, all others too.
fn belt() -> Bench {
    let mut bench = Bench::new();
    bench.drivers.watch_closely(MotorSet::BELT);
    for motor in Motor::ALL {
        assert_eq!(bench.verify(motor), Ok(()));
        let on = bench.drivers.powered().with(MotorSet::of(motor));
        assert_eq!(bench.power(on), Ok(()));
    }
    // As long as at 19,200 baud.
    bench.bus.slowness = 8;
    bench.run(200);
    bench
}

#[test]
fn a_belt_motor_without_supply_is_noticed_within_100_ms_whenever_it_fails_and_whatever_else_goes_on() {
    let mut worst = 0;
    for wait in 0..64 {
        for is_busy in [false, true] {
            let mut bench = belt();
            if is_busy {
                bench.drivers.ask(Job::Read, Motor::E0);
            }
            bench.run(wait);
            let motor = [Motor::M1, Motor::M4, Motor::M8, Motor::M11][wait as usize % 4];
            bench.bus.silent = MotorSet::of(motor);
            let begin = bench.ms;
            while bench.news.is_empty() && bench.ms < begin + 1000 {
                bench.run(1);
            }
            assert_eq!(bench.news, [News::Stopped(Fault { motor, error: DriverError::Silent })]);
            worst = worst.max(bench.ms - begin);
        }
    }
    assert!(worst <= 100, "{worst} ms");
    println!("noticed after {worst} ms at most");
}

#[test]
fn why_a_driver_has_switched_itself_off_is_asked_before_it_is_told() {
    let status = Register::DrvStatus as usize;
    for (said, error) in
        [(0, DriverError::ShutDown), (1 << 3, DriverError::ShortCircuit), (1 << 1, DriverError::OverTemperature)]
    {
        let mut bench = belt();
        (bench.bus.registers[GSTAT], bench.bus.registers[status]) = (2, said);
        let begin = bench.ms;
        while bench.news.is_empty() && bench.ms < begin + 1000 {
            bench.run(1);
        }
        assert!(matches!(bench.news[..], [News::Stopped(fault)] if fault.error == error), "{:?}", bench.news);
        // All drivers say so here, so the next look finds it.
        assert!(bench.ms - begin <= 64, "{} ms", bench.ms - begin);
    }
}

#[test]
fn after_a_fault_the_others_go_on_and_are_looked_at_at_once() {
    let mut bench = belt();
    bench.is_limping = true;
    bench.bus.silent = MotorSet::of(Motor::M8);
    while bench.news.is_empty() {
        bench.run(1);
    }
    let others = MotorSet::ALL.without(MotorSet::of(Motor::M8));
    assert_eq!((bench.bus.powered, bench.drivers.powered(), bench.drivers.are_unseen()), (others, others, true));
    bench.run(56);
    assert!(!bench.drivers.are_unseen(), "six looks of 8 ms");
    // Nobody changes or proves anything any more, and nobody gets power.
    let mut settings = Settings::prototype();
    settings.drivers.belt.current_ma = 500;
    bench.drivers.want(&settings);
    bench.bus.requests.clear();
    bench.run(200);
    assert!(bench.bus.requests.iter().all(|(motor, bytes)| bytes.len() == 4 && *motor != Motor::M8));
    assert_eq!(bench.power(others.with(MotorSet::of(Motor::M8))), Err(Motor::M8));
    assert_eq!(bench.bus.powered, others);
    // A second fault is told, and the first one stays the reason.
    bench.bus.silent = MotorSet::of(Motor::M8).with(MotorSet::of(Motor::M1));
    bench.is_limping = false;
    bench.run(100);
    let [first, second] = [Motor::M8, Motor::M1].map(|motor| Fault { motor, error: DriverError::Silent });
    assert_eq!(bench.news, [News::Stopped(first), News::Stopped(second)]);
    assert_eq!((bench.drivers.fault(), bench.bus.powered), (Some(first), MotorSet::NONE));
}

#[test]
fn a_motor_that_pulls_against_nobody_is_noticed_no_later_than_it_was() {
    let mut worst = 0;
    for wait in 0..200 {
        let mut bench = belt();
        bench.run(wait);
        let motor = [Motor::Z1, Motor::Z2, Motor::E0][wait as usize % 3];
        bench.bus.silent = MotorSet::of(motor);
        let begin = bench.ms;
        while bench.news.is_empty() && bench.ms < begin + 1000 {
            bench.run(1);
        }
        assert_eq!(bench.news, [News::Stopped(Fault { motor, error: DriverError::Silent })]);
        worst = worst.max(bench.ms - begin);
    }
    // A look at it at least every 175 ms, and four tries.
    assert!(worst <= 175 + 4 * 8, "{worst} ms");
    println!("noticed after {worst} ms at most");
}
