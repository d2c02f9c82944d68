//! Line types: the tool's errors apart for each type of line that the slicer names, for all printed lines, and for
//! travel.
//!
//! Of each type the root of the mean square counts, the greatest error with its place, and the error that 99.9 % of the
//! time does not exceed. The latter comes from classes of errors that are 1.6 % wide at most, so no error is kept.

use crate::steps::LineType;
use serde::Serialize;

/// A line that belongs to no type: the tool stands, or a switch ended the move before.
pub const NO_TYPE: u16 = u16::MAX;

/// Part of the time in which the error is at most the one that is told.
const MOSTLY: f64 = 0.999;

/// Name of all types together that are a part of the print.
const ALL_PRINTED: &str = "all printed lines";

/// Bits of a number's mantissa that make classes: 64 an octave.
const CLASS_BITS: u32 = 6;

/// The lowest class ends at this error in mm, 0.06 nm, and the highest begins 32 octaves above it.
const LEAST_MM: f64 = 1.0 / (1 << 24) as f64;
const CLASSES: usize = 32 << CLASS_BITS;

/// Errors on the lines of each type.
#[derive(Clone, Debug, Default)]
pub struct LineTypes {
    types: Vec<LineType>,
    /// The type of the line that ends at each vertex.
    of_lines: Vec<u16>,
    spreads: Vec<Spread>,
}

/// Errors on the lines of a type.
#[derive(Clone, Debug, Default)]
struct Spread {
    squares: f64,
    samples: u64,
    greatest: Worst,
    classes: Vec<u32>,
}

/// The greatest error: in mm, the tick and the place in mm.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    mm: f64,
    tick: u64,
    at: [f64; 2],
}

/// Errors on the lines of a type, to be told.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypeErrors {
    /// Its name.
    pub name: String,
    /// Whether its lines are a part of the print.
    pub is_printed: bool,
    /// Samples of the tool on them.
    #[serde(skip)]
    pub samples: u64,
    /// Root of the mean square over time.
    pub rms_um: f64,
    /// Not exceeded for 99.9 % of the time.
    pub mostly_um: f64,
    /// Largest.
    pub max_um: f64,
    /// Where it is largest, from motor 1's axis.
    pub x_mm: f64,
    /// The same away from the front.
    pub y_mm: f64,
    /// The tick at which it is largest.
    #[serde(skip)]
    pub tick: u64,
}

impl LineTypes {
    /// All types, and the type of the line that ends at each vertex.
    #[must_use]
    pub fn new(types: Vec<LineType>, of_lines: Vec<u16>) -> Self {
        Self { spreads: vec![Spread::default(); types.len()], types, of_lines }
    }

    /// Takes an error on the line that ends at this vertex, when and where it was.
    pub fn add(&mut self, vertex: usize, mm: f64, tick: u64, at: [f64; 2]) {
        let Some(kind) = self.of_lines.get(vertex) else { return };
        let Some(spread) = self.spreads.get_mut(usize::from(*kind)) else { return };
        spread.squares += mm * mm;
        spread.samples += 1;
        spread.greatest.take(Worst { mm, tick, at });
        spread.classes.resize(CLASSES, 0);
        if let Some(class) = spread.classes.get_mut(class_of(mm)) {
            *class = class.saturating_add(1);
        }
    }

    /// The types that occurred: printed ones, all of them together, and the others.
    #[must_use]
    pub fn told(&self) -> Vec<TypeErrors> {
        let occurred = || self.types.iter().zip(&self.spreads).filter(|(_, spread)| spread.samples > 0);
        let (printed, others): (Vec<_>, Vec<_>) = occurred().partition(|(line_type, _)| line_type.is_printed);
        let mut all = Spread::default();
        printed.iter().for_each(|(_, spread)| all.join(spread));
        let together = LineType { name: ALL_PRINTED.to_owned(), is_printed: true };
        let together = (printed.len() > 1).then_some((&together, &all));
        printed.into_iter().chain(together).chain(others).map(|(of, spread)| spread.told(of)).collect()
    }
}

impl Worst {
    const fn take(&mut self, other: Self) {
        if other.mm > self.mm {
            *self = other;
        }
    }
}

impl Spread {
    fn join(&mut self, other: &Self) {
        self.squares += other.squares;
        self.samples += other.samples;
        self.greatest.take(other.greatest);
        self.classes.resize(CLASSES, 0);
        for (sum, count) in self.classes.iter_mut().zip(&other.classes) {
            *sum = sum.saturating_add(*count);
        }
    }

    fn told(&self, of: &LineType) -> TypeErrors {
        let um = |mm: f64| 1000.0 * mm;
        let Worst { mm, tick, at: [x_mm, y_mm] } = self.greatest;
        TypeErrors {
            name: of.name.clone(),
            is_printed: of.is_printed,
            samples: self.samples,
            rms_um: um((self.squares / self.samples as f64).sqrt()),
            mostly_um: um(self.mostly_mm()),
            max_um: um(mm),
            x_mm,
            y_mm,
            tick,
        }
    }

    /// The upper end of the class with the error, or the greatest error, if that is in it.
    fn mostly_mm(&self) -> f64 {
        let mut left = (self.samples as f64 * MOSTLY).ceil() as u64;
        for (class, count) in self.classes.iter().enumerate() {
            left = left.saturating_sub(u64::from(*count));
            if left == 0 {
                return end_of(class).min(self.greatest.mm);
            }
        }
        self.greatest.mm
    }
}

/// The shift that leaves the exponent and the first bits of the mantissa.
const SHIFT: u32 = f64::MANTISSA_DIGITS - 1 - CLASS_BITS;

fn class_of(mm: f64) -> usize {
    let class = (mm.to_bits() >> SHIFT).saturating_sub(LEAST_MM.to_bits() >> SHIFT);
    (class as usize).min(CLASSES - 1)
}

fn end_of(class: usize) -> f64 {
    f64::from_bits(((LEAST_MM.to_bits() >> SHIFT) + class as u64 + 1) << SHIFT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_type_has_its_own_errors() {
        let of = |(name, is_printed): (&str, bool)| LineType { name: name.to_owned(), is_printed };
        let all = [("Travel", false), ("Outer", true), ("Never", true)].map(of).to_vec();
        let mut types = LineTypes::new(all, vec![NO_TYPE, 0, 1]);
        for step in 1..=1000_u32 {
            types.add(2, f64::from(step) / 100_000.0, step.into(), [1.0, f64::from(step)]);
        }
        types.add(1, 3.0, 5, [7.0, 8.0]);
        types.add(0, 9.0, 5, [7.0, 8.0]);
        types.add(3, 9.0, 5, [7.0, 8.0]);
        let [outer, travel] = &types.told()[..] else { panic!("a type too few or too many") };
        assert_eq!((travel.name.as_str(), travel.rms_um, travel.max_um), ("Travel", 3e3, 3e3));
        assert_eq!(travel.mostly_um, travel.max_um);
        assert_eq!((outer.samples, outer.tick, [outer.x_mm, outer.y_mm]), (1000, 1000, [1.0, 1000.0]));
        assert!((outer.max_um - 10.0).abs() < 1e-9 && (outer.rms_um - 5.7778).abs() < 1e-3, "{outer:?}");
        assert!(outer.mostly_um >= 9.99 && outer.mostly_um <= 10.0, "{outer:?}");
    }

    #[test]
    fn printed_lines_are_told_together_and_travel_is_not_among_them() {
        let of = |(name, is_printed): (&str, bool)| LineType { name: name.to_owned(), is_printed };
        let mut types = LineTypes::new([("T", false), ("A", true), ("B", true)].map(of).to_vec(), vec![0, 1, 2]);
        [(0, 5.0), (1, 0.3), (2, 0.4), (2, 0.4)].into_iter().for_each(|(line, mm)| types.add(line, mm, 1, [mm; 2]));
        let told = types.told();
        assert_eq!(told.iter().map(|row| row.name.as_str()).collect::<Vec<_>>(), ["A", "B", ALL_PRINTED, "T"]);
        let all = &told[2];
        assert_eq!((all.samples, all.max_um, all.x_mm), (3, 400.0, 0.4));
        assert!((all.rms_um - 1000.0 * (0.41_f64 / 3.0).sqrt()).abs() < 1e-9, "{all:?}");
    }

    #[test]
    fn a_class_ends_above_each_of_its_errors_and_not_far() {
        for mm in [0.0, 1e-12, 5.9e-8, 1e-6, 0.001, 0.0123, 0.5, 1.0, 77.0, 200.0] {
            let end = end_of(class_of(mm));
            assert!(end > mm && (end <= mm * 1.016 || mm < LEAST_MM), "{mm}: {end}");
        }
        assert_eq!(class_of(f64::INFINITY), CLASSES - 1);
    }
}
