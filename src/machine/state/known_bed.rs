//! What is known of the bed: its mesh, and the area that the print needs.

use crate::gcode::Number;
use crate::settings::Range;
use crate::storage::StoredMesh;
use crate::surface::Mesh;
use crate::units::Mm;

/// The mesh, where it is from, and whether it is kept.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct KnownBed {
    mesh: Option<StoredMesh>,
    /// It covers a part of the bed only, so it is not kept over a whole one.
    is_part: bool,
    /// M500 has kept it, or it was taken from there.
    is_kept: bool,
    /// M500 forgets the kept mesh, since the present one was forgotten for good.
    forgets_kept: bool,
}

impl KnownBed {
    /// Nothing.
    pub const fn new() -> Self {
        Self { mesh: None, is_part: false, is_kept: false, forgets_kept: false }
    }

    /// The mesh.
    pub const fn mesh(&self) -> Option<&StoredMesh> {
        self.mesh.as_ref()
    }

    /// A mesh was measured.
    pub const fn know(&mut self, mesh: StoredMesh, is_part: bool) {
        *self = Self { mesh: Some(mesh), is_part, is_kept: false, forgets_kept: false };
    }

    /// The mesh was changed, if it can be so.
    pub const fn change(&mut self, changed: Option<&Mesh>) {
        if let (Some(known), Some(changed)) = (&mut self.mesh, changed) {
            known.mesh = *changed;
        }
        (self.is_kept, self.forgets_kept) = (false, false);
    }

    /// A kept mesh was taken.
    pub const fn take_kept(&mut self, mesh: StoredMesh) {
        *self = Self { mesh: Some(mesh), is_part: false, is_kept: true, forgets_kept: false };
    }

    /// Its points are elsewhere by so much; false if there are none. M500 moves a kept one in storage, if it is right
    /// with all other settings.
    pub fn moves(&mut self, by: [Mm; 2]) -> bool {
        if let Some(mesh) = &mut self.mesh {
            *mesh = mesh.moved(by);
        }
        self.mesh.is_some()
    }

    /// It has been kept.
    pub const fn note_kept(&mut self) {
        self.is_kept = true;
    }

    /// The mesh to keep, if there is one that is not kept yet and covers the bed.
    pub const fn unsaved(&self) -> Option<&StoredMesh> {
        if self.is_kept || self.is_part { None } else { self.mesh.as_ref() }
    }

    /// Whether it covers a part of the bed only.
    pub const fn is_part(&self) -> bool {
        self.is_part
    }

    /// It is forgotten, and the kept one with the next M500 if so.
    pub const fn forget(&mut self, forgets_kept: bool) {
        *self = Self { forgets_kept, ..Self::new() };
    }

    /// Whether the next M500 forgets the kept mesh.
    pub const fn forgets_kept(&self) -> bool {
        self.forgets_kept
    }
}

/// The area that the objects of the print need.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct PrintArea {
    bounds: Option<[Range<Mm>; 2]>,
    /// The outline of an object was cut, so its bounds are not known.
    is_cut: bool,
    /// The next mesh is to cover no more (M555).
    is_next: bool,
}

impl PrintArea {
    /// Nothing is known.
    pub const NONE: Self = Self { bounds: None, is_cut: false, is_next: false };

    /// The area of the print, in which the next mesh is measured.
    pub fn of(least: [Mm; 2], most: [Mm; 2]) -> Self {
        let mut area = Self { is_next: true, ..Self::NONE };
        area.add(least);
        area.add(most);
        area
    }

    /// The area of a mesh that names none: once, what M555 has said.
    pub fn take_next(&mut self) -> Option<[Range<Mm>; 2]> {
        let is_next = core::mem::replace(&mut self.is_next, false);
        self.bounds().filter(|_| is_next)
    }

    /// Whether objects were named, and an outline came cut.
    pub const fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The area, in x and y.
    pub const fn bounds(&self) -> Option<[Range<Mm>; 2]> {
        if self.is_cut { None } else { self.bounds }
    }

    /// It contains this place too.
    pub fn add(&mut self, place: [Mm; 2]) {
        let mut bounds = self.bounds.unwrap_or(place.map(|at| Range { least: at, most: at }));
        for (side, at) in bounds.iter_mut().zip(place) {
            (side.least, side.most) = (side.least.min(at), side.most.max(at));
        }
        self.bounds = Some(bounds);
    }

    /// It contains this object too. Outlines are in mm.
    pub fn add_object(&mut self, outline: &[u8]) {
        let count = |byte: u8| outline.iter().filter(|other| **other == byte).count();
        self.is_cut |= count(b'[') != count(b']');
        places(outline).for_each(|place| self.add(place.map(|number: Number| Mm::saturating_from_num(number.value()))));
    }
}

/// The pairs of numbers in the outline of an object: `[[5,5],[15,5]]`, or `10,10`. It ends at a blank outside of
/// brackets.
fn places(outline: &[u8]) -> impl Iterator<Item = [Number; 2]> + '_ {
    let mut left = outline;
    let mut depth = 0;
    let mut next = move || {
        loop {
            let (&byte, rest) = left.split_first()?;
            match byte {
                b'[' => depth += 1,
                b']' => depth -= 1,
                b' ' | b'\t' if depth <= 0 => return None,
                b'-' | b'+' | b'.' | b'0'..=b'9' => {
                    let (number, behind) = Number::read(left)?;
                    left = behind;
                    return Some(number);
                }
                _ => {}
            }
            left = rest;
        }
    };
    core::iter::from_fn(move || Some([next()?, next()?]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(area: &PrintArea) -> Option<[[i32; 2]; 2]> {
        area.bounds().map(|bounds| bounds.map(|side| [side.least, side.most].map(Mm::to_num)))
    }

    #[test]
    fn the_area_contains_all_objects() {
        let mut area = PrintArea::NONE;
        assert_eq!(ends(&area), None);
        area.add_object(b"[[150,180],[230,180],[230,215],[150,215]]");
        assert_eq!(ends(&area), Some([[150, 230], [180, 215]]));
        area.add_object(b"[[ -5, 200 ], [10 ,300]] NAME=x1");
        assert_eq!(ends(&area), Some([[-5, 230], [180, 300]]));
        area.add_object(b"400,10 NAME=7,9");
        assert_eq!(ends(&area), Some([[-5, 400], [10, 300]]));
        area.add_object(b"[[500,10],[50");
        assert_eq!(ends(&area), None, "an outline that was cut may lie anywhere");
    }
}
