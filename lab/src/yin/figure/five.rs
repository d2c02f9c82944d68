//! Figure 5: the error over relative mass, stiffness and friction, by the full model at 0.079 m/s.

use super::super::fit::exponent;
use super::super::{Case, Error, Model, Parameters, run_on};
use super::{ABOUT_CLAIMS, Errors, FAST, WAYS};
use crate::queries::claim::{Claim, write_claims};
use serde::Serialize;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::fmt;

/// The fourth root of two.
const ROOT: f64 = 1.189_207_115_002_721;

/// Factors as in the paper, a half to two, in equal ratios.
const FACTORS: [f64; 9] = [0.5, 0.5 * ROOT, FRAC_1_SQRT_2, FRAC_1_SQRT_2 * ROOT, 1.0, ROOT, SQRT_2, SQRT_2 * ROOT, 2.0];

/// Farthest exponent from 1, -1 or 0 that still counts as proportional, inverse or independent.
const ABOUT: f64 = 0.1;

/// A case with a parameter times a factor.
type Scaled = fn(Case, f64) -> Case;

/// Errors over factors of the parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure5 {
    /// Speed along the square.
    pub speed_m_s: f64,
    /// One for each parameter and way round.
    pub varied: Vec<Varied>,
    /// What the text says.
    pub claims: Vec<Claim>,
}

/// Errors over the factor of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Varied {
    /// The parameter.
    pub name: &'static str,
    /// The way round.
    pub direction: &'static str,
    /// Its factors.
    pub factors: Vec<f64>,
    /// Errors with these factors.
    pub errors: Vec<Errors>,
    /// Exponents n of the best error = a factor^n, from x to y and from y to x; none where an error is not positive.
    pub exponents: [Option<f64>; 2],
}

impl Varied {
    /// Factor and error of a turn (0 from x to y, 1 from y to x).
    #[must_use]
    pub fn points(&self, turn: usize) -> Vec<(f64, f64)> {
        let error = |errors: &Errors| errors.both().get(turn).copied().unwrap_or(f64::NAN);
        self.factors.iter().copied().zip(self.errors.iter().map(error)).collect()
    }
}

impl Figure5 {
    /// The figure of a rig.
    ///
    /// # Errors
    /// As [`run_on`].
    pub fn new(rig: &Parameters, like: &Case) -> Result<Figure5, Error> {
        let like = Case { speed: FAST, model: Model::Full, ..*like };
        let with: [(&'static str, Scaled); 3] = [
            ("friction", |case, by| Case { friction: case.friction * by, ..case }),
            ("stiffness", |case, by| Case { stiffness: case.stiffness * by, ..case }),
            ("mass", |case, by| Case { mass: case.mass * by, ..case }),
        ];
        let mut varied = Vec::new();
        for (direction, way) in WAYS {
            for (name, scaled) in with {
                let mut errors = Vec::new();
                for factor in FACTORS {
                    errors.push(Errors::from(run_on(rig, &Case { direction, ..scaled(like, factor) })?));
                }
                let factors = FACTORS.to_vec();
                let mut one = Varied { name, direction: way, factors, errors, exponents: [None; 2] };
                one.exponents = [0, 1].map(|turn| {
                    let points = one.points(turn);
                    points.iter().all(|(_, error)| *error > 0.0).then(|| exponent(&points))
                });
                varied.push(one);
            }
        }
        let claims = claims(&varied);
        Ok(Figure5 { speed_m_s: FAST, varied, claims })
    }
}

/// "Simulated maximum contour error": the larger of both turns, the paper's way round.
fn claims(varied: &[Varied]) -> Vec<Claim> {
    let claim = |name: &str, wanted: f64, text| {
        let one = varied.iter().find(|one| one.name == name)?;
        let middle = one.errors.get(FACTORS.len() / 2)?;
        let turn = usize::from(middle.y_to_x_mm > middle.x_to_y_mm);
        let found = one.exponents.get(turn).copied().flatten();
        let [x_to_y, y_to_x] = one.exponents.map(shown);
        let larger = Errors::TURNS.get(turn)?;
        let exponents =
            format!("exponent {x_to_y} from x to y, {y_to_x} from y to x; the larger error is from {larger}");
        Some(Claim::new(text, found.is_some_and(|n| (n - wanted).abs() <= ABOUT), exponents))
    };
    [
        claim("friction", 1.0, "the error is proportional to friction"),
        claim("stiffness", -1.0, "the error is inversely proportional to stiffness"),
        claim("mass", 0.0, "the error depends little on masses"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn shown(exponent: Option<f64>) -> String {
    exponent.map_or_else(|| "none".to_owned(), |n| format!("{n:.2}"))
}

impl fmt::Display for Figure5 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "figure 5: the contour error in mm at {} m/s over relative parameters, full-DoF", self.speed_m_s)?;
        write!(f, "{:17}  {:9}  {:6}", "way round", "parameter", "turn")?;
        FACTORS.iter().try_for_each(|factor| write!(f, "  {factor:6.3}"))?;
        writeln!(f, "  exponent")?;
        for one in &self.varied {
            for (turn, name) in Errors::TURNS.into_iter().enumerate() {
                write!(f, "{:17}  {:9}  {name:6}", one.direction, one.name)?;
                one.points(turn).iter().try_for_each(|(_, error)| write!(f, "  {error:6.4}"))?;
                writeln!(f, "  {}", shown(one.exponents.get(turn).copied().flatten()))?;
            }
        }
        writeln!(f, "{ABOUT_CLAIMS}")?;
        write_claims(f, &self.claims)
    }
}
