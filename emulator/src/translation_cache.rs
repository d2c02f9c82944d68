//! A core that reuses the translation of another.
//!
//! The crate translates the image block by block while it runs, which is most of the time of a short run. A core keeps
//! its translation until it is dropped, and discards it when it is reset or its MPU is set. So a run begins on a new
//! core. As soon as the image has its MPU on, the state moves to a core of an earlier run with the same MPU settings.
//!
//! The crate allows for that: a loaded state keeps the translation of unchanged memory, and changed memory is named to
//! the core ([`Processor::load`]). The core of a run that has ended, or was reset, is kept for others, on memory of its
//! own.
//!
//! The run is the same to the instruction, with a kept translation and without.
//!
//! This rests on two things in the crate's version 0.4.0, to which Cargo.toml pins it. A core with newly mapped memory
//! forgets the previous address of that memory, and its generated code holds no addresses of it. It also misses two
//! things, which the emulator does not do: watched memory (`Watch::Writes`), and code written at the stop that ends a
//! run.
#![allow(unsafe_code, reason = "a core has its memory by its address in this process")]

use crate::decoder::Decoder;
use rigless::emulator::{CoreBus, CoreSpec, DataModel, Error, Exit, HostCall, Processor, ProcessorConstructor, Queued};
use rigless::soc::{Endian, Width};
use rigless::time::VirtualNanos;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::mem::ManuallyDrop;
use std::ptr;
use std::sync::{Arc, Mutex, PoisonError};

/// MPU_CTRL and its ENABLE (PM0214 rev 10, section 4.2.6).
const MPU_CONTROL: u64 = 0xE000_ED94;
const IS_ON: u64 = 1;

/// The unit of comparison, translated again if it differs: a page of the crate's cores, and the alignment of memory.
const PAGE: usize = 1024;

/// Pages of flash in which another image may differ and still be taken for the same. Flash is mapped twice, at 0 too,
/// so the settings of the Nucleo are 64, and a machine or a patch a few more. Of two different images 700 differ.
const MOST_DIFFERENT: usize = 160;

/// Cores of ended runs.
static KEPT: Mutex<Vec<Kept>> = Mutex::new(Vec::new());

/// Shares translations between the cores of a part. All parts must have the same core.
pub fn share_translations(spec: &mut CoreSpec) {
    let make = spec.processor.clone();
    spec.processor = Arc::new(move |endian| Ok(Box::new(Core::new(make.clone(), endian)?)));
}

/// As many bytes as a core's page, which begin where a page may.
#[derive(Clone, Debug)]
#[repr(C, align(1024))]
struct Page([u8; PAGE]);

/// Memory of the run that a core knows the address of.
#[derive(Clone, Copy, Debug)]
struct Mapped {
    start: u64,
    length: usize,
    host: usize,
    is_writable: bool,
}

impl Mapped {
    fn address(self) -> *mut u8 {
        ptr::with_exposed_provenance_mut(self.host)
    }

    /// # Safety
    /// The run has not ended, and its memory must not be written while the slice lives.
    unsafe fn bytes(&self) -> &[u8] {
        // SAFETY: the code that maps it promises this many bytes until the core is dropped (`Processor::map`).
        unsafe { std::slice::from_raw_parts(self.address(), self.length) }
    }
}

/// A core between two runs, or before the same run needs it again.
#[derive(Debug)]
struct Kept {
    core: Box<dyn Processor>,
    /// The memory that it was translated from; the core is dropped first.
    memory: Vec<(Mapped, Vec<Page>)>,
}

impl Kept {
    /// Takes a core from the run that has this memory.
    ///
    /// # Safety
    /// The run has not ended.
    unsafe fn new(mut core: Box<dyn Processor>, memory: &[Mapped]) -> Self {
        let copy = |mapped: &Mapped| {
            let mut pages = vec![Page([0; PAGE]); mapped.length.div_ceil(PAGE)];
            let host = pages.as_mut_ptr().cast::<u8>();
            // SAFETY: both have this many bytes, one by the caller's promise. `pages` moves with its owner, its bytes
            // stay in place, and no other reference to them exists. The core is mapped to other memory, or dropped,
            // before they are.
            unsafe {
                ptr::copy_nonoverlapping(mapped.address(), host, mapped.length);
                core.map(mapped.start, mapped.length as u64, host, mapped.is_writable);
            }
            (Mapped { host: host.expose_provenance(), ..*mapped }, pages)
        };
        let memory = memory.iter().map(copy).collect();
        Self { core, memory }
    }

    /// Pages of a run's memory, of the wanted kind, that differ from this core's; `None` if the run has a different
    /// memory layout.
    ///
    /// # Safety
    /// As of [`Mapped::bytes`].
    unsafe fn differing(&self, memory: &[Mapped], is_wanted: fn(&Mapped) -> bool) -> Option<Vec<u64>> {
        if memory.len() != self.memory.len() {
            return None;
        }
        let mut differing = Vec::new();
        for (now, (then, _)) in memory.iter().zip(&self.memory) {
            if (now.start, now.length, now.is_writable) != (then.start, then.length, then.is_writable) {
                return None;
            }
            if !is_wanted(now) {
                continue;
            }
            // SAFETY: the caller's promise for one, and the other is this one's own.
            let (now_bytes, then_bytes) = unsafe { (now.bytes(), then.bytes()) };
            let pages = now_bytes.chunks(PAGE).zip(then_bytes.chunks(PAGE)).zip((now.start..).step_by(PAGE));
            differing.extend(pages.filter(|((now, then), _)| now != then).map(|(_, start)| start));
        }
        Some(differing)
    }
}

/// Keeps a core for runs to come.
fn keep(core: Kept) {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).push(core);
}

/// The core that was kept with the most similar flash, if it is similar enough, and all pages that differ.
///
/// # Safety
/// As of [`Mapped::bytes`].
unsafe fn take(memory: &[Mapped]) -> Option<(Kept, Vec<u64>)> {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: the caller's promise.
    let differing =
        |core: &Kept| unsafe { core.differing(memory, |mapped| !mapped.is_writable) }.map(|pages| pages.len());
    let all = kept.iter().enumerate().filter_map(|(place, core)| Some((differing(core)?, place)));
    let (_, place) = all.filter(|(pages, _)| *pages <= MOST_DIFFERENT).min()?;
    let core = kept.swap_remove(place);
    // SAFETY: the caller's promise.
    let changed = unsafe { core.differing(memory, |_| true) }?;
    Some((core, changed))
}

/// How a core is made.
struct Make(ProcessorConstructor, Endian);

impl Make {
    fn core(&self) -> Result<Box<dyn Processor>, Error> {
        (self.0)(self.1)
    }
}

impl fmt::Debug for Make {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Make").field(&self.1).finish()
    }
}

/// The core of a run.
#[derive(Debug)]
struct Core {
    core: ManuallyDrop<Box<dyn Processor>>,
    make: Make,
    /// Its MPU is not on yet.
    is_cold: bool,
    memory: Vec<Mapped>,
    breakpoints: BTreeMap<u64, u32>,
    /// The next instruction runs in spite of its breakpoint.
    is_passing: bool,
    /// Pages with accesses that go to the bus.
    routed: BTreeSet<u64>,
}

impl Core {
    fn new(make: ProcessorConstructor, endian: Endian) -> Result<Self, Error> {
        let make = Make(make, endian);
        Ok(Self {
            core: ManuallyDrop::new(make.core()?),
            make,
            is_cold: true,
            memory: Vec::new(),
            breakpoints: BTreeMap::new(),
            is_passing: false,
            routed: BTreeSet::new(),
        })
    }

    /// Gives another core the memory of the run, and repeats the run's requests on it.
    fn ask_again(&self, core: &mut dyn Processor) {
        for mapped in &self.memory {
            // SAFETY: the run's promise to this core holds for the other one, which will take its place or be dropped
            // at once.
            unsafe { core.map(mapped.start, mapped.length as u64, mapped.address(), mapped.is_writable) };
        }
        for (&address, &times) in &self.breakpoints {
            for _ in 0..times {
                core.add_breakpoint(address);
            }
        }
        for &page in &self.routed {
            core.ask(Queued::Route(page));
        }
    }

    /// Takes a core out of the run.
    fn release(&self, mut core: Box<dyn Processor>) -> Kept {
        for (&address, &times) in &self.breakpoints {
            for _ in 0..times {
                core.remove_breakpoint(address);
            }
        }
        for &page in &self.routed {
            core.ask(Queued::Unroute(page));
        }
        // SAFETY: the run has not ended, because this is not dropped, and no other code runs in between.
        unsafe { Kept::new(core, &self.memory) }
    }

    /// Continues with a core that has translated this image, if there is one.
    fn warm_up(&mut self) -> Result<(), Error> {
        self.is_cold = false;
        // SAFETY: as in `release`.
        let Some((kept, changed)) = (unsafe { take(&self.memory) }) else { return Ok(()) };
        let (_memory, mut core) = (kept.memory, kept.core);
        self.ask_again(&mut *core);
        for page in changed {
            core.ask(Queued::Invalidate(page, page + PAGE as u64));
        }
        core.load(&self.core.save())?;
        // Clears requests of its last run.
        core.take_reset_request();
        *self.core = core;
        Ok(())
    }

    /// Restarts on another core, and keeps this one as it is.
    fn restart(&mut self) -> Result<(), Error> {
        let mut core = self.make.core()?;
        self.ask_again(&mut *core);
        core.load(&self.core.save())?;
        core.reset();
        let old = std::mem::replace(&mut *self.core, core);
        self.is_cold = true;
        keep(self.release(old));
        Ok(())
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        // SAFETY: it is not used after this.
        let core = unsafe { ManuallyDrop::take(&mut self.core) };
        if !self.is_cold && !std::thread::panicking() {
            keep(self.release(core));
        }
    }
}

/// All that a run without a debugger asks of a core of this family.
impl Processor for Core {
    fn run(&mut self, budget: u32, bus: &mut dyn CoreBus) -> (Exit, u64) {
        let is_passing = std::mem::take(&mut self.is_passing);
        if self.is_cold && !is_passing {
            let control = self.core.debugger_access(None, MPU_CONTROL, Width::W32, VirtualNanos(0));
            // If the other core does not take the state, the run continues with its own.
            if control.is_some_and(|control| control & IS_ON != 0) {
                self.warm_up().ok();
            }
        }
        self.core.run(budget, &mut Decoder(bus))
    }

    fn retired(&self) -> u64 {
        self.core.retired()
    }

    fn ask(&mut self, queued: Queued) {
        match queued {
            Queued::Route(page) => drop(self.routed.insert(page)),
            Queued::Unroute(page) => drop(self.routed.remove(&page)),
            Queued::Line(..) | Queued::Invalidate(..) | Queued::Return => {}
        }
        self.core.ask(queued);
    }

    fn maps(&self, start: u64, length: u64) -> bool {
        self.core.maps(start, length)
    }

    fn page_size(&self) -> u64 {
        self.core.page_size()
    }

    unsafe fn map(&mut self, start: u64, length: u64, host: *mut u8, is_writable: bool) {
        self.memory.push(Mapped { start, length: length as usize, host: host.expose_provenance(), is_writable });
        // SAFETY: the caller's promise.
        unsafe { self.core.map(start, length, host, is_writable) };
    }

    fn boot(&mut self, table: u64, read: &dyn Fn(u64, Width) -> Option<u64>) {
        self.core.boot(table, read);
    }

    fn reset(&mut self) {
        if self.is_cold || self.restart().is_err() {
            self.core.reset();
        }
    }

    fn take_reset_request(&mut self) -> bool {
        self.core.take_reset_request()
    }

    fn next_event(&self) -> Option<VirtualNanos> {
        self.core.next_event()
    }

    fn on_event(&mut self, now: VirtualNanos) {
        self.core.on_event(now);
    }

    fn waiting(&self) -> bool {
        self.core.waiting()
    }

    fn pc(&self) -> u64 {
        self.core.pc()
    }

    fn add_breakpoint(&mut self, address: u64) -> bool {
        let can_stop = self.core.add_breakpoint(address);
        if can_stop {
            *self.breakpoints.entry(address).or_default() += 1;
        }
        can_stop
    }

    fn remove_breakpoint(&mut self, address: u64) {
        if let Some(times) = self.breakpoints.get_mut(&address) {
            *times = times.saturating_sub(1);
        }
        self.core.remove_breakpoint(address);
    }

    fn pass_breakpoint(&mut self, address: u64) {
        self.is_passing = true;
        self.core.pass_breakpoint(address);
    }

    fn host_call(&self, read: &mut dyn FnMut(u64, Width) -> Option<u64>) -> Option<HostCall> {
        self.core.host_call(read)
    }

    fn answer_host_call(&mut self, answer: Option<u64>) {
        self.core.answer_host_call(answer);
    }

    fn data_model(&self) -> DataModel {
        self.core.data_model()
    }

    fn byte_order(&self, address: u64) -> Endian {
        self.core.byte_order(address)
    }

    fn save(&self) -> Vec<u8> {
        self.core.save()
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.core.load(bytes)
    }
}

#[cfg(test)]
#[path = "warm_tests.rs"]
mod tests;
