//! The commanded position: where the program has sent the tool, in its own coordinates, and the machine's offset from
//! it by a retraction or a pause.

use super::modal::{FARTHEST, Modal};
use super::retraction::{Retraction, RetractionMove, RetractionSettings};
use crate::gcode::{AxisWords, Number};
use crate::settings::Settings;
use crate::units::{Mm, MmPerSec, part_of};

/// The least length of filament that a program can command: half of the fifth decimal, the last that slicers write.
/// Sums of relative moves are off by less.
pub(in crate::machine) const LEAST_FILAMENT: Mm = Mm::lit("0.000005");

/// Where the program is.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Commanded {
    /// The commanded position of the machine: x, y, z as machine coordinates, e as filament that is really wanted.
    position: [Mm; 4],
    /// The program's origin, in machine coordinates (G92).
    origin: [Mm; 3],
    /// E as the program counts it.
    extrusion: Mm,
    /// The distance of the machine from it.
    retraction: Retraction,
    /// The distance by which a pause has moved it away in addition, where no line has moved it since.
    parked: [Mm; 4],
    /// A host has pulled filament back in the pause: its own script repeats the steps of the pause.
    has_taken_over: bool,
}

/// The target of a line of motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Wanted {
    /// Target in machine coordinates.
    pub position: [Mm; 4],
    /// E as the program will count it then.
    pub extrusion: Mm,
    /// Whether filament was commanded that must not move.
    pub is_held_back: bool,
    /// Whether the filament commanded in one move was above its limit; it is then left out.
    pub too_much: bool,
    /// Whether the target was farther away than any machine reaches, and lies at the farthest place now.
    pub is_too_far: bool,
}

impl Commanded {
    /// As after a reset, at `position`. The program counts more than the machine by the `offsets`.
    pub fn new(position: [Mm; 3], offsets: [Mm; 3]) -> Self {
        let [x, y, z] = position;
        Self {
            position: [x, y, z, Mm::ZERO],
            origin: offsets.map(|offset| -offset),
            extrusion: Mm::ZERO,
            retraction: Retraction::new(),
            parked: [Mm::ZERO; 4],
            has_taken_over: false,
        }
    }

    /// Where the program has sent the tool.
    pub const fn position(&self) -> [Mm; 4] {
        self.position
    }

    /// The program has sent the tool there.
    pub const fn go_to(&mut self, position: [Mm; 4]) {
        self.position = position;
    }

    /// E as the program counts it.
    pub const fn extrusion(&self) -> Mm {
        self.extrusion
    }

    /// The program counts E so.
    pub const fn count_extrusion(&mut self, extrusion: Mm) {
        self.extrusion = extrusion;
    }

    /// Where the machine goes for a commanded position.
    pub fn of_machine(&self, position: [Mm; 4]) -> [Mm; 4] {
        self.parked_from(self.retraction.away_from(position))
    }

    /// The same without a pause.
    pub fn of_print(&self, position: [Mm; 4]) -> [Mm; 4] {
        self.retraction.away_from(position)
    }

    fn parked_from(&self, [x, y, z, e]: [Mm; 4]) -> [Mm; 4] {
        let [px, py, pz, pe] = self.parked;
        [x.saturating_add(px), y.saturating_add(py), z.saturating_add(pz), e.wrapping_add(pe)]
    }

    /// The commanded position of a machine that stands there.
    fn of_program(&self, [x, y, z, e]: [Mm; 4]) -> [Mm; 4] {
        let [px, py, pz, pe] = self.parked;
        let unparked = [x.saturating_sub(px), y.saturating_sub(py), z.saturating_sub(pz), e.wrapping_sub(pe)];
        self.retraction.commanded(unparked)
    }

    /// A pause has taken the machine there.
    pub fn park_at(&mut self, machine: [Mm; 4]) {
        let ([x, y, z, e], [mx, my, mz, me]) = (self.of_print(self.position), machine);
        self.parked = [mx.saturating_sub(x), my.saturating_sub(y), mz.saturating_sub(z), me.wrapping_sub(e)];
    }

    /// The distance by which a pause has moved the machine away.
    pub const fn parked(&self) -> [Mm; 4] {
        self.parked
    }

    /// The machine is back where the print is, except for filament that is still pulled back.
    pub const fn unpark(&mut self, filament: Mm) {
        (self.parked, self.has_taken_over) = ([Mm::ZERO, Mm::ZERO, Mm::ZERO, filament], false);
    }

    /// A line is about to send the program to `to` in a pause. An axis that the line names goes to its place,
    /// independent of where it is parked. A host that pulls filament back has its own pause script, unless the line is
    /// a button's: the pause's retraction and lift already count for it.
    pub fn leave_park(&mut self, to: [Mm; 4], words: &AxisWords, modal: &Modal, may_be_script: bool) {
        let ([.., from_z, from_e], [.., to_z, to_e]) = (self.position, to);
        let [x, y, z, e] = &mut self.parked;
        let back = from_e.wrapping_sub(to_e);
        if may_be_script && back > Mm::ZERO && *e < Mm::ZERO {
            *e = e.saturating_add(back).min(Mm::ZERO);
            self.has_taken_over = true;
        }
        if !modal.absolute {
            let up = to_z.saturating_sub(from_z);
            if may_be_script && self.has_taken_over && up > Mm::ZERO {
                *z = z.saturating_sub(up).max(Mm::ZERO);
            }
            return;
        }
        for (parked, word) in [(x, words.x), (y, words.y), (z, words.z)] {
            if word.is_some() {
                *parked = Mm::ZERO;
            }
        }
    }

    /// The axis stands where its switch is: no pause has parked it.
    pub fn forget_park(&mut self, axis: usize) {
        if let Some(parked) = self.parked.get_mut(axis) {
            *parked = Mm::ZERO;
        }
    }

    /// The machine is where the program wants it: retractions and pauses are forgotten, and nothing moves.
    pub fn settle(&mut self) {
        self.position = self.of_machine(self.position);
        self.retraction = Retraction::new();
        self.unpark(Mm::ZERO);
    }

    /// A retraction is forgotten, and nothing moves.
    pub fn forget_retraction(&mut self) {
        self.position = self.retraction.away_from(self.position);
        self.retraction = Retraction::new();
    }

    /// The lift of the tool and the length of filament of a retraction.
    pub fn retracted(&self) -> [Mm; 2] {
        self.retraction.away()
    }

    /// Filament counts on from the position of `other`, without the amounts commanded here.
    pub const fn count_filament_as(&mut self, other: &Self) {
        let ([x, y, z, _], [.., e]) = (self.position, other.position);
        (self.position, self.parked, self.has_taken_over) = ([x, y, z, e], other.parked, other.has_taken_over);
    }

    /// The machine stands there, and that is where the program has sent it.
    pub fn stand_at(&mut self, machine: [Mm; 4]) {
        self.position = self.of_program(machine);
    }

    /// The machine was stopped there: filament that did not move does not count as commanded.
    pub fn fall_short(&mut self, machine: [Mm; 4]) {
        let real = self.of_program(machine);
        let [.., extrusion] = self.named(real);
        (self.extrusion, self.position) = (extrusion, real);
    }

    /// The moves of G10; `None` if they were made.
    pub fn moves_away(&self, settings: &RetractionSettings, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        self.retraction.moves_away(settings, z_speed)
    }

    /// The moves of G11; `None` without a retraction.
    pub fn moves_back(&self, settings: &RetractionSettings, z_speed: MmPerSec) -> Option<[RetractionMove; 2]> {
        self.retraction.moves_back(settings, z_speed)
    }

    /// Where the machine stands after a move of them.
    pub fn after(&self, step: RetractionMove) -> [Mm; 4] {
        self.parked_from(self.retraction.after(step, self.position))
    }

    /// That move is planned.
    pub const fn note_retraction(&mut self, step: RetractionMove) {
        self.retraction.note_planned(step);
    }

    /// Filament that was recovered in addition counts as commanded.
    pub fn take_extra(&mut self) {
        if let Some(extra) = self.retraction.take_extra() {
            let [_, _, _, e] = &mut self.position;
            *e = e.wrapping_add(extra);
        }
    }

    /// Where the words of a line lead. No filament moves if it `is_cold`; the program counts it all the same.
    pub fn target(&self, words: &AxisWords, modal: &Modal, settings: &Settings, is_cold: bool) -> Wanted {
        let mut is_too_far = false;
        let mut axis = |word: Option<Number>, at: Mm, origin: Mm| match word.map(|n| modal.length(n)) {
            None => at,
            Some(v) => {
                let target = if modal.absolute { origin.saturating_add(v) } else { at.saturating_add(v) };
                is_too_far |= !FARTHEST.holds(target);
                FARTHEST.clamp(target)
            }
        };
        let [x, y, z, e] = self.position;
        let [ox, oy, oz] = self.origin;
        let extrusion = match words.e.map(|n| modal.length(n)) {
            None => self.extrusion,
            Some(v) if modal.absolute && modal.absolute_extrusion => v,
            Some(v) => self.extrusion.saturating_add(v),
        };
        let asked = extrusion.saturating_sub(self.extrusion);
        let flow_percent = if modal.dry_run || is_cold { 0 } else { modal.flow_percent };
        let flow = Mm::from_bits(part_of(asked.to_bits(), u64::from(flow_percent), 100));
        let too_much = flow.saturating_abs() > settings.axes.e.length;
        Wanted {
            position: [
                axis(words.x, x, ox),
                axis(words.y, y, oy),
                axis(words.z, z, oz),
                if too_much { e } else { e.wrapping_add(flow) },
            ],
            extrusion,
            is_held_back: is_cold && asked.saturating_abs() >= LEAST_FILAMENT,
            too_much,
            is_too_far,
        }
    }

    /// Renames the present position to the given words (G92).
    pub fn rename(&mut self, words: &AxisWords, modal: &Modal) {
        let names = [words.x, words.y, words.z].map(|word| word.map(|n| FARTHEST.clamp(modal.length(n))));
        for ((origin, at), name) in self.origin.iter_mut().zip(self.position).zip(names) {
            if let Some(name) = name {
                *origin = at.saturating_sub(name);
            }
        }
        if let Some(e) = words.e {
            self.extrusion = modal.length(e);
        }
    }

    /// The program's zero moves by so much, and nothing else does.
    pub fn move_origin(&mut self, by: [Mm; 3]) {
        for (origin, by) in self.origin.iter_mut().zip(by) {
            *origin = origin.saturating_add(by);
        }
    }

    /// Z is at a place with another name by so much.
    pub fn sink(&mut self, by: Mm) {
        let [_, _, z, _] = &mut self.position;
        *z = z.saturating_sub(by);
    }

    /// All axes carry the machine's own zero again, but for their home offsets.
    pub fn forget_origins(&mut self, offsets: [Mm; 3]) {
        self.origin = offsets.map(|offset| -offset);
    }

    /// The axis carries the machine's own zero again, but for its home offset (G28).
    pub fn forget_origin(&mut self, axis: usize, offsets: [Mm; 3]) {
        if let (Some(origin), Some(offset)) = (self.origin.get_mut(axis), offsets.get(axis)) {
            *origin = -*offset;
        }
    }

    /// Where the program believes to be.
    pub fn named(&self, position: [Mm; 4]) -> [Mm; 4] {
        let [x, y, z, e] = position;
        let [ox, oy, oz] = self.origin;
        // Filament that was commanded but not moved, as the program counts it.
        let missing = self.position[3].wrapping_sub(e);
        [x - ox, y - oy, z - oz, self.extrusion.saturating_sub(missing)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(n, _)| n)
    }

    fn start() -> (Commanded, Modal, Settings) {
        (
            Commanded::new([Mm::from_num(10), Mm::from_num(20), Mm::from_num(5)], [Mm::ZERO; 3]),
            Modal::new(),
            Settings::prototype(),
        )
    }

    fn words(x: &str, e: &str) -> AxisWords {
        AxisWords { x: number(x), e: number(e), ..AxisWords::default() }
    }

    #[test]
    fn relative_extrusion_needs_only_one_of_its_two_switches() {
        let (mut c, mut m, s) = start();
        c.extrusion = Mm::from_num(7);
        assert_eq!(c.target(&words("1", "8"), &m, &s, false).extrusion, Mm::from_num(8));
        m.absolute_extrusion = false;
        assert_eq!(c.target(&words("1", "8"), &m, &s, false).extrusion, Mm::from_num(15));
        m.absolute_extrusion = true;
        m.absolute = false;
        assert_eq!(c.target(&words("1", "8"), &m, &s, false).extrusion, Mm::from_num(15));
        assert_eq!(c.target(&words("1", "8"), &m, &s, false).position[0], Mm::from_num(11));
    }

    #[test]
    fn flow_stretches_the_filament_but_not_the_program_count() {
        let (c, mut m, s) = start();
        m.flow_percent = 150;
        let w = c.target(&words("1", "2"), &m, &s, false);
        assert_eq!((w.extrusion, w.position[3]), (Mm::from_num(2), Mm::from_num(3)));
    }

    #[test]
    fn a_new_name_moves_nothing() {
        let (mut c, m, s) = start();
        c.rename(&words("0", "0"), &m);
        assert_eq!(c.position[0], Mm::from_num(10));
        assert_eq!(c.target(&words("5", ""), &m, &s, false).position[0], Mm::from_num(15));
        assert_eq!(c.named(c.position)[0], Mm::ZERO);
    }

    #[test]
    fn inches_are_exact_and_huge_numbers_end_at_the_farthest_place() {
        let (c, mut m, s) = start();
        m.inches = true;
        assert_eq!(c.target(&words("5", ""), &m, &s, false).position[0], Mm::from_num(127));
        assert_eq!(c.target(&words("999999999999", ""), &m, &s, false).position[0], Mm::from_num(10_000));
        assert!(c.target(&words("999999999999", ""), &m, &s, false).is_too_far);
        assert!(c.target(&words("1", "99999"), &m, &s, false).too_much);
        assert!(!c.target(&words("1", "99999"), &m, &s, false).is_too_far);
    }
}
