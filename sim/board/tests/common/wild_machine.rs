//! Properties of a stored machine whatever is in the storage and whatever a host says: one body each for the fuzzer and
//! for the property tests.

use corehbot::connectors::BoardConnectors;
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::storage::{LONGEST, record_of};
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Host, Sink, run_with};

/// Bytes of a record before its payload, and where its checksum stands among them.
const HEADER: usize = 16;
const CHECKSUM: std::ops::Range<usize> = 12..16;

/// The lines that put a machine together and store it.
pub fn lines_of(machine: &Settings) -> Vec<String> {
    let mut record = [0; LONGEST];
    let length = record_of(machine, &mut record).unwrap();
    let pieces = record[..length].chunks(24).enumerate().map(|(n, piece)| put(24 * n, piece));
    pieces.chain(["MACHINE_STORE".to_owned()]).collect()
}

fn put(at: usize, bytes: &[u8]) -> String {
    let hex: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    format!("MACHINE_PUT AT={at} HEX={hex}")
}

/// CRC-32 bit by bit.
fn crc<'b>(bytes: impl Iterator<Item = &'b u8>) -> u32 {
    let bit = |sum: u32, _| if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 };
    !bytes.fold(!0, |sum, byte| (0..8).fold(sum ^ u32::from(*byte), bit))
}

/// The bytes change the record of a machine: three of them change one byte of the record, and its checksum is
/// corrected. The firmware finds legal settings, or none.
pub fn record(data: &[u8]) {
    let mut eeprom = Eeprom::blank();
    let mut machine = Settings::prototype();
    // Every second machine has pulleys of different sizes.
    if data.len() % 2 == 1 {
        machine.belt.is_closed = false;
        machine.mechanism.rows[1] = machine.mechanism.rows[1].map(|times| 3 * times);
        machine.mechanism.rows[3] = machine.mechanism.rows[3].map(|times| 3 * times);
    }
    machine.check_machine().unwrap();
    eeprom.save(&machine).unwrap();
    let cells = eeprom.cells();
    let length = HEADER + usize::from(u16::from_le_bytes([cells[6], cells[7]]));
    for change in data.chunks_exact(3) {
        cells[usize::from(u16::from_le_bytes([change[0], change[1]])) % length] = change[2];
    }
    let record = &mut cells[..length];
    let sum = crc(record[..CHECKSUM.start].iter().chain(&record[HEADER..]));
    record[CHECKSUM].copy_from_slice(&sum.to_le_bytes());
    let found = eeprom.settings();
    assert!(found.is_some() || data.len() >= 3, "the record as it was saved");
    if let Some(machine) = found {
        // It can be stored again, and is the same then.
        let mut other = Eeprom::blank();
        other.save(&machine).unwrap();
        assert_eq!(other.settings(), Some(machine));
    }
}

/// The bytes choose lines of the dialogue, right and wrong. Each is answered once, and the board stays on. Afterwards
/// it has stored a machine that it can be, or none.
pub fn dialogue(data: &[u8]) {
    let right = lines_of(&Settings { keepalive_s: 9, ..Settings::prototype() });
    let mut bytes = data.iter().copied();
    let mut lines: Vec<String> = right.iter().take(usize::from(bytes.next().unwrap_or(0))).cloned().collect();
    while let Some(what) = bytes.next() {
        let mut next = || usize::from(bytes.next().unwrap_or(0));
        let piece = right[next() % right.len()].clone();
        lines.push(match what % 16 {
            0..10 => piece,
            10..12 => {
                // Not the second letter: M0 waits for a user.
                let (at, letter) = (2 + next() % (piece.len() - 2), b"0123456789abcdefABCDEFxG -"[next() % 26]);
                [&piece[..at], &char::from(letter).to_string(), &piece[at + 1..]].concat()
            }
            12 | 13 => {
                let at = next() * 256 + next();
                let count = next() % 31;
                put(at, &(0..count).map(|_| next() as u8).collect::<Vec<_>>())
            }
            14 => "MACHINE_STORE".to_owned(),
            _ => "MACHINE_GET".to_owned(),
        });
    }
    let mut eeprom = Eeprom::blank();
    let count = lines.len();
    let mut host = Talker { lines: lines.into_iter(), asked: 0, oks: 0 };
    let outcome = run_with(&Settings::prototype(), None, &mut eeprom, &mut [&mut host], &mut Nothing).unwrap();
    assert!(!outcome.halted);
    assert_eq!(host.oks, count);
    if let Some(machine) = eeprom.settings() {
        machine.check_machine().unwrap();
        machine.check_connectors(&BoardConnectors::ANY).unwrap();
    }
}

/// A host that sends a line for each `ok`.
struct Talker {
    lines: std::vec::IntoIter<String>,
    asked: usize,
    oks: usize,
}

impl Host for Talker {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.asked == self.oks
            && let Some(line) = self.lines.next()
        {
            out.extend(line.bytes());
            out.push(b'\n');
            self.asked += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.oks += usize::from(line.starts_with("ok"));
    }

    fn is_done(&self) -> bool {
        self.lines.len() == 0 && self.asked == self.oks
    }
}

struct Nothing;

impl Sink for Nothing {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}
