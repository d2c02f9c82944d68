//! Tests of the accelerometers' sequences, against their data sheets' numbers.

use super::*;
use std::collections::VecDeque;
use std::vec::Vec;

/// A sensor of registers alone.
struct Registers {
    values: [u8; 64],
    /// What it answers in place of its identity, one reading after the other.
    answers: VecDeque<u8>,
    /// A register that keeps nothing.
    dead: Option<u8>,
    written: Vec<[u8; 2]>,
    readings: usize,
    identity: u8,
}

impl Registers {
    fn new(identity: u8, value: u8) -> Self {
        let mut values = [0; 64];
        values[usize::from(identity)] = value;
        Self { values, answers: VecDeque::new(), dead: None, written: Vec::new(), readings: 0, identity }
    }

    fn of(kind: SensorKind) -> Self {
        match kind {
            SensorKind::Adxl345 => Self::new(0x00, 0xE5),
            SensorKind::Lis2dw12 => Self::new(0x0F, 0x44),
        }
    }
}

impl Wire for Registers {
    fn transfer(&mut self, bytes: &mut [u8]) {
        let [command, value] = bytes else { panic!("{} bytes", bytes.len()) };
        let register = *command & 0x3F;
        if *command & READ == 0 {
            self.written.push([register, *value]);
            if self.dead != Some(register) {
                self.values[usize::from(register)] = *value;
            }
            return;
        }
        *value = self.values[usize::from(register)];
        if register == self.identity {
            self.readings += 1;
            *value = self.answers.pop_front().unwrap_or(*value);
        }
    }
}

#[test]
fn registers_are_set_as_the_data_sheets_have_them() {
    let mut adxl = Registers::of(SensorKind::Adxl345);
    assert_eq!(start(SensorKind::Adxl345, 3200, &mut adxl), Ok(()));
    // POWER_CTL, DATA_FORMAT, FIFO_CTL, BW_RATE, FIFO_CTL, POWER_CTL.
    assert_eq!(adxl.written, [[0x2D, 0], [0x31, 0x0B], [0x38, 0], [0x2C, 0x0F], [0x38, 0x90], [0x2D, 8]]);
    let mut lis = Registers::of(SensorKind::Lis2dw12);
    assert_eq!(start(SensorKind::Lis2dw12, 3200, &mut lis), Ok(()));
    // CTRL1, CTRL2, CTRL6, FIFO_CTRL twice, CTRL1.
    assert_eq!(lis.written, [[0x20, 0], [0x21, 6], [0x25, 0x34], [0x2E, 0], [0x2E, 0xC0], [0x20, 0x94]]);
    for (kind, mut wire, off) in [(SensorKind::Adxl345, adxl, [0x2D, 0]), (SensorKind::Lis2dw12, lis, [0x20, 0])] {
        stop(kind, &mut wire);
        assert_eq!(wire.written.last(), Some(&off));
    }
}

#[test]
fn the_next_rate_is_taken() {
    let code = |kind, rate, register: usize| {
        let mut wire = Registers::of(kind);
        start(kind, rate, &mut wire).unwrap();
        wire.values[register]
    };
    let adxl = [3200, 2500, 2300, 1600, 1000, 800, 400].map(|rate| code(SensorKind::Adxl345, rate, 0x2C));
    assert_eq!(adxl, [0x0F, 0x0F, 0x0E, 0x0E, 0x0D, 0x0D, 0x0C]);
    let lis = [3200, 1600, 1000, 800, 400].map(|rate| code(SensorKind::Lis2dw12, rate, 0x20));
    assert_eq!(lis, [0x94, 0x94, 0x84, 0x84, 0x74]);
}

/// The numbers that others have seen at the first reading, or always.
#[test]
fn a_wrong_identity_is_named_unless_it_passes() {
    for id in [0x00, 0xFF, 0x72, 0xF2, 0x79] {
        let mut wire = Registers::of(SensorKind::Adxl345);
        // The reading that does not count, and two that do.
        wire.answers = [id; 3].into();
        assert_eq!(start(SensorKind::Adxl345, 3200, &mut wire), Ok(()), "{id:#x}");
        assert_eq!(wire.readings, 4);
        let mut wire = Registers::new(0x00, id);
        assert_eq!(start(SensorKind::Adxl345, 3200, &mut wire), Err(SensorFault::WrongId(id)));
        assert_eq!((wire.readings, wire.written.len()), (4, 0), "nothing is written to a stranger");
    }
    assert_eq!(start(SensorKind::Lis2dw12, 1600, &mut Registers::new(0x0F, 0x33)), Err(SensorFault::WrongId(0x33)));
}

#[test]
fn a_register_that_keeps_nothing_is_found() {
    for (kind, registers) in
        [(SensorKind::Adxl345, [0x31, 0x38, 0x2C, 0x2D]), (SensorKind::Lis2dw12, [0x21, 0x25, 0x2E, 0x20])]
    {
        for register in registers {
            let mut wire = Registers { dead: Some(register), ..Registers::of(kind) };
            assert_eq!(start(kind, 1600, &mut wire), Err(SensorFault::Register), "{register:#x}");
        }
    }
}

/// The bytes 0x34 0x01 are 308: 11,399.17 and 11,797.87 mm/s^2 by 3.774 and 3.906 mg of 9806.65 mm/s^2. A LIS2DW12's
/// 0x1000 is 19,602.00 mm/s^2.
#[test]
fn samples_are_those_of_the_bytes() {
    let of = |kind, raw| scaled(kind, raw).axes;
    assert_eq!(of(SensorKind::Adxl345, [i16::from_le_bytes([0x34, 0x01]); 3]), [11_399, 11_399, 11_798]);
    assert_eq!(of(SensorKind::Adxl345, [i16::from_le_bytes([0xCC, 0xFE]); 3]), [-11_399, -11_399, -11_798]);
    assert_eq!(of(SensorKind::Lis2dw12, [0x1000, -0x1000, 0]), [19_602, -19_602, 0]);
    for raw in [-4096, -257, -1, 0, 1, 1000, 4095_i16] {
        let [x, y, z] = of(SensorKind::Adxl345, [raw; 3]);
        let exact = |mg: f64| f64::from(raw) * mg / 1000.0 * 9806.65;
        assert!(x == y && (f64::from(x) - exact(3.774)).abs() < 0.9 && (f64::from(z) - exact(3.906)).abs() < 0.9);
    }
    for raw in [i16::MIN, -4, 4, 0x7FFC] {
        let [x, ..] = of(SensorKind::Lis2dw12, [raw; 3]);
        assert!((f64::from(x) - f64::from(raw) * 4.785_645).abs() < 0.6);
    }
}

/// The bytes of a sample of an ADXL345, in full resolution, and its FIFO's registers.
fn adxl([x, y, z]: Raw) -> Bytes {
    let [x, y, z] = [x, y, z].map(i16::to_le_bytes);
    [0, x[0], x[1], y[0], y[1], z[0], z[1], 0x90, 3]
}

fn status(value: u8) -> Bytes {
    [0, value, 0, 0, 0, 0, 0, 0, 0]
}

const ASK: Option<Transfer> = Some(Transfer { command: 0xB9, length: 2 });
const FETCH: Option<Transfer> = Some(Transfer { command: 0xF2, length: 9 });

#[test]
fn all_that_waits_is_fetched_and_then_it_rests() {
    let mut reader = Reader::new(SensorKind::Adxl345);
    assert_eq!(reader.on_timer(), Ok(ASK));
    assert_eq!(reader.on_timer(), Ok(None), "the answer is still on its way");
    assert_eq!(reader.on_transfer(&status(2)), Ok((None, FETCH)));
    assert_eq!(reader.on_timer(), Ok(None));
    assert_eq!(reader.on_transfer(&adxl([1, -2, 3])), Ok((Some([1, -2, 3]), FETCH)));
    assert_eq!(reader.on_transfer(&adxl([4, 5, -6])), Ok((Some([4, 5, -6]), None)));
    assert_eq!(reader.on_transfer(&adxl([7, 8, 9])), Ok((None, None)), "nothing was asked for");
    assert_eq!(reader.on_timer(), Ok(ASK));
    assert_eq!(reader.on_transfer(&status(0)), Ok((None, None)));
    let mut lis = Reader::new(SensorKind::Lis2dw12);
    assert_eq!(lis.on_timer(), Ok(Some(Transfer { command: 0xAF, length: 2 })));
    // Its threshold is zero, so bit 7 stands.
    assert_eq!(lis.on_transfer(&status(0x81)), Ok((None, Some(Transfer { command: 0xA8, length: 7 }))));
    assert_eq!(lis.on_transfer(&[0, 0, 0x10, 4, 0, 0, 0xF0, 9, 9]), Ok((Some([0x1000, 4, -0x1000]), None)));
}

#[test]
fn lost_samples_and_a_line_that_nobody_drives_are_told() {
    for (kind, value, fault) in [
        (SensorKind::Adxl345, 32, SensorFault::Overflow),
        (SensorKind::Adxl345, 33, SensorFault::Overflow),
        (SensorKind::Lis2dw12, 0xC1, SensorFault::Overflow),
        (SensorKind::Lis2dw12, 0x60, SensorFault::Overflow),
        (SensorKind::Adxl345, 0xFF, SensorFault::Silent),
        (SensorKind::Lis2dw12, 0xFF, SensorFault::Silent),
    ] {
        let mut reader = Reader::new(kind);
        reader.on_timer().unwrap();
        assert_eq!(reader.on_transfer(&status(value)), Err(fault), "{kind:?} {value:#x}");
    }
    let mut full = Reader::new(SensorKind::Adxl345);
    full.on_timer().unwrap();
    assert_eq!(full.on_transfer(&status(31)), Ok((None, FETCH)));
}

/// 100 ms without a sample, whether the sensor says that none waits or the wires carry nothing.
#[test]
fn a_sensor_that_stops_is_silent() {
    for answers in [true, false] {
        let mut reader = Reader::new(SensorKind::Adxl345);
        let mut events = 0;
        while reader.on_timer().is_ok() {
            events += 1;
            if answers {
                assert_eq!(reader.on_transfer(&status(0)), Ok((None, None)));
            }
        }
        assert_eq!((events, reader.on_timer()), (100, Err(SensorFault::Silent)));
    }
}

/// The answers of a reader to samples, one a millisecond.
fn answers(samples: impl IntoIterator<Item = Bytes>) -> Vec<Result<Raw, SensorFault>> {
    let mut reader = Reader::new(SensorKind::Adxl345);
    let mut answer = |bytes: Bytes| {
        reader.on_timer()?;
        reader.on_transfer(&status(1))?;
        let (sample, next) = reader.on_transfer(&bytes)?;
        assert_eq!(next, None);
        Ok(sample.unwrap())
    };
    samples.into_iter().map(&mut answer).collect()
}

#[test]
fn a_damaged_transfer_repeats_the_last_sample_and_many_end_the_run() {
    let good = |n: i16| adxl([n, -n, 256 + n % 2]);
    let mut broken = good(7);
    broken[7] = 0x91;
    let impossible = adxl([0x1000, 0, 0]);
    for bad in [broken, impossible, [0xFF; LONGEST]] {
        assert_eq!(answers([good(1), bad, good(2)]), [Ok([1, -1, 257]), Ok([1, -1, 257]), Ok([2, -2, 256])]);
        let rare = (0..4000).map(|n| if n % 20 == 0 { bad } else { good(n % 9) });
        assert!(answers(rare).iter().all(Result::is_ok));
        let often = (0..400).map(|n| if n % 8 == 0 { bad } else { good(n % 9) });
        assert_eq!(answers(often).iter().find_map(|answer| answer.err()), Some(SensorFault::Stuck));
        assert_eq!(answers([bad; 5])[4], Err(SensorFault::Stuck));
    }
}

#[test]
fn an_axis_that_never_changes_is_stuck() {
    let samples = |axis: usize| {
        (0..2100).map(move |n| {
            let mut raw = [n % 3, n % 4, 256 + n % 2];
            raw[axis] = 17;
            adxl(raw)
        })
    };
    for axis in 0..3 {
        let answers = answers(samples(axis));
        let first = answers.iter().position(Result::is_err);
        assert_eq!((first, answers[2099]), (Some(2001), Err(SensorFault::Stuck)), "axis {axis}");
    }
}
