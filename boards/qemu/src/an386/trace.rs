//! The step pins of a machine that does not exist: every event goes into a file.
//!
//! Semihosting takes no virtual time, so the step interrupt itself writes a full buffer out: the timing
//! stays what it is on a printer, no event can get lost, and no other context is involved.

use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::port::{EndstopSet, MotorSet, StepClock as _, StepPort};
use corehbot_cortex_m4::Handover;
use corehbot_rig::Rig;
use heapless::Vec;
use semihosting::fs::File;
use semihosting::io::Write as _;

use super::time::StepTimer;

/// The tick's lower 48 bits, the motors that step, and the directions; little-endian.
type Record = [u8; 8];

/// Records between two writes, each of which costs the emulator some microseconds of wall time.
const BUFFERED: usize = 512;

/// The file and what is not in it yet.
struct Trace {
    file: File,
    records: Vec<Record, BUFFERED>,
}

impl Trace {
    fn record(&mut self, record: Record) {
        if self.records.is_full() {
            self.flush();
        }
        // There is room: `flush` has made some.
        let _ = self.records.push(record);
    }

    fn flush(&mut self) {
        assert!(self.file.write_all(self.records.as_flattened()).is_ok(), "the host takes no more of the trace");
        self.records.clear();
    }
}

/// When the last step was made, in ticks since start: the trace has motion time, which may be stretched.
static LAST_STEP: AtomicU32 = AtomicU32::new(0);

/// When the last step was made, in ticks since start.
pub fn last_step() -> u32 {
    LAST_STEP.load(Ordering::Relaxed)
}

static TRACE: Handover<Trace> = Handover::new();

/// Writes out what is left; the step interrupt must be off.
pub fn finish() {
    TRACE.with(Trace::flush);
}

/// Step and direction lines that end in a file, and endstops as the rig has them.
pub struct TracePort {
    rig: Rig,
    forward: MotorSet,
}

impl TracePort {
    /// The port of the one machine.
    pub fn new(rig: Rig, file: File) -> Self {
        TRACE.fill(Trace { file, records: Vec::new() });
        Self { rig, forward: MotorSet::NONE }
    }
}

impl StepPort for TracePort {
    fn dir(&mut self, forward: MotorSet) {
        self.forward = forward;
    }

    fn rise(&mut self, steps: MotorSet, tick: u64) {
        let mut record = tick.to_le_bytes();
        [record[6], record[7]] = [steps.0, self.forward.0];
        TRACE.with(|trace| trace.record(record));
        LAST_STEP.store(StepTimer.now().0, Ordering::Relaxed);
        self.rig.step(steps, self.forward);
    }

    fn fall(&mut self, _steps: MotorSet) {}

    fn endstops(&mut self) -> EndstopSet {
        self.rig.endstops()
    }
}
