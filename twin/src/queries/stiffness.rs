//! Stiffness of the tool: the matrix of x and y in N per millimetre, its softest direction, and z where belts lift the
//! tool.

use super::{At, Setup, shown};
use crate::math::{atan2, hypot};
use crate::model::coordinate::Coordinate;
use crate::solve::NotHeld;
use crate::solve::balance::condensed;
use serde::Serialize;

/// Stiffness at the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stiffness {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// Force in x per millimetre of x.
    #[serde(rename = "Kxx_N_per_mm")]
    pub kxx: f64,
    /// Force in y per millimetre of y.
    #[serde(rename = "Kyy_N_per_mm")]
    pub kyy: f64,
    /// Force in y per millimetre of x.
    #[serde(rename = "Kxy_N_per_mm")]
    pub kxy: f64,
    /// Force in z per millimetre of z; none where no belts lift the tool.
    #[serde(rename = "Kzz_N_per_mm", skip_serializing_if = "Option::is_none")]
    pub kzz: Option<f64>,
    /// Force in z per millimetre of x, where belts lift the tool.
    #[serde(rename = "Kxz_N_per_mm", skip_serializing_if = "Option::is_none")]
    pub kxz: Option<f64>,
    /// The same per millimetre of y.
    #[serde(rename = "Kyz_N_per_mm", skip_serializing_if = "Option::is_none")]
    pub kyz: Option<f64>,
    /// Stiffness of the softest direction of x and y, with z held.
    #[serde(rename = "softest_N_per_mm")]
    pub softest: f64,
    /// That direction, from x towards y, -90 to 90.
    pub softest_direction_deg: f64,
}

impl Stiffness {
    /// The answer.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup) -> Result<Self, NotHeld> {
        // x and y are the first two coordinates of all links. Where belts lift the tool, z is held.
        let elastic = setup.elastic();
        let up = elastic.links.index(Coordinate::Z);
        let kept: Vec<usize> = [0, 1].into_iter().chain(up).collect();
        let k = condensed(&elastic, &kept)?;
        let (kxx, kyy, kxy) = (k[(0, 0)], k[(1, 1)], k[(0, 1)]);
        let [kzz, kxz, kyz] = [(2, 2), (0, 2), (1, 2)].map(|entry| up.map(|_| k[entry]));
        let (mean, half) = ((kxx + kyy) / 2.0, (kxx - kyy) / 2.0);
        let turned = hypot(half, kxy);
        // The stiffest direction is at half the angle of (half, kxy), the softest at a right angle to it.
        let stiffest = atan2(kxy, half).to_degrees() / 2.0;
        let softest_direction_deg = if stiffest > 0.0 { stiffest - 90.0 } else { stiffest + 90.0 };
        Ok(Self { at: setup.at(), kxx, kyy, kxy, kzz, kxz, kyz, softest: mean - turned, softest_direction_deg })
    }
}

impl std::fmt::Display for Stiffness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        writeln!(f, "  Kxx {:>9} N/mm", shown(self.kxx, 3))?;
        writeln!(f, "  Kyy {:>9} N/mm", shown(self.kyy, 3))?;
        writeln!(f, "  Kxy {:>9} N/mm", shown(self.kxy, 3))?;
        for (name, k) in [("Kzz", self.kzz), ("Kxz", self.kxz), ("Kyz", self.kyz)] {
            if let Some(k) = k {
                writeln!(f, "  {name} {:>9} N/mm", shown(k, 3))?;
            }
        }
        let direction = shown(self.softest_direction_deg, 1);
        writeln!(f, "  softest {:>5} N/mm, at {direction} degrees from x", shown(self.softest, 3))
    }
}
