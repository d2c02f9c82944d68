//! The mesh of the bed: how many points G29 measures, whether the mesh is used, and how far up.

use super::ranges;
use super::rows::{Spec, rows};
use crate::units::Mm;
use serde::{Deserialize, Serialize};

/// How a mesh is measured and used. Its heights are kept apart from the settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct MeshSettings {
    /// Columns of points along x.
    pub columns: u8,
    /// Rows of points along y.
    pub rows: u8,
    /// The height of z up to which it fades; 0 is no fade.
    pub fade: Mm,
    /// Whether it is used.
    pub is_on: bool,
}

impl MeshSettings {
    /// 5 by 5 points, which a smooth law makes better than 9 by 9 with straight lines. It fades over 10 mm, as in
    /// Marlin (Configuration.h 2.1, `DEFAULT_LEVELING_FADE_HEIGHT`).
    pub(super) const fn prototype() -> Self {
        Self { columns: 5, rows: 5, fade: Mm::const_from_int(10), is_on: false }
    }
}

rows! {
    for mesh in |s, _| Some(&mut s.mesh), named &["mesh"];

    /// Columns of points that G29 measures along x; up to 49 points are kept by M500.
    144 "columns" = &mut mesh.columns, "", [ranges::MESH_POINTS.spec()];
    /// Rows of points along y.
    145 "rows" = &mut mesh.rows, "", [ranges::MESH_POINTS.spec()];
    /// Height of z up to which the mesh fades to its mean; 0 is no fade (M420 Z).
    146 "fade" = &mut mesh.fade, "mm", [ranges::MESH_FADE.spec().or_zero()];
    /// Whether the kept mesh is used from the start (M420 S).
    147 "is_on" = &mut mesh.is_on, "", [Spec::SWITCH];
}
