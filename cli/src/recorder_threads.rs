//! Sinks: all that listen to the steps of a print, on two threads of their own.
//!
//! The firmware and its machine run on the caller's thread, and hand over their events in batches. One thread writes
//! and hashes the trace, the other measures and judges the steps. So a print takes as long as the slowest of the
//! three, not as long as all of them. Each thread has a queue of a few batches. When it is full the firmware waits, so
//! memory is bounded. A panic on a thread goes on in the caller.

use crate::digest::RingSha256;
use anyhow::{Context as _, Result};
use corehbot::motors::MotorSet;
use corehbot_host::output::Stream;
use corehbot_report::heat_log::HeatLog;
use corehbot_report::moves::Moves;
use corehbot_report::path::ToolPath;
use corehbot_sim::judge::Judge;
use corehbot_sim::moves::{MadeMove, ShaperChange};
use corehbot_sim::trace::TraceWriter;
use corehbot_sim::vcd::VcdWriter;
use corehbot_sim::world::{HeatPeriod, Sink};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};

/// A file that is being written.
pub(crate) type Out = BufWriter<Stream>;

/// A temporary file, or none.
pub(crate) struct Scratch(pub Option<File>);

impl Write for Scratch {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.as_mut().map_or(Ok(bytes.len()), |file| file.write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.as_mut().map_or(Ok(()), Write::flush)
    }
}

/// Events that are handed over together: half a second of an ordinary print, 64 KiB.
const BATCH: usize = 4096;

/// Batches that wait for a thread at most, 2 MiB: where three threads share two processors, one is ahead for a while.
const WAITING: usize = 32;

/// An instant in which motors step.
#[derive(Clone, Copy)]
struct Event {
    tick: u64,
    steps: MotorSet,
    forward: MotorSet,
}

/// Events in a row.
#[derive(Default)]
struct Batch {
    events: Vec<Event>,
    /// Where z of the program begins to be known by a mesh, or no longer is: before the event of this place.
    mesh: Vec<(usize, Option<f64>)>,
    /// Where something has ended all motion: before the event of this place, and when.
    stops: Vec<(usize, u64)>,
}

impl Batch {
    fn new() -> Self {
        Self { events: Vec::with_capacity(BATCH), mesh: Vec::new(), stops: Vec::new() }
    }
}

/// Sinks that write every step.
pub(crate) struct Writers<W: Write> {
    pub trace: TraceWriter<W, RingSha256>,
    pub vcd: Option<VcdWriter<W>>,
}

impl<W: Write> Writers<W> {
    fn take(&mut self, batch: &Batch) {
        self.write_rows(batch);
        if let Some(vcd) = &mut self.vcd {
            batch.events.iter().for_each(|event| vcd.event(event.tick, event.steps, event.forward));
        }
    }

    // Functions of their own, here and below, so that `cargo xtask bench --host` can tell them apart.
    #[inline(never)]
    fn write_rows(&mut self, batch: &Batch) {
        batch.events.iter().for_each(|event| self.trace.event(event.tick, event.steps, event.forward));
    }
}

/// Sinks that measure and judge the steps.
pub(crate) struct Judges {
    pub judge: Judge,
    pub path: Option<ToolPath<File>>,
}

impl Judges {
    fn take(&mut self, batch: &Batch) {
        self.judge(batch);
        self.follow(batch);
    }

    #[inline(never)]
    fn judge(&mut self, batch: &Batch) {
        let mut from = 0;
        for (place, tick) in &batch.stops {
            self.judge_events(&batch.events[from..*place]);
            self.judge.stopped(*tick);
            from = *place;
        }
        self.judge_events(&batch.events[from..]);
    }

    fn judge_events(&mut self, events: &[Event]) {
        events.iter().for_each(|event| self.judge.event(event.tick, event.steps, event.forward));
    }

    #[inline(never)]
    fn follow(&mut self, batch: &Batch) {
        let Some(path) = &mut self.path else { return };
        let mut mesh = batch.mesh.iter().copied().peekable();
        for (place, event) in batch.events.iter().enumerate() {
            while let Some((_, z)) = mesh.next_if(|(from, _)| *from <= place) {
                path.stand_on_mesh(z);
            }
            path.event(event.tick, event.steps, event.forward);
        }
        mesh.for_each(|(_, z)| path.stand_on_mesh(z));
    }
}

/// A thread with its sinks, and the queue to it.
struct Worker<S> {
    queue: SyncSender<Arc<Batch>>,
    thread: JoinHandle<S>,
}

impl<S: Send + 'static> Worker<S> {
    fn begin(name: &str, mut sinks: S, take: fn(&mut S, &Batch)) -> Result<Self> {
        let (queue, batches) = sync_channel::<Arc<Batch>>(WAITING);
        let work = move || {
            for batch in batches {
                take(&mut sinks, &batch);
            }
            sinks
        };
        let thread = Builder::new().name(name.to_owned()).spawn(work);
        Ok(Self { queue, thread: thread.with_context(|| format!("cannot begin the thread of the {name}"))? })
    }

    /// Whether the thread still takes batches; it waits for a free place in the queue.
    fn hand(&self, batch: &Arc<Batch>) -> bool {
        self.queue.send(Arc::clone(batch)).is_ok()
    }

    /// Waits for the thread's last batch.
    fn finish(self) -> S {
        drop(self.queue);
        self.thread.join().unwrap_or_else(|panic| resume_unwind(panic))
    }
}

/// The way from the printer to the sinks.
pub(crate) struct Relay<W: Write> {
    batch: Batch,
    /// Moves and periods of heat are few, and are taken in here.
    moves: Moves<Scratch>,
    heat: HeatLog,
    /// Until a thread has panicked.
    writers: Option<Worker<Writers<W>>>,
    judges: Option<Worker<Judges>>,
}

/// The sinks after the last event.
pub(crate) struct Done<W: Write> {
    pub writers: Writers<W>,
    pub judges: Judges,
    pub moves: Moves<Scratch>,
    pub heat: HeatLog,
}

impl<W: Write + Send + 'static> Relay<W> {
    /// Begins the threads.
    pub fn begin(writers: Writers<W>, judges: Judges, moves: Moves<Scratch>) -> Result<Self> {
        let writers = Some(Worker::begin("trace", writers, Writers::take)?);
        let judges = Some(Worker::begin("checker", judges, Judges::take)?);
        Ok(Self { batch: Batch::new(), moves, heat: HeatLog::default(), writers, judges })
    }

    fn hand_over(&mut self) {
        let batch = Arc::new(std::mem::replace(&mut self.batch, Batch::new()));
        hand(&mut self.writers, &batch);
        hand(&mut self.judges, &batch);
    }

    /// Waits until the sinks have had every event, and gives them back.
    pub fn finish(mut self) -> Result<Done<W>> {
        self.hand_over();
        let writers = self.writers.map(Worker::finish).context("the thread of the trace has ended")?;
        let judges = self.judges.map(Worker::finish).context("the thread of the checker has ended")?;
        Ok(Done { writers, judges, moves: self.moves, heat: self.heat })
    }
}

/// Hands a batch to a thread. If it takes no more, it has panicked, and the panic goes on here.
fn hand<S: Send + 'static>(worker: &mut Option<Worker<S>>, batch: &Arc<Batch>) {
    if let Some(ended) = worker.take_if(|worker| !worker.hand(batch)) {
        ended.finish();
    }
}

impl<W: Write + Send + 'static> Sink for Relay<W> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.batch.events.push(Event { tick, steps, forward });
        if self.batch.events.len() >= BATCH {
            self.hand_over();
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.batch.stops.push((self.batch.events.len(), tick));
    }

    fn stand_on_mesh(&mut self, z: Option<f64>) {
        self.batch.mesh.push((self.batch.events.len(), z));
    }

    fn wants_moves(&self) -> bool {
        true
    }

    fn moved(&mut self, made: &MadeMove) {
        self.moves.add(made);
    }

    fn reshaped(&mut self, change: &ShaperChange) {
        self.moves.reshape(change);
    }

    fn heat(&mut self, period: &HeatPeriod) {
        self.heat.add(period);
    }
}

#[cfg(test)]
mod tests;
