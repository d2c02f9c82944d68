//! Trail: displacements of the tool from its line, with enough places for a picture.

/// Maximum number of places; beyond it every second one is dropped.
const MOST: usize = 60_000;

/// A place on the line and the tool's displacement, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// When the tool was there, in ticks.
    pub tick: u64,
    /// The nearest place of the line.
    pub at: [f64; 2],
    /// From there to the tool.
    pub off: [f64; 2],
}

/// Places in order, evenly selected.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// The places.
    pub places: Vec<Beside>,
    every: u64,
    seen: u64,
}

impl Default for Trail {
    fn default() -> Self {
        Self { places: Vec::new(), every: 1, seen: 0 }
    }
}

impl Trail {
    /// The tool is here.
    pub(super) fn add(&mut self, tick: u64, at: [f64; 2], off: [f64; 2]) {
        if self.seen.is_multiple_of(self.every) {
            if self.places.len() == MOST {
                let mut index = 0;
                self.places.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.every *= 2;
            }
            if self.seen.is_multiple_of(self.every) {
                self.places.push(Beside { tick, at, off });
            }
        }
        self.seen += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_places_every_nth_is_kept() {
        let mut trail = Trail::default();
        for i in 0..300_001 {
            trail.add(0, [f64::from(i), 0.0], [0.0; 2]);
        }
        let kept: Vec<f64> = trail.places.iter().map(|place| place.at[0]).collect();
        assert!(kept.len() > MOST / 2 && kept.len() <= MOST);
        assert!(kept.windows(2).all(|pair| pair[1] - pair[0] == 8.0) && kept[0] == 0.0, "{:?}", &kept[..4]);
    }
}
