//! The step pins of a machine that does not exist: every event goes into a file.
//!
//! Semihosting takes no virtual time, so the step interrupt itself writes out a full buffer. The timing stays the same
//! as on a printer, no event can get lost, and no other context is involved.

use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::kinematics::{MotorTable, SETS};
use corehbot::port::{Coupling, EndstopSet, GroupSet, MotorSet, StepPort};
use corehbot_cortex_m4::Handover;
use corehbot_rig::Rig;
use corehbot_rig::bed::BedPlant;
use heapless::Vec;
use semihosting::fs::File;
use semihosting::io::Write as _;

use super::time;

/// The tick's lower 48 bits, the motors that step, and the directions; little-endian.
type Record = [u8; 8];

/// Records between two writes. A write costs the emulator some microseconds of wall time.
const BUFFERED: usize = 512;

/// The file, the records still to be written, and the machine.
struct Trace {
    file: File,
    records: Vec<Record, BUFFERED>,
    /// Steps that the machine has not felt yet, by the groups that made them.
    unfelt: [i32; SETS],
    table: MotorTable,
    rig: Rig,
    bed: Option<BedPlant>,
}

impl Trace {
    #[inline(always)]
    fn record(&mut self, groups: GroupSet, record: Record) {
        self.unfelt[groups.0 as usize % SETS] += 1;
        // There is always room: `flush` makes some.
        let _ = self.records.push(record);
        if self.records.is_full() {
            self.flush();
        }
    }

    /// Makes the machine feel the recorded steps, which went `forward`; it has not been read since.
    fn feel(&mut self, forward: MotorSet) {
        // Most sets have made no steps: going through all of them for all motors would hold up the next step.
        for (groups, times) in (0..).zip(&mut self.unfelt).filter(|(_, times)| **times != 0) {
            self.rig.step_often(self.table.motors(GroupSet(groups)), forward, core::mem::take(times));
        }
    }

    #[cold]
    #[inline(never)]
    fn flush(&mut self) {
        assert!(self.file.write_all(self.records.as_flattened()).is_ok(), "the host takes no more of the trace");
        self.records.clear();
    }
}

/// The counter when the last step was made: the trace has motion time, which may be stretched.
static LAST_STEP: AtomicU32 = AtomicU32::new(0);

/// When the last step was made, in ticks since start.
pub fn last_step() -> u32 {
    time::tick_of(LAST_STEP.load(Ordering::Relaxed))
}

static TRACE: Handover<Trace> = Handover::new();

/// Writes out the rest; the step interrupt must be off.
pub fn finish() {
    TRACE.with(Trace::flush);
}

/// Step and direction lines that end in a file, and endstops as the rig has them.
pub struct TracePort {
    table: MotorTable,
    forward: MotorSet,
    inputs: EndstopSet,
}

impl TracePort {
    /// The port of the one machine; `table` groups its motors, and `bed` comes with a probe.
    pub fn new(rig: Rig, bed: Option<BedPlant>, table: MotorTable, file: File) -> Self {
        let probe = if bed.is_some() { EndstopSet::PROBE } else { EndstopSet::NONE };
        TRACE.fill(Trace { file, records: Vec::new(), unfelt: [0; SETS], table, rig, bed });
        Self { table, forward: MotorSet::NONE, inputs: EndstopSet::SWITCHES.with(probe) }
    }

    /// From now on a step of a group turns these motors. The machine first feels pending steps with the previous
    /// coupling.
    pub fn couple(&mut self, coupling: &Coupling) {
        self.table = MotorTable::new(coupling);
        TRACE.with(|trace| {
            trace.feel(self.forward);
            trace.table = self.table;
        });
    }
}

impl StepPort for TracePort {
    fn dir(&mut self, forward: GroupSet) {
        let before = core::mem::replace(&mut self.forward, self.table.forward_motors(forward));
        TRACE.with(|trace| trace.feel(before));
    }

    #[inline(always)]
    fn rise(&mut self, steps: GroupSet, tick: u64) {
        let mut record = tick.to_le_bytes();
        [record[6], record[7]] = [self.table.motors(steps).0, self.forward.0];
        LAST_STEP.store(time::raw(), Ordering::Relaxed);
        // SAFETY: `new` fills the place, and besides the step interrupt, which does not interrupt itself, only `finish`
        // uses it, when that interrupt is off.
        unsafe { TRACE.with_alone(|trace| trace.record(steps, record)) };
    }

    #[inline(always)]
    fn fall(&mut self, _steps: GroupSet) {}

    fn endstops(&mut self) -> EndstopSet {
        TRACE.with(|trace| {
            trace.feel(self.forward);
            let switches = trace.rig.endstops();
            let Some(bed) = &mut trace.bed else { return switches };
            let now = time::ticks();
            bed.follow(now, trace.rig.nozzle(), &trace.rig.counts());
            switches.with(bed.endstops(now))
        })
    }

    fn inputs(&self) -> EndstopSet {
        self.inputs
    }
}
