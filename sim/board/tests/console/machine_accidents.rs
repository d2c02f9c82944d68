//! A machine that is sent while things go wrong: the power is cut in any byte that is stored, or the lines are any
//! lines at all.

use super::talk::{Steps, Talk};
use super::wild_machine::{self, lines_of};
use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::run_with;
use proptest::prelude::*;

/// An EEPROM that loses power after some bytes; the byte at that moment gets no useful value.
struct Cut<'e> {
    eeprom: &'e mut Eeprom,
    left: usize,
}

impl Storage for Cut<'_> {
    fn capacity(&self) -> u32 {
        corehbot_sim::eeprom::SIZE as u32
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let mut eeprom = &mut *self.eeprom;
        if self.left == 0 { Err(StorageError::Failed) } else { eeprom.read(at, into).await }
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let mut eeprom = &mut *self.eeprom;
        if bytes.len() < self.left {
            self.left -= bytes.len();
            return eeprom.write(at, bytes).await;
        }
        if let Some((torn, before)) = bytes.get(..self.left).and_then(<[u8]>::split_last) {
            eeprom.write(at, before).await?;
            eeprom.write(at + before.len() as u32, &[torn ^ 0x5A]).await?;
        }
        self.left = 0;
        Err(StorageError::Failed)
    }
}

/// The replies of a machine with that storage to these lines.
fn say(storage: impl Storage, lines: &[String]) -> Vec<String> {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let mut host = Talk::new(&lines);
    let outcome = run_with(&Settings::prototype(), None, storage, &mut [&mut host], &mut Steps::default()).unwrap();
    assert!(!outcome.halted, "{:?}", host.heard);
    host.heard
}

/// Cuts at 200 bytes, some of them within the first written page and some after the last. The board then is the old
/// machine or the new one, and takes the new one again.
#[test]
fn a_power_cut_at_any_byte_leaves_the_old_machine_or_the_new() {
    let mut old = Settings::prototype();
    old.wiring.motors.swap(0, 1);
    let mut new = Settings::prototype();
    new.wiring.motors.swap(1, 2);
    new.keepalive_s = 9;
    let lines = lines_of(&new);
    let mut before = Eeprom::blank();
    before.save(&old).unwrap();
    let mut kept = [0; 2];
    for cut in 0..200 {
        let mut eeprom = Eeprom::blank();
        eeprom.cells().copy_from_slice(before.cells());
        // Spread over more bytes than are written, in no order that pages have.
        let left = 1 + cut * 389 % 1109;
        let heard = say(Cut { eeprom: &mut eeprom, left }, &lines);
        let is_new = match eeprom.settings() {
            Some(machine) if machine == new => true,
            Some(machine) if machine == old => false,
            found => panic!("cut after {left}: {found:?}"),
        };
        let is_told = heard.iter().any(|line| line.starts_with("echo:machine stored ("));
        assert!(is_new || !is_told, "cut after {left}: {heard:?}");
        kept[usize::from(is_new)] += 1;
        say(&mut eeprom, &lines);
        assert_eq!(eeprom.settings(), Some(new), "cut after {left}");
    }
    assert!(kept[0] > 50 && kept[1] > 10, "{kept:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever a host sends.
    #[test]
    fn any_dialogue_stores_a_legal_machine_or_none(data in proptest::collection::vec(any::<u8>(), 0..100)) {
        wild_machine::dialogue(&data);
    }

    /// Whatever is in a record with a right checksum.
    #[test]
    fn any_record_is_a_legal_machine_or_none(data in proptest::collection::vec(any::<u8>(), 0..40)) {
        wild_machine::record(&data);
    }
}
