//! The exchange against a wire and a driver in continuous time, with clocks that are wrong and ticks that are late.

use super::*;
use proptest::prelude::*;

/// A bit in us.
const BIT: f64 = 1e6 / BAUD as f64;

/// No exchange takes more ticks than this: a rest, taking the line, eight bytes, and listening for eight.
const MOST_TICKS: usize = LONG_REST as usize + 81 + (LATE + 8 * BYTE) as usize * OVERSAMPLING as usize;

/// The far end of the wire.
#[derive(Clone, Debug)]
enum Far {
    /// A driver that answers with these bytes, a clock that is wrong by this part, and stop bits at these levels.
    Driver { reply: Vec<u8>, error: f64, stop: bool },
    /// Nothing moves, at this level.
    Stuck(bool),
}

/// Levels from instants on, in us; high before.
#[derive(Clone, Default, Debug)]
struct Wire(Vec<(f64, bool)>);

impl Wire {
    fn is_high(&self, at: f64) -> bool {
        self.0.iter().rev().find(|(from, _)| *from <= at).is_none_or(|(_, level)| *level)
    }

    fn byte(&mut self, byte: u8, from: f64, bit: f64, stop: bool) {
        for n in 0..10_u8 {
            let level = match n {
                0 => false,
                9 => stop,
                _ => byte >> (n - 1) & 1 != 0,
            };
            self.0.push((from + f64::from(n) * bit, level));
        }
    }

    /// The bytes on the wire as a TMC2209 decodes them (datasheet rev 1.09, section 4.1.1), its bit length, and the end
    /// of the last stop bit. The falling edges of the start bit and of bit 3 of the first byte are four bits apart.
    fn decode(&self) -> (Vec<u8>, f64, f64) {
        let falls: Vec<f64> = self.0.windows(2).filter(|pair| pair[0].1 && !pair[1].1).map(|pair| pair[1].0).collect();
        let bit = (falls[2] - falls[0]) / 4.0;
        let (mut bytes, mut end) = (Vec::new(), 0.0);
        while let Some(start) = falls.iter().find(|fall| **fall >= end) {
            let sample = |n: i32| self.is_high(start + (f64::from(n) + 0.5) * bit);
            assert!(!sample(0) && sample(9), "a frame of the request is broken");
            bytes.push((0..8).fold(0, |byte, n| byte | u8::from(sample(n + 1)) << n));
            // The stop bit may be cut short by the next start bit.
            end = start + 9.5 * bit;
        }
        (bytes, bit, end + 0.5 * bit)
    }
}

/// The outcome of an exchange, the bytes that the far end heard, and the number of ticks.
struct Run {
    outcome: Result<Vec<u8>, BusError>,
    heard: Vec<u8>,
    ticks: usize,
}

/// Plays `exchange` after its begin with ticks that are late by `late`, over and over, in us.
fn play(exchange: &mut Exchange, far: &Far, late: &[f64]) -> Run {
    let (mut ours, mut theirs) = (Wire::default(), Wire::default());
    let (mut is_ours, mut heard) = (false, Vec::new());
    let (mut due, mut period) = (0.0, BIT);
    for tick in 0..=MOST_TICKS {
        let at = due + late[tick % late.len()];
        due += period;
        let is_high = match far {
            Far::Stuck(level) => *level,
            Far::Driver { .. } => theirs.is_high(at),
        };
        match exchange.tick(is_high || is_ours) {
            Action::Stay => {}
            Action::Take => {
                is_ours = true;
                ours.0.push((at, true));
            }
            Action::Drive { is_high } => {
                assert!(is_ours, "a bit on a line that nobody drives");
                ours.0.push((at, is_high));
            }
            action @ (Action::Listen | Action::End) => {
                if is_ours {
                    let (bytes, bit, end) = ours.decode();
                    heard = bytes;
                    assert!(end - at < BIT, "let go {} us before the stop bit's end", end - at);
                    if let Far::Driver { reply, error, stop } = far {
                        let bit = bit * (1.0 + error);
                        for (n, byte) in reply.iter().enumerate() {
                            theirs.byte(*byte, end + (8.0 + 10.0 * n as f64) * bit, bit, *stop);
                        }
                    }
                }
                is_ours = false;
                if action == Action::End {
                    let outcome = exchange.outcome().expect("an outcome at the end").map(|frame| frame.to_vec());
                    assert_eq!(exchange.outcome(), None, "told once");
                    return Run { outcome, heard, ticks: tick + 1 };
                }
                due = at + BIT / f64::from(OVERSAMPLING);
                period = BIT / f64::from(OVERSAMPLING);
            }
            Action::Sample(samples) => {
                due -= period;
                period = BIT / f64::from(OVERSAMPLING) * f64::from(samples);
                due += period;
            }
        }
    }
    panic!("no end after {MOST_TICKS} ticks");
}

fn exchange(request: &[u8], wanted: usize, far: &Far, late: &[f64]) -> Run {
    let mut exchange = Exchange::new();
    exchange.begin(&Frame::from_slice(request).unwrap(), wanted);
    play(&mut exchange, far, late)
}

/// A read of register 0x06, and the answer of a driver.
const REQUEST: [u8; 4] = [0x05, 0x00, 0x06, 0x6F];
const REPLY: [u8; 8] = [0x05, 0xFF, 0x06, 0x21, 0x00, 0x02, 0x41, 0x9D];

fn driver(reply: &[u8]) -> Far {
    Far::Driver { reply: reply.to_vec(), error: 0.0, stop: true }
}

#[test]
fn a_register_is_read() {
    let run = exchange(&REQUEST, 8, &driver(&REPLY), &[0.0]);
    assert_eq!((run.heard, run.outcome), (REQUEST.to_vec(), Ok(REPLY.to_vec())));
}

#[test]
fn a_write_has_no_reply_and_ends_with_its_last_stop_bit() {
    let request = [0x05, 0x00, 0x80, 0x00, 0x00, 0x01, 0xC0, 0x55];
    let run = exchange(&request, 0, &driver(&[]), &[0.0]);
    assert_eq!((run.heard, run.outcome), (request.to_vec(), Ok(Vec::new())));
    assert_eq!(run.ticks, usize::from(LONG_REST) + 80 + 1);
}

#[test]
fn a_driver_that_says_nothing_is_silent_and_so_is_one_that_stops() {
    for reply in [&[][..], &REPLY[..7]] {
        let run = exchange(&REQUEST, 8, &driver(reply), &[0.0]);
        assert_eq!(run.outcome, Err(BusError::Silent), "{reply:?}");
        assert_eq!(run.heard, REQUEST);
    }
}

/// A silent driver is asked again, up to four times, while its motor turns.
#[test]
fn nobody_is_waited_for_when_no_reply_has_begun() {
    let mut exchange = Exchange::new();
    exchange.begin(&Frame::from_slice(&REQUEST).unwrap(), 8);
    while exchange.tick(true) != Action::Listen {}
    let samples = 1 + (0..1000).take_while(|_| exchange.tick(true) == Action::Stay).count();
    assert_eq!(samples, usize::from(LATE) * usize::from(OVERSAMPLING));
    assert_eq!(exchange.outcome(), Some(Err(BusError::Silent)));
}

#[test]
fn a_line_that_is_stuck_ends_the_exchange() {
    assert_eq!(exchange(&REQUEST, 8, &Far::Stuck(true), &[0.0]).outcome, Err(BusError::Silent));
    assert_eq!(exchange(&REQUEST, 8, &Far::Stuck(false), &[0.0]).outcome, Err(BusError::Garbled));
}

#[test]
fn a_stop_bit_that_is_low_is_garbled() {
    let far = Far::Driver { reply: REPLY.to_vec(), error: 0.0, stop: false };
    assert_eq!(exchange(&REQUEST, 8, &far, &[0.0]).outcome, Err(BusError::Garbled));
}

#[test]
fn a_pulse_is_no_start_bit() {
    let mut exchange = Exchange::new();
    exchange.begin(&Frame::from_slice(&[0x05]).unwrap(), 1);
    while exchange.tick(true) != Action::Listen {}
    // A low sample, 0xA5 after it, each bit five samples.
    let byte = [false, true, false, true, false, false, true, false, true, true];
    let samples = [false].into_iter().chain([true; 7]).chain(byte.into_iter().flat_map(|level| [level; 5]));
    let samples: Vec<bool> = samples.collect();
    let (mut at, mut period) = (0, 1);
    loop {
        match exchange.tick(samples[at]) {
            Action::Sample(samples) => period = usize::from(samples),
            Action::End => break,
            action => assert_eq!(action, Action::Stay),
        }
        at += period;
    }
    assert_eq!(exchange.outcome(), Some(Ok(Frame::from_slice(&[0xA5]).unwrap())));
}

#[test]
fn the_line_rests_longer_after_a_failure() {
    let rest = |exchange: &mut Exchange| {
        exchange.begin(&Frame::from_slice(&REQUEST).unwrap(), 0);
        let mut ticks = 1;
        while exchange.tick(true) != Action::Take {
            ticks += 1;
        }
        ticks
    };
    let mut exchange = Exchange::new();
    assert_eq!(rest(&mut exchange), usize::from(LONG_REST), "nobody knows what went on before a reset");
    assert_eq!(rest(&mut exchange), usize::from(LONG_REST), "the one before was given up");
    while exchange.tick(true) != Action::End {}
    assert_eq!(rest(&mut exchange), usize::from(REST));
    exchange.fail();
    assert_eq!(exchange.outcome(), Some(Err(BusError::Silent)));
    assert_eq!(rest(&mut exchange), usize::from(LONG_REST));
}

#[test]
fn ticks_without_an_exchange_want_to_end() {
    assert_eq!(Exchange::new().tick(false), Action::End);
}

/// Lateness of ticks up to `most` us.
fn late(most: f64) -> impl Strategy<Value = Vec<f64>> {
    // The extremes more often than by chance.
    let one = prop_oneof![Just(0.0), Just(most), 0.0..most];
    proptest::collection::vec(one, 97)
}

fn any_exchange() -> impl Strategy<Value = ([u8; 3], [u8; 8])> {
    (any::<[u8; 3]>(), any::<[u8; 8]>())
}

fn goes_well(request: [u8; 3], reply: [u8; 8], error: f64, late: &[f64]) {
    let request = [5, request[0], request[1], request[2]];
    let far = Far::Driver { reply: reply.to_vec(), error, stop: true };
    let run = exchange(&request, 8, &far, late);
    assert_eq!((run.heard, run.outcome), (request.to_vec(), Ok(reply.to_vec())));
}

proptest! {
    #[test]
    fn ticks_may_be_almost_6_us_late((request, reply) in any_exchange(), late in late(5.9)) {
        goes_well(request, reply, 0.0, &late);
    }

    #[test]
    fn clocks_may_differ_by_2_percent_with_ticks_almost_3_us_late(
        (request, reply) in any_exchange(), error in prop_oneof![Just(-0.02), Just(0.02), -0.02..0.02], late in late(2.9),
    ) {
        goes_well(request, reply, error, &late);
    }

    #[test]
    fn every_exchange_ends(levels in proptest::collection::vec(any::<bool>(), 1..50), wanted in 0..20usize, length in 0..9usize) {
        let mut exchange = Exchange::new();
        exchange.begin(&Frame::from_slice(&[0x55; 8][..length]).unwrap(), wanted);
        let end = levels.iter().cycle().take(MOST_TICKS).position(|level| exchange.tick(*level) == Action::End);
        prop_assert!(end.is_some() && exchange.outcome().is_some());
    }
}
