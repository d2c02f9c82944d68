//! A reading: the values that a driver reports of itself.

/// Number of stored load readings.
pub const LOADS: usize = 4;

/// The values of one driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reading {
    /// Registers as the chip has them. Their meaning is the chip's ([`Chip::shown`](super::Chip::shown)).
    pub registers: Registers,
    /// The last readings of load, the newest first: the smaller, the greater the load. Valid only in the quiet mode.
    loads: [u16; LOADS],
    /// Writes that it has accepted, wrapping.
    pub writes: u32,
    /// The last two readings of its position in its sine table, in 1024ths of an electrical turn.
    phases: [Option<u16>; 2],
}

/// The registers that show a driver's state.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Registers {
    /// Events since they were cleared.
    pub flags: u32,
    /// The mode.
    pub mode: u32,
    /// The chopper and the microsteps.
    pub chopper: u32,
    /// Heat and shorts.
    pub status: u32,
}

impl Reading {
    /// Takes down a reading of load.
    pub const fn note_load(&mut self, load: u16) {
        let [a, b, c, _] = self.loads;
        self.loads = [load, a, b, c];
    }

    /// Takes down a position in the sine table.
    pub const fn note_phase(&mut self, phase: u16) {
        let [newest, _] = self.phases;
        self.phases = [Some(phase), newest];
    }

    /// The newest reading of load.
    #[must_use]
    pub const fn load(&self) -> u32 {
        let [newest, ..] = self.loads;
        newest as u32
    }

    /// All stored readings of load; after a job that reads loads, its results.
    #[must_use]
    pub const fn loads(&self) -> [u16; LOADS] {
        self.loads
    }

    /// The driver's position in its sine table, in 1024ths of an electrical turn. `None` if two readings differ,
    /// because a damaged one may pass its checksum.
    #[must_use]
    pub fn phase(&self) -> Option<u16> {
        let [newest, before] = self.phases;
        newest.filter(|_| newest == before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_is_believed_when_it_was_read_twice() {
        let mut reading = Reading::default();
        reading.note_phase(0x2F0);
        assert_eq!(reading.phase(), None);
        reading.note_phase(0x2F1);
        assert_eq!(reading.phase(), None);
        reading.note_phase(0x2F1);
        assert_eq!(reading.phase(), Some(0x2F1));
    }

    #[test]
    fn the_last_four_loads_are_kept_and_the_newest_comes_first() {
        let mut reading = Reading::default();
        for load in [510, 400, 300, 200, 100] {
            reading.note_load(load);
        }
        assert_eq!((reading.loads(), reading.load()), ([100, 200, 300, 400], 100));
    }
}
