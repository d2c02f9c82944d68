//! Mesh: the mesh of the bed that z followed, and its effect, in numbers.

use corehbot_sim::mesh_log::{Errors, Improvement, MeshEffect};
use serde::Serialize;
use std::fmt;

/// The last mesh that z followed; its effect is of all meshes of the print. The fields have their JSON names.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct MeshSummary {
    /// Points along x.
    pub columns: usize,
    /// Points along y.
    pub rows: usize,
    /// First and last column.
    pub x_mm: [f64; 2],
    /// First and last row.
    pub y_mm: [f64; 2],
    /// Heights of the points, row by row from the front, each from the left.
    pub heights_mm: Vec<Vec<f64>>,
    /// The lowest point.
    pub least_mm: f64,
    /// The highest point.
    pub greatest_mm: f64,
    /// From the lowest to the highest point.
    pub range_mm: f64,
    /// The mean of the points.
    pub mean_mm: f64,
    /// Above it the mean alone counts; `None` if the mesh does not fade.
    pub fade_height_mm: Option<f64>,
    /// The least correction of z while the tool moved.
    pub least_correction_mm: f64,
    /// The greatest one.
    pub greatest_correction_mm: f64,
    /// Steps of z that a flat bed would not have taken.
    pub z_steps_added: u64,
    /// Moves with a lower feed than on a flat bed, because of z's limits.
    pub slowed_moves: u32,
    /// The first layer, if there was one over a bed that is known.
    pub first_layer: Option<FirstLayer>,
    /// The mesh against the true bed over the mesh's area.
    pub bed_error: Option<Improved>,
}

/// The height of the first layer against the true bed.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct FirstLayer {
    /// Its z.
    pub z_mm: f64,
    /// Its errors.
    #[serde(flatten)]
    pub error: Improved,
}

/// Errors without the mesh, and with it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Improved {
    /// Root mean square without the mesh.
    pub rms_before_mm: f64,
    /// Root mean square with it.
    pub rms_after_mm: f64,
    /// Largest error without the mesh.
    pub max_before_mm: f64,
    /// Largest error with it.
    pub max_after_mm: f64,
}

/// To a tenth of a micrometre: more would be noise.
fn rounded(mm: f64) -> f64 {
    // No negative zero.
    (mm * 1e4).round() / 1e4 + 0.0
}

impl Improved {
    fn new(Improvement { before, after }: Improvement) -> Self {
        let [(rms_before_mm, max_before_mm), (rms_after_mm, max_after_mm)] =
            [before, after].map(|Errors { rms_mm, max_mm }| (rounded(rms_mm), rounded(max_mm)));
        Self { rms_before_mm, rms_after_mm, max_before_mm, max_after_mm }
    }
}

impl MeshSummary {
    /// The summary of what a mesh did, with so many moves that it has made slower.
    #[must_use]
    pub fn new(effect: MeshEffect, slowed_moves: u32) -> Self {
        let MeshEffect { mesh, correction_mm, z_steps_added, first_layer, area } = effect;
        let heights: Vec<Vec<f64>> =
            mesh.heights_mm.iter().map(|row| row.iter().copied().map(rounded).collect()).collect();
        let all = || heights.iter().flatten().copied();
        let (least, greatest) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let [[x, y], [to_x, to_y]] = mesh.corners_mm.map(|corner| corner.map(rounded));
        let [least_correction, greatest_correction] = correction_mm.map(rounded);
        Self {
            columns: heights.first().map_or(0, Vec::len),
            rows: heights.len(),
            x_mm: [x, to_x],
            y_mm: [y, to_y],
            least_mm: least,
            greatest_mm: greatest,
            range_mm: rounded(greatest - least),
            mean_mm: rounded(mesh.mean_mm),
            fade_height_mm: mesh.fade_height_mm.map(rounded),
            least_correction_mm: least_correction,
            greatest_correction_mm: greatest_correction,
            z_steps_added,
            slowed_moves,
            first_layer: first_layer.map(|(z, error)| FirstLayer { z_mm: rounded(z), error: Improved::new(error) }),
            bed_error: area.map(Improved::new),
            heights_mm: heights,
        }
    }
}

impl fmt::Display for MeshSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "{name:<18} {value}");
        let fade = self.fade_height_mm.map_or("no fade".to_owned(), |mm| format!("fades to it at Z{mm}"));
        let (columns, rows, least, greatest) = (self.columns, self.rows, self.least_mm, self.greatest_mm);
        row("mesh", format!("{columns} by {rows} points, {least:+.3} to {greatest:+.3} mm"))?;
        row("", format!("mean {:+.3} mm, {fade}", self.mean_mm))?;
        let (least, greatest) = (self.least_correction_mm, self.greatest_correction_mm);
        row("z correction", format!("{least:+.3} to {greatest:+.3} mm, {} steps more", self.z_steps_added))?;
        row("slower by z", format!("{} moves", self.slowed_moves))?;
        let mut off = |name: &str, error: &Improved| {
            let Improved { rms_before_mm, rms_after_mm, max_before_mm, max_after_mm } = error;
            let text = format!("rms {rms_after_mm:.4} mm, at most {max_after_mm:.4} mm");
            row(name, format!("{text} (without mesh {rms_before_mm:.4}, {max_before_mm:.4})"))
        };
        if let Some(layer) = &self.first_layer {
            off("first layer is off", &layer.error)?;
        }
        if let Some(error) = &self.bed_error {
            off("mesh is off", error)?;
        }
        Ok(())
    }
}
