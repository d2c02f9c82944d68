//! While storage is busy: stops are heard, and a slow memory is waited for.

use super::talk::{Steps, Talk, keep};
use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Host, run_with};

/// Says a line a number of turns after it has sent M500.
struct Interrupter {
    talk: Talk,
    turns: u32,
    says: &'static str,
}

impl Host for Interrupter {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.talk.send(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.talk.awaiting > 0 {
            self.turns = self.turns.wrapping_sub(1);
            if self.turns == 0 {
                out.extend(self.says.bytes());
                self.talk.awaiting += 1;
            }
        }
    }

    fn hear(&mut self, line: &str) {
        self.talk.hear(line);
    }

    fn is_done(&self) -> bool {
        self.talk.is_done()
    }
}

#[test]
fn an_emergency_stop_is_heard_while_settings_are_saved() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M113 S7", "M500"]);
    let mut stored = made;
    stored.keepalive_s = 7;
    let (before, size) = (eeprom.writes(), eeprom.writes());
    // The M500 of other settings lasts a turn for every page read, written and read again.
    let mut save = |says, turns| {
        let mut host = Interrupter { talk: Talk::new(&["M113 S8", "M500"]), turns, says };
        let outcome = run_with(&made, None, &mut eeprom, &mut [&mut host], &mut Steps::default()).unwrap();
        (outcome.halted, eeprom.writes(), eeprom.settings(), host.talk.heard)
    };
    let (halted, writes, kept, heard) = save("M112\n", 56);
    assert!(halted && writes > before && writes < before + size, "{writes} writes: {heard:?}");
    assert_eq!(kept, Some(stored));
    // A quick stop has nothing to stop there; the save continues.
    let (halted, _, kept, heard) = save("M410\n", 56);
    stored.keepalive_s = 8;
    assert!(!halted && kept == Some(stored), "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("echo:Settings Stored")), "{heard:?}");
    assert_eq!(heard.iter().filter(|l| *l == "ok").count(), 3, "{heard:?}");
}

/// Plans a move, checks the storage, and a number of turns later sends a quick stop.
struct Stopper {
    turns: u32,
    oks: u32,
    stage: u32,
}

impl Host for Stopper {
    fn send(&mut self, _out: &mut Vec<u8>) {}

    fn interject(&mut self, out: &mut Vec<u8>) {
        let (awaited, text) = match self.stage {
            0 => (0, "M17\n"),
            1 => (1, "G1 X50 F3000\nM504\n"),
            2 if self.turns > 0 => {
                self.turns -= 1;
                return;
            }
            2 => (0, "M410\n"),
            3 => (4, "G4 P500\n"),
            _ => return,
        };
        if self.oks >= awaited {
            out.extend(text.bytes());
            self.stage += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.oks += u32::from(line.starts_with("ok"));
    }

    fn is_done(&self) -> bool {
        self.oks == 5
    }
}

/// A move that is planned and has not begun yet is motion, too.
#[test]
fn a_quick_stop_while_storage_is_looked_at_forgets_the_move_before_it() {
    let made = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    keep(&mut eeprom, &made, &["M500", "M113 S7", "M500"]);
    for turns in 0..20 {
        let mut host = Stopper { turns, oks: 0, stage: 0 };
        let mut steps = Steps::default();
        run_with(&made, Some([Mm::ZERO; 3]), &mut eeprom, &mut [&mut host], &mut steps).unwrap();
        assert_eq!(steps.count, 0, "after {turns} turns");
    }
}

/// A memory that is busy for some turns after every write, and perhaps for ever.
struct Busy<'e> {
    eeprom: &'e mut Eeprom,
    asked: u32,
    turns: Option<u32>,
}

impl Storage for Busy<'_> {
    fn capacity(&self) -> u32 {
        self.eeprom.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        assert!(self.asked >= self.turns.unwrap_or(0), "read while busy");
        self.eeprom.read(at, into).await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        assert!(self.asked >= self.turns.unwrap_or(0), "written while busy");
        self.asked = 0;
        self.eeprom.write(at, bytes).await
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        self.asked += 1;
        match self.turns {
            None if self.asked > 20 => Err(StorageError::Failed),
            turns => Ok(turns.is_some_and(|turns| self.asked >= turns)),
        }
    }
}

#[test]
fn memory_that_takes_its_time_is_waited_for_and_m112_is_heard_meanwhile() {
    let made = Settings::prototype();
    let save = |turns: Option<u32>, says, after| {
        let mut eeprom = Eeprom::blank();
        let mut host = Interrupter { talk: Talk::new(&["M500"]), turns: after, says };
        let busy = Busy { eeprom: &mut eeprom, asked: turns.unwrap_or(0), turns };
        let outcome = run_with(&made, None, busy, &mut [&mut host], &mut Steps::default()).unwrap();
        (outcome.halted, eeprom.settings().is_some(), host.talk.heard)
    };
    let (_, is_stored, heard) = save(Some(5), "", 0);
    assert!(is_stored && heard.iter().any(|l| l.starts_with("echo:Settings Stored")), "{heard:?}");
    let (halted, is_stored, heard) = save(Some(50), "M112\n", 10);
    assert!(halted && !is_stored, "{heard:?}");
    let (_, is_stored, heard) = save(None, "", 0);
    assert!(!is_stored && heard.contains(&"echo:Settings not stored: storage does not answer".to_owned()), "{heard:?}");
}
