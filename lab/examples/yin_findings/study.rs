//! What is asked of a rig: the trends that the paper found on its own.

use corehbot_lab::yin::fit::{exponent, line};
use corehbot_lab::yin::{Case, Corners, Error, Model, Parameters, axes, run_on};

/// As in figure 5 of the paper: from a half to two.
const FACTORS: [f64; 5] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0, std::f64::consts::SQRT_2, 2.0];

/// Parts of the speed that errors are compared at.
const SPEEDS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// What a rig showed. Errors are those of equation 17 from x to y unless they say otherwise.
pub struct Finding {
    /// Exponents over friction, stiffness and mass; nothing where an error is not positive.
    pub exponents: [Option<f64>; 3],
    /// R2 of a line through the errors over speed.
    pub r_squared: f64,
    /// Whether x to y is larger than y to x.
    pub is_x_larger: bool,
    /// Whether x is damped more: c_x / K > c_y / K.
    pub is_x_slower: bool,
    /// 4-DoF error over the full model's: x to y, y to x.
    pub four_over_full: [f64; 2],
    /// Error from x to y and overshoot, in v / omega of the axis with the larger one.
    pub of_swing: [f64; 2],
}

/// Asks a rig at a speed in m/s.
pub fn study(rig: &Parameters, speed: f64) -> Result<Finding, Error> {
    let at = Case::at(speed);
    let full = run_on(rig, &at)?;
    let four = run_on(rig, &Case { model: Model::FourDof, ..at })?;
    let varied = [
        power(rig, |friction| Case { friction, ..at })?,
        power(rig, |stiffness| Case { stiffness, ..at })?,
        power(rig, |mass| Case { mass, ..at })?,
    ];
    let mut over_speed = Vec::new();
    for part in SPEEDS {
        over_speed.push((part * speed, run_on(rig, &Case::at(part * speed))?.x_to_y_mm));
    }
    let [x, y] = axes(Model::Full, rig);
    let swing_mm = 1e3 * speed / x.frequency().min(y.frequency());
    Ok(Finding {
        exponents: varied,
        r_squared: line(&over_speed).r_squared,
        is_x_larger: full.x_to_y_mm > full.y_to_x_mm,
        is_x_slower: x.viscous / x.stiffness > y.viscous / y.stiffness,
        four_over_full: [four.x_to_y_mm / full.x_to_y_mm, four.y_to_x_mm / full.y_to_x_mm],
        of_swing: [full.x_to_y_mm / swing_mm, full.overshoot_mm / swing_mm],
    })
}

/// The exponent of the error over a factor.
fn power(rig: &Parameters, case: impl Fn(f64) -> Case) -> Result<Option<f64>, Error> {
    let mut points = Vec::new();
    for factor in FACTORS {
        let Corners { x_to_y_mm, .. } = run_on(rig, &case(factor))?;
        points.push((factor, x_to_y_mm));
    }
    Ok(points.iter().all(|(_, error)| *error > 0.0).then(|| exponent(&points)))
}
