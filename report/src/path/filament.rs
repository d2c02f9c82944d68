//! Filament: which stretches of the path are printed.
//!
//! The extruder's steps are further apart than the axes' steps. The way between two forward steps is printed. If it is
//! much longer than the ways between the steps before it, the tool travelled.

use super::{Place, distance};

/// A way between two steps of the filament is travel if it is this many times as long as usual.
const UNUSUAL: f64 = 3.0;

/// The longest way between two steps of a print, in mm: 93 steps/mm and a line of 0.3 x 0.05 mm make 1.7 a mm.
const LONGEST: f64 = 1.5;

/// How much of the usual way the last one is.
const SHARE: f64 = 0.1;

/// Separates printing from travelling.
pub(super) struct Filament {
    /// Where the tool is, and steps of the extruder so far.
    at: [f64; 3],
    e: i64,
    /// The way since the extruder's last step, and whether that went forward.
    way: f64,
    is_forward: bool,
    /// The usual way between two of its steps, and whether the last one was longer.
    usual: f64,
    is_unusual: bool,
    /// Places since its last step.
    undecided: Vec<Place>,
}

impl Filament {
    /// A tool that stands.
    pub const fn new(at: [f64; 3]) -> Self {
        Self { at, e: 0, way: 0.0, is_forward: false, usual: LONGEST, is_unusual: false, undecided: Vec::new() }
    }

    /// The tool has moved, and the extruder has made `e` steps. Hands on the places that are now classified.
    pub fn event(&mut self, at: [f64; 3], tick: u64, e: i64, mut each: impl FnMut(Place)) {
        self.way += distance(self.at, at);
        self.at = at;
        let turned = e - self.e;
        self.e = e;
        let is_turn = turned != 0 && (turned > 0) != self.is_forward;
        self.undecided.push(Place { at, tick, is_printing: false, is_turn });
        let most = (UNUSUAL * self.usual).min(LONGEST);
        if turned == 0 {
            if self.way > most || !self.is_forward && self.way > self.usual {
                self.decide(false, &mut each);
            }
            return;
        }
        let is_usual = self.way <= most;
        if self.is_forward && turned > 0 && self.way > 0.0 {
            if is_usual {
                self.usual += SHARE * (self.way - self.usual);
            } else if self.is_unusual && self.way <= LONGEST {
                // Twice in a row: the line has become thinner.
                self.usual = self.way;
            }
            self.is_unusual = !is_usual;
        }
        self.decide(turned > 0 && is_usual, &mut each);
        self.way = 0.0;
        self.is_forward = turned > 0;
    }

    /// Nothing follows.
    pub fn finish(&mut self, mut each: impl FnMut(Place)) {
        self.decide(false, &mut each);
    }

    fn decide(&mut self, is_printing: bool, each: &mut impl FnMut(Place)) {
        self.undecided.drain(..).for_each(|place| each(Place { is_printing, ..place }));
    }
}
