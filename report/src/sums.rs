//! Sums of a print: time and filament by type of line, by layer and by limit.

use crate::moves::{MoveChunk, Sum};
use corehbot_sim::moves::Limit;
use corehbot_sim::slicer::{LineType, Notes, Role};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Density of filament that a file does not name, in g/cm3: PLA (PrusaSlicer's and Cura's material profiles).
pub const DENSITY: f64 = 1.24;

/// Diameter of filament that a file does not name, in mm: the usual one.
pub const DIAMETER: f64 = 1.75;

/// Moves of a type.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TypeSum {
    /// Index of the type.
    #[serde(rename = "type")]
    pub kind: usize,
    /// Its name.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Their time in s.
    pub seconds: f64,
    /// Filament that they move.
    pub filament_mm: f64,
    /// The way on which filament was laid.
    pub printed_mm: f64,
    /// Their number.
    pub moves: u64,
}

/// Moves of a layer.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct LayerSum {
    /// Its height.
    pub height_mm: f64,
    /// The time in s.
    pub seconds: f64,
    /// Filament that was moved.
    pub filament_mm: f64,
    /// The way on which filament was laid.
    pub printed_mm: f64,
}

/// Moves before the first layer, or after the last printed move.
#[derive(Clone, Copy, PartialEq, Default, Debug, Serialize)]
pub struct OutsideSum {
    /// Their time in s.
    pub seconds: f64,
    /// Filament that they move.
    pub filament_mm: f64,
    /// Their number.
    pub moves: u64,
}

impl OutsideSum {
    pub(crate) fn new(sum: &Sum) -> Self {
        let (seconds, filament_mm) = (to_thousandth(sum.seconds), to_thousandth(sum.filament_mm));
        Self { seconds, filament_mm, moves: sum.moves }
    }
}

/// The time of moves with a limit.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct LimitSum {
    /// What keeps them from being faster.
    pub limit: Limit,
    /// Their time in s.
    pub seconds: f64,
}

/// All filament.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Filament {
    /// Its diameter.
    pub diameter_mm: f64,
    /// Its length: what was used, without what was pulled back in between.
    pub mm: f64,
    /// Its volume.
    pub cm3: f64,
    /// Its mass.
    pub g: f64,
    /// Its density.
    pub density_g_cm3: f64,
    /// Whether the file names the density; if not, it is the one of PLA.
    pub is_density_known: bool,
}

impl Filament {
    /// A length of it, as the file describes it.
    #[must_use]
    pub fn new(mm: f64, notes: &Notes) -> Self {
        let diameter_mm = notes.diameter().unwrap_or(DIAMETER);
        let density_g_cm3 = notes.density().unwrap_or(DENSITY);
        let cm3 = mm * PI * diameter_mm * diameter_mm / 4.0 / 1000.0;
        Self {
            diameter_mm,
            mm: to_thousandth(mm),
            cm3: to_thousandth(cm3),
            g: to_thousandth(cm3 * density_g_cm3),
            density_g_cm3,
            is_density_known: notes.density().is_some(),
        }
    }
}

/// Sums of the types that occur.
pub(crate) fn by_type(sums: &[Sum], notes: &Notes) -> Vec<TypeSum> {
    let occurs = sums.iter().zip(notes.types()).enumerate().filter(|(_, (sum, _))| sum.moves > 0);
    let row = |(kind, (sum, named)): (usize, (&Sum, &LineType))| TypeSum {
        kind,
        name: named.name.clone(),
        role: named.role,
        seconds: to_thousandth(sum.seconds),
        filament_mm: to_thousandth(sum.filament_mm),
        printed_mm: to_thousandth(sum.printed_mm),
        moves: sum.moves,
    };
    occurs.map(row).collect()
}

/// Times of the limits that occur, the longest first.
pub(crate) fn by_limit(sums: &[f64; Limit::ALL.len()]) -> Vec<LimitSum> {
    let occurs = Limit::ALL.into_iter().zip(sums).filter(|(_, seconds)| **seconds > 0.0);
    let mut rows: Vec<_> =
        occurs.map(|(limit, seconds)| LimitSum { limit, seconds: to_thousandth(*seconds) }).collect();
    rows.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    rows
}

/// Sums of the layers at `heights` in um, one row a height.
pub(crate) fn by_layer(sums: &BTreeMap<i64, Sum>, heights: &[i64]) -> Vec<LayerSum> {
    let mut rows = vec![Sum::default(); heights.len()];
    for (height, sum) in sums {
        if let Some(row) = layer_of(*height, heights).and_then(|layer| rows.get_mut(layer)) {
            row.join(sum);
        }
    }
    let row = |(height, sum): (&i64, &Sum)| LayerSum {
        height_mm: *height as f64 / 1000.0,
        seconds: to_thousandth(sum.seconds),
        filament_mm: to_thousandth(sum.filament_mm),
        printed_mm: to_thousandth(sum.printed_mm),
    };
    heights.iter().zip(&rows).map(row).collect()
}

/// The layer with the height nearest to `height`: planned heights and those in whole steps differ by a step at most.
pub(crate) fn layer_of(height: i64, heights: &[i64]) -> Option<usize> {
    let above = heights.partition_point(|other| *other < height);
    let near = [above.checked_sub(1), Some(above)].into_iter().flatten().filter(|index| *index < heights.len());
    near.min_by_key(|index| (heights[*index] - height).abs())
}

/// Moves, begin and end in 10 us, layer, and x, y and z in um at the begin of a chunk.
pub(crate) fn chunk_row(chunk: &MoveChunk, heights: &[i64]) -> [i64; 7] {
    let layer = chunk.height.and_then(|height| layer_of(height, heights)).unwrap_or(0);
    let ([begin, end], [x, y, z]) = (chunk.time.map(|time| time as i64), chunk.from);
    [chunk.moves as i64, begin, end, layer as i64, x, y, z]
}

/// To three decimals: more would be noise.
pub(crate) fn to_thousandth(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_belongs_to_the_nearest_layer() {
        let heights = [200, 403, 600];
        for (height, layer) in [(0, 0), (200, 0), (301, 0), (302, 1), (400, 1), (599, 2), (9999, 2)] {
            assert_eq!(layer_of(height, &heights), Some(layer), "{height}");
        }
        assert_eq!(layer_of(5, &[]), None);
    }

    #[test]
    fn a_metre_of_pla_weighs_three_grams() {
        let filament = Filament::new(1000.0, &Notes::default());
        // 0.875^2 pi mm2 over a metre: 2.405 cm3.
        assert_eq!((filament.cm3, filament.g), (2.405, 2.983));
    }
}
