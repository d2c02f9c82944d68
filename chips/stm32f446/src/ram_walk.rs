//! The RAM walk: whether each bit of the RAM keeps both values, and each address is one of its own.
//!
//! All of the RAM is walked before anything starts, and then again and again, some rows in each control period. A row
//! gets a pattern and its inverse, is read back, and gets its words back. Nothing may interrupt that, not even a step:
//! it takes some 60 cycles, a third of a microsecond.
//!
//! While the firmware runs, rows of DMA buffers are left out. A byte that arrived meanwhile would be lost.

use core::arch::asm;
use core::fmt::Write as _;
use core::ops::Range;
use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::fault::Cause;
use heapless::String;

use crate::stack_guard::{RAM_SIZE, usable};
use crate::{accelerometer, fault, thermistors, usart};

/// Bytes of a row: four words.
const ROW: u32 = 16;

/// Rows in a control period: all of the RAM in 10.2 s.
const ROWS: u32 = 16;

/// The pattern; its inverse gives each bit the other value, and each bit's neighbours are its opposites.
const PATTERN: u32 = 0x5555_5555;

/// Lines of the address that choose a row.
const LINES: Range<u32> = ROW.ilog2()..RAM_SIZE.ilog2();

/// The row that comes next.
static NEXT: AtomicU32 = AtomicU32::new(0);

/// Walks all of it; returns a row that does not keep its bits. The DMA is at rest.
pub fn walk_all() -> Option<u32> {
    let mut rows = usable().step_by(ROW as usize);
    rows.find(|row| !keeps_bits(*row)).or_else(|| ends().into_iter().find(|row| !is_apart(*row)))
}

/// Walks the next rows. A bad one ends the firmware: heaters low, drivers off, reset.
pub fn walk_on() {
    let all = usable();
    for _ in 0..ROWS {
        let next = NEXT.load(Ordering::Relaxed);
        let row = if all.contains(&next) { next } else { all.start };
        NEXT.store(row + ROW, Ordering::Relaxed);
        if is_of_dma(row) {
            continue;
        }
        if !keeps_bits(row) || (ends().contains(&row) && !is_apart(row)) {
            give_up(row);
        }
    }
}

/// The first and the last row: together they have each line of the address at both levels.
fn ends() -> [u32; 2] {
    let all = usable();
    [all.start, all.end - ROW]
}

#[cold]
fn give_up(row: u32) -> ! {
    let mut reason: String<64> = String::new();
    // It fits.
    let _ = write!(reason, "memory at {row:08x} does not keep its bits");
    fault::give_up(Cause::SettingsDamaged, &reason)
}

/// Whether a row has bytes that the DMA reads or writes.
fn is_of_dma(row: u32) -> bool {
    let [one, two] = usart::buffers();
    let [sent, heard] = accelerometer::buffers();
    [thermistors::buffer(), one, two, sent, heard]
        .into_iter()
        .any(|buffer| row < buffer.end && buffer.start < row + ROW)
}

/// Whether a row differs from all rows that one line of the address tells from it.
fn is_apart(row: u32) -> bool {
    let others = LINES.map(|line| row ^ 1 << line).filter(|other| usable().contains(other) && !is_of_dma(*other));
    others.into_iter().all(|other| is_apart_from(row, other))
}

/// Writes a pattern and its inverse to the four words of a row, and reads them back.
#[inline(never)]
fn keeps_bits(row: u32) -> bool {
    let bad: u32;
    // SAFETY: the row is RAM that all code may access (`usable`), and has its words back before anything else runs. The
    // mask is as it was before. Nothing is pushed meanwhile.
    unsafe {
        asm!(
            "mrs {mask}, PRIMASK",
            "cpsid i",
            "ldrd {a}, {b}, [{row}]",
            "ldrd {c}, {d}, [{row}, #8]",
            "strd {p}, {n}, [{row}]",
            "strd {p}, {n}, [{row}, #8]",
            "ldrd {s}, {bad}, [{row}]",
            "eors {s}, {p}",
            "eors {bad}, {n}",
            "orrs {bad}, {s}",
            "ldr {s}, [{row}, #8]",
            "eors {s}, {p}",
            "orrs {bad}, {s}",
            "ldr {s}, [{row}, #12]",
            "eors {s}, {n}",
            "orrs {bad}, {s}",
            "strd {n}, {p}, [{row}]",
            "strd {n}, {p}, [{row}, #8]",
            "ldr {s}, [{row}]",
            "eors {s}, {n}",
            "orrs {bad}, {s}",
            "ldr {s}, [{row}, #4]",
            "eors {s}, {p}",
            "orrs {bad}, {s}",
            "ldr {s}, [{row}, #8]",
            "eors {s}, {n}",
            "orrs {bad}, {s}",
            "ldr {s}, [{row}, #12]",
            "eors {s}, {p}",
            "orrs {bad}, {s}",
            "strd {a}, {b}, [{row}]",
            "strd {c}, {d}, [{row}, #8]",
            "msr PRIMASK, {mask}",
            row = in(reg) row,
            p = in(reg) PATTERN,
            n = in(reg) !PATTERN,
            a = out(reg) _,
            b = out(reg) _,
            c = out(reg) _,
            d = out(reg) _,
            s = out(reg) _,
            mask = out(reg) _,
            bad = out(reg) bad,
        );
    }
    bad == 0
}

/// Whether a word keeps its value while that of another row changes.
#[inline(never)]
fn is_apart_from(row: u32, other: u32) -> bool {
    let seen: u32;
    // SAFETY: as in `keeps_bits`, for both rows.
    unsafe {
        asm!(
            "mrs {mask}, PRIMASK",
            "cpsid i",
            "ldr {a}, [{row}]",
            "ldr {b}, [{other}]",
            "str {p}, [{row}]",
            "str {n}, [{other}]",
            "ldr {seen}, [{row}]",
            "str {b}, [{other}]",
            "str {a}, [{row}]",
            "msr PRIMASK, {mask}",
            row = in(reg) row,
            other = in(reg) other,
            p = in(reg) PATTERN,
            n = in(reg) !PATTERN,
            a = out(reg) _,
            b = out(reg) _,
            seen = out(reg) seen,
            mask = out(reg) _,
        );
    }
    seen == PATTERN
}
