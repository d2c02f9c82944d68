//! A profile: one job, printed in QEMU and counted.

use super::contexts::Context;
use super::cycles::{Cost, EXCEPTION, REFILL, cost};
use super::host::PlainHost;
use super::jobs::Job;
use super::plugin::{Counts, Plugin, Spot};
use super::rooms::Room;
use super::waits::FLASH;
use crate::image_code::Code;
use crate::qemu;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use std::collections::{BTreeMap, HashMap};
use std::ops::AddAssign;
use std::path::Path;

/// The totals of a job.
pub struct Profile {
    /// Step events.
    pub events: u64,
    /// Steps of all motors.
    pub motor_steps: u64,
    /// From the first step to the end of the motion.
    pub seconds: f64,
    counts: Counts,
    costs: HashMap<u64, Cost>,
}

/// Work that was done.
#[derive(Clone, Copy, Default)]
pub struct Work {
    /// Instructions, exactly.
    pub instructions: u64,
    /// Cycles, estimated, without exception entry and return.
    pub cycles: u64,
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.instructions += other.instructions;
        self.cycles += other.cycles;
    }
}

/// The work of one function, with inlined library code, in one context.
pub struct Function {
    /// The running context.
    pub context: Context,
    /// The room it worked for.
    pub room: Option<Room>,
    /// Its name.
    pub name: String,
    /// Its work.
    pub work: Work,
}

impl Profile {
    /// Prints a job.
    pub fn of(job: Job, image: &Path, code: &Code<'_>, plugin: &Plugin, folder: &Path) -> Result<Self> {
        let gcode = job.gcode();
        let (trace, out) = (folder.join(format!("{job}.csv")), folder.join(format!("{job}.counts")));
        let (settings, start) = (job.settings(), Some(job.start()));
        let printer = qemu::Job { gcode: String::new(), settings, start, mesh: job.mesh(), patience_ms: 0 };
        let watcher = plugin.watcher(&out)?;
        let outcome = if job.is_numbered() {
            let mut host = FileHost::new(&gcode);
            let outcome = printer.watch(image, &trace, &watcher, &mut host)?;
            if let Some(remark) = host.failure().or_else(|| host.warnings().first()) {
                bail!("the print went wrong at {remark}");
            }
            outcome
        } else {
            printer.watch(image, &trace, &watcher, &mut PlainHost::new(&gcode) as &mut dyn Host)?
        };
        let late = outcome.log.iter().find(|line| line.contains("times the host was too slow"));
        let is_punctual = late.is_some_and(|line| line.contains("the generator: 0, the stepper: 0"));
        ensure!(is_punctual, "the firmware could not keep up: {}", late.map_or("it says nothing", |line| line));
        let motor_steps = steps_in(&trace)?;
        std::fs::remove_file(&trace)?;
        let counts = Counts::read(&out)?;
        let costs = counts.spots.iter().map(|spot| (spot.address, code.words(spot.address)));
        let costs = costs.map(|(address, [first, second])| (address, cost(first, second))).collect();
        let seconds = outcome.ticks as f64 / f64::from(TICKS_PER_SECOND);
        Ok(Self { events: outcome.events, motor_steps, seconds, counts, costs })
    }

    /// The work at all spots that `is_wanted`, except for idling.
    pub fn work(&self, is_wanted: impl Fn(&Spot) -> bool) -> Work {
        let mut sum = Work::default();
        for spot in self.counts.spots.iter().filter(|spot| spot.context != Context::Idle && is_wanted(spot)) {
            sum += self.work_at(spot);
        }
        sum
    }

    /// The work for a room in whichever context.
    pub fn in_room(&self, room: Room) -> Work {
        self.work(|spot| spot.room == Some(room))
    }

    /// The work in a context.
    pub fn in_context(&self, context: Context) -> Work {
        self.work(|spot| spot.context == context)
    }

    /// How often a context was entered.
    pub fn entries(&self, context: Context) -> u64 {
        self.counts.entries.get(&context).map_or(0, |(entries, _)| *entries)
    }

    /// The most instructions from a context's entry to its return.
    pub fn longest(&self, context: Context) -> u64 {
        self.counts.entries.get(&context).map_or(0, |(_, longest)| *longest)
    }

    /// The most instructions for a room in one go of the Console.
    pub fn most(&self, room: Room) -> u64 {
        let most = |context| self.counts.most.get(&(context, room)).copied().unwrap_or_default();
        most(Context::Console).max(most(Context::Waiting))
    }

    /// Instructions from the last byte of a line to the first byte of its answer, on average.
    pub fn to_answer(&self) -> f64 {
        let (answers, instructions) = self.counts.answers;
        instructions as f64 / answers.max(1) as f64
    }

    /// Cycles for which some contexts wait for flash.
    pub fn flash(&self, contexts: &[Context]) -> u64 {
        let missed = contexts.iter().filter_map(|context| self.counts.missed.get(context));
        FLASH * missed.flatten().sum::<u64>()
    }

    /// Cycles of work in some contexts with entering and leaving them.
    pub fn cycles(&self, contexts: &[Context], is_wanted: impl Fn(&Spot) -> bool) -> u64 {
        let work = self.work(|spot| contexts.contains(&spot.context) && is_wanted(spot));
        work.cycles + EXCEPTION * contexts.iter().map(|context| self.entries(*context)).sum::<u64>()
    }

    /// How often a context called the function whose name has `name` in it.
    pub fn calls(&self, context: Context, code: &Code<'_>, name: &str) -> u64 {
        let entry = code.entry(name);
        let is_entry = |spot: &&Spot| spot.context == context && Some(spot.address) == entry;
        self.counts.spots.iter().filter(is_entry).map(|spot| spot.count).sum()
    }

    /// The work of every function, the most first.
    pub fn functions(&self, code: &Code<'_>) -> Result<Vec<Function>> {
        let mut functions: BTreeMap<_, Work> = BTreeMap::new();
        for spot in self.counts.spots.iter().filter(|spot| spot.context != Context::Idle) {
            let name = code.author(spot.address, Room::of)?.function;
            *functions.entry((spot.context, spot.room, name)).or_default() += self.work_at(spot);
        }
        let mut functions: Vec<_> =
            functions.into_iter().map(|((context, room, name), work)| Function { context, room, name, work }).collect();
        functions.sort_by_key(|function| std::cmp::Reverse(function.work.instructions));
        Ok(functions)
    }

    fn work_at(&self, spot: &Spot) -> Work {
        let cost = |address: u64| self.costs.get(&address).filter(|cost| address + 2 * cost.length == spot.address);
        let is_behind_load = [2, 4].into_iter().filter_map(|back| cost(spot.address - back)).any(|cost| cost.is_load);
        let cycles = self.costs.get(&spot.address).map_or(1, |cost| {
            let saved = u64::from(cost.is_load && is_behind_load);
            cost.cycles - saved
        });
        Work { instructions: spot.count, cycles: spot.count * cycles + spot.taken * REFILL }
    }
}

/// Steps of all motors in a trace.
fn steps_in(trace: &Path) -> Result<u64> {
    let text = std::fs::read_to_string(trace).context("there is no trace")?;
    let rows = text.lines().skip(2);
    Ok(rows.map(|row| row.split(',').skip(1).filter(|step| *step != "0").count() as u64).sum())
}
