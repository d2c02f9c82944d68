//! Tests of the threads: they change nothing, memory is bounded, and what goes wrong on a thread is told.

use super::*;
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;
use corehbot_sim::check::Findings;
use corehbot_sim::limits::Limits;
use corehbot_sim::tally::Figures;
use corehbot_sim::trace::Finished;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Twice as many events as fit into the queues.
const EVENTS: u64 = (2 * WAITING * BATCH) as u64 + 7;

/// Steps of the belt and the extruder, with a motor left out now and then, and z told before some of them.
fn tell(sink: &mut impl Sink, mut each: impl FnMut()) {
    for i in 0..EVENTS {
        if i % 1000 == 0 {
            sink.stand_on_mesh((i % 3000 != 0).then_some(i as f64 / 1e6));
            sink.stopped(i * 1250 - i.min(7));
        }
        let steps = if i % 10_000 == 17 { 0x4D } else { 0x4F };
        sink.event(i * 1250, MotorSet(steps), MotorSet(if i / 5000 % 2 == 0 { 0x4C } else { 0x43 }));
        each();
    }
}

fn writers<W: Write>(out: W) -> Writers<W> {
    Writers {
        trace: TraceWriter::with_digest(Some(out), (&Settings::prototype()).into(), RingSha256::default()),
        vcd: None,
    }
}

fn judges() -> Judges {
    let (s, begin) = (Settings::prototype(), [10.0, 20.0, 5.0]);
    Judges {
        judge: Judge::new(&s, &Limits::new(&s, None, ""), begin),
        path: Some(ToolPath::new(&s, begin, tempfile::tempfile().unwrap())),
    }
}

fn results<W: Write>(writers: Writers<W>, judges: Judges) -> (Finished, Figures, Findings, String) {
    let path = judges.path.unwrap().finish().unwrap();
    let path = format!("{:?}", (path.chunks, path.heights, path.printed, path.travelled));
    let (figures, findings) = judges.judge.finish(EVENTS * 1250, [0; MOTORS]);
    (writers.trace.finish().unwrap(), figures, findings, path)
}

/// The same sinks on the caller's thread.
struct Direct(Writers<Vec<u8>>, Judges);

impl Sink for Direct {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.trace.event(tick, steps, forward);
        self.1.judge.event(tick, steps, forward);
        self.1.path.as_mut().unwrap().event(tick, steps, forward);
    }

    fn stopped(&mut self, tick: u64) {
        self.1.judge.stopped(tick);
    }

    fn stand_on_mesh(&mut self, z: Option<f64>) {
        self.1.path.as_mut().unwrap().stand_on_mesh(z);
    }
}

#[test]
fn threads_give_what_the_sinks_alone_give() {
    let mut direct = Direct(writers(Vec::new()), judges());
    tell(&mut direct, || {});
    let expected = results(direct.0, direct.1);
    assert!(expected.2.total > 0, "motors left out are found");
    let mut relay = Relay::begin(writers(Vec::new()), judges(), Moves::new(Scratch(None))).unwrap();
    tell(&mut relay, || {});
    let Done { writers, judges, .. } = relay.finish().unwrap();
    assert_eq!(results(writers, judges), expected);
}

/// Lets the firmware go on as far as it can before it takes a byte.
struct Slow {
    told: Arc<AtomicUsize>,
    written: usize,
    most: Arc<AtomicUsize>,
}

impl Write for Slow {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (0..200).for_each(|_| std::thread::yield_now());
        let waiting = self.told.load(Ordering::Relaxed).saturating_sub(self.written);
        self.most.fetch_max(waiting, Ordering::Relaxed);
        self.written += bytes.iter().filter(|byte| **byte == b'\n').count();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_slow_sink_makes_the_firmware_wait() {
    let (told, most) = (Arc::<AtomicUsize>::default(), Arc::<AtomicUsize>::default());
    let slow = Slow { told: told.clone(), written: 0, most: most.clone() };
    let mut relay = Relay::begin(writers(slow), judges(), Moves::new(Scratch(None))).unwrap();
    tell(&mut relay, || {
        told.fetch_add(1, Ordering::Relaxed);
    });
    relay.finish().unwrap().writers.trace.finish().unwrap();
    // Those in the queue, those that are written and those that are gathered; and a chunk of rows on its way out.
    let bound = (WAITING + 2) * BATCH + (1 << 16) / 16;
    let most = most.load(Ordering::Relaxed);
    assert!(most > 0 && most <= bound, "{most} events wait, {bound} at most");
}

struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_reported_at_the_end_and_the_steps_are_judged_all_the_same() {
    let mut relay = Relay::begin(writers(Full), judges(), Moves::new(Scratch(None))).unwrap();
    tell(&mut relay, || {});
    let Done { writers, judges, .. } = relay.finish().unwrap();
    assert_eq!(writers.trace.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
    assert_eq!(judges.judge.finish(EVENTS * 1250, [0; MOTORS]).0.events, EVENTS);
}

struct Panics;

impl Write for Panics {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        panic!("the sink is broken");
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_panic_on_a_thread_goes_on_in_the_caller() {
    for is_told in [true, false] {
        let mut relay = Relay::begin(writers(Panics), judges(), Moves::new(Scratch(None))).unwrap();
        let told = catch_unwind(AssertUnwindSafe(|| {
            if is_told {
                tell(&mut relay, || {});
            }
            relay.finish().unwrap().writers.trace.finish().unwrap();
        }));
        assert_eq!(told.unwrap_err().downcast_ref::<&str>(), Some(&"the sink is broken"));
    }
}
