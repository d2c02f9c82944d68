//! Trimming: where the tool stands while one motor of the belt is turned alone, and whether the motors of one belt
//! agree.

use crate::port::MotorSet;
use crate::settings::PHASES;
use crate::units::{Mm, Steps};

/// Number of residuals with a kept finding.
const RESIDUALS: usize = PHASES;

/// The finding for a residual when the motors were aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Found {
    /// The strain found, in mm of belt.
    pub was: Mm,
    /// The largest error that may remain, in mm of belt.
    pub within: Mm,
    /// The fall of the load that drivers measure (SG_RESULT) for a mm of strain, if they measured it.
    pub readings_per_mm: Option<u16>,
    /// The phase at which nothing strains the belt (`main_loop::phase`), if it is known.
    pub phase: Option<u16>,
    /// The loads contradict each other: something drags.
    pub is_contradicted: bool,
}

/// The known state of motors that can pull against each other.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Trimming {
    /// Where the tool stands, in steps of x, y, z and e.
    held: [Steps; 4],
    is_aligned: bool,
    /// Drivers measure loads, and are configured for that.
    is_measuring: bool,
    /// Motors that have power for a buzz, without others of their belt.
    buzzing: MotorSet,
    /// A phase of the belt was found that settings had not.
    has_new_phase: bool,
    found: [Option<Found>; RESIDUALS],
    /// The fall of the load per mm of strain of each residual when nothing dragged; 0 is not known.
    loads: [u16; RESIDUALS],
    /// Those are not noted in storage.
    has_new_loads: bool,
    /// Total distance in steps by which homing x and y since the alignment has corrected the position.
    homed_aside: [i32; 2],
}

impl Trimming {
    /// Nothing is known.
    pub const fn new() -> Self {
        Self {
            held: [Steps::ZERO; 4],
            is_aligned: false,
            is_measuring: false,
            buzzing: MotorSet::NONE,
            has_new_phase: false,
            found: [None; RESIDUALS],
            loads: [0; RESIDUALS],
            has_new_loads: false,
            homed_aside: [0; 2],
        }
    }

    /// A motor takes the place of z while the tool stands there.
    pub const fn begin(&mut self, held: [Steps; 4]) {
        self.held = held;
    }

    /// The position of the tool during the trim.
    pub const fn held(&self) -> [Steps; 4] {
        self.held
    }

    /// Whether the motors are known to agree.
    pub const fn is_aligned(&self) -> bool {
        self.is_aligned
    }

    /// They agree within the findings.
    pub const fn align(&mut self) {
        (self.is_aligned, self.homed_aside) = (true, [0; 2]);
    }

    /// An axis was homed: its switch was this many steps from its expected place.
    pub fn note_homed(&mut self, axis: usize, aside: i32) {
        if let Some(sum) = self.homed_aside.get_mut(axis).filter(|_| self.is_aligned) {
            *sum = sum.saturating_add(aside);
        }
    }

    /// Total distance in steps by which homing x and y since the alignment has corrected the position.
    pub const fn homed_aside(&self) -> [i32; 2] {
        self.homed_aside
    }

    /// Alignment is unknown from now on.
    pub const fn forget(&mut self) {
        (self.is_aligned, self.found) = (false, [None; RESIDUALS]);
    }

    /// Notes the finding for a residual, by its number.
    pub fn note(&mut self, number: usize, found: Found) {
        if let Some(place) = self.found.get_mut(number) {
            *place = Some(found);
        }
    }

    /// The proof of a residual's finding: the fall of the load per mm, and the bound if loads contradict each other.
    pub fn prove(&mut self, number: usize, within: Option<Mm>, readings_per_mm: u16) {
        if let Some(found) = self.found.get_mut(number).and_then(Option::as_mut) {
            found.is_contradicted |= within.is_some();
            found.within = within.map_or(found.within, |within| within.max(found.within));
            found.readings_per_mm = Some(readings_per_mm);
        }
    }

    /// The loads that storage knows.
    pub const fn know_loads(&mut self, loads: [u16; RESIDUALS]) {
        self.loads = loads;
    }

    /// The known fall of the load of a residual, if this one is another one: by a quarter. Chance and the place of the
    /// apex make less than a sixth (measured on the belt plant).
    pub fn other_load(&self, number: usize, now: u16) -> Option<u16> {
        let is_other = |before: u16| {
            let (now, before) = (u32::from(now), u32::from(before));
            before > 0 && (4 * now > 5 * before || 5 * now < 4 * before)
        };
        self.loads.get(number).copied().filter(|before| is_other(*before))
    }

    /// A proved fall of the load of a residual counts from now on, if none was known or it is another one.
    pub fn keep_load(&mut self, number: usize, now: u16) {
        let is_other = self.other_load(number, now).is_some();
        if let Some(known) = self.loads.get_mut(number).filter(|known| is_other || **known == 0) {
            (*known, self.has_new_loads) = (now, true);
        }
    }

    /// The loads that storage does not know.
    pub fn take_new_loads(&mut self) -> Option<[u16; RESIDUALS]> {
        core::mem::take(&mut self.has_new_loads).then_some(self.loads)
    }

    /// Whether they agree by their phases alone: no load was measured since they got power.
    pub fn is_by_phases(&self) -> bool {
        self.found.iter().flatten().any(|found| found.readings_per_mm.is_none())
    }

    /// The finding for a residual.
    pub fn found(&self, number: usize) -> Option<Found> {
        self.found.get(number).copied().flatten()
    }

    /// A phase of the belt was found that settings had not, or none.
    pub const fn note_phase(&mut self, is_new: bool) {
        self.has_new_phase = is_new;
    }

    /// Whether one was when motors were last aligned.
    pub const fn has_new_phase(&self) -> bool {
        self.has_new_phase
    }

    /// These motors have power for a buzz.
    pub fn begin_buzz(&mut self, motors: MotorSet) {
        self.buzzing = self.buzzing.with(motors);
    }

    /// The buzz is over. Returns the motors that had power for it.
    pub const fn end_buzz(&mut self) -> MotorSet {
        core::mem::replace(&mut self.buzzing, MotorSet::NONE)
    }

    /// Drivers are configured to measure loads, or no more.
    pub const fn measure(&mut self, on: bool) {
        self.is_measuring = on;
    }

    /// Whether they are.
    pub const fn is_measuring(&self) -> bool {
        self.is_measuring
    }
}
