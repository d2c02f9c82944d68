//! Modes: natural frequencies and shapes.
//!
//! `(K - w^2 M) q = 0` for the moving coordinates; compliant ones without mass are condensed first. With M = C C^T this
//! is a symmetric problem, `C^-1 K C^-T v = w^2 v`.

use super::NotHeld;
use super::balance::{condensed, submatrix};
use crate::math::powi;
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, ElasticPart};
use std::f64::consts::TAU;

/// A natural vibration without damping.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// In Hz.
    pub frequency_hz: f64,
    /// Moving coordinates with their parts of the kinetic energy, of 1; where masses couple, parts may be negative.
    pub shares: Vec<(Coordinate, f64)>,
    /// Viscous damping ratio, from the undamped shape.
    pub damping_ratio: f64,
}

impl Mode {
    /// A coordinate's part of the energy.
    #[must_use]
    pub fn share(&self, coordinate: Coordinate) -> f64 {
        self.shares.iter().filter(|(c, _)| *c == coordinate).map(|(_, share)| share).sum()
    }

    /// The part of the machine with most of the energy. Idlers count together.
    #[must_use]
    pub fn of(&self) -> String {
        let mut sums: Vec<(String, f64)> = Vec::new();
        for (coordinate, share) in &self.shares {
            let name = coordinate.to_string();
            match sums.iter_mut().find(|(known, _)| *known == name) {
                Some((_, sum)) => *sum += share,
                None => sums.push((name, *share)),
            }
        }
        sums.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(String::new, |(name, _)| name)
    }
}

/// The mode of an axis: the one in which its coordinate has the largest part.
#[must_use]
pub fn mode_of(modes: &[Mode], coordinate: Coordinate) -> Option<&Mode> {
    modes.iter().max_by(|a, b| a.share(coordinate).total_cmp(&b.share(coordinate)))
}

/// How the tool rings along an axis: in a mode of its own and, where the frame is soft, with the frame.
#[derive(Clone, Copy, Debug)]
pub struct Ringing<'m> {
    axis: Coordinate,
    /// The mode of the axis.
    pub own: &'m Mode,
    /// The frame's.
    pub frame: Option<&'m Mode>,
}

impl<'m> Ringing<'m> {
    /// The modes of a coordinate of the tool.
    #[must_use]
    pub fn of(modes: &'m [Mode], axis: Coordinate) -> Option<Self> {
        let own = mode_of(modes, axis)?;
        let frame = Coordinate::Frame(Coordinate::TOOL.iter().position(|known| *known == axis)?);
        let others = modes.iter().filter(|mode| *mode != own && mode.shares.iter().any(|(c, _)| *c == frame));
        let frame = others.max_by(|a, b| a.share(frame).total_cmp(&b.share(frame)));
        Some(Self { axis, own, frame })
    }

    /// The frame's part of the ringing after a jump of the tool's speed, of 1: a mode's part is its shape's way times
    /// its momentum.
    #[must_use]
    pub fn part_of_frame(&self) -> f64 {
        self.frame.map_or(0.0, |mode| mode.share(self.axis).clamp(0.0, 1.0))
    }

    /// Sum of both parts over a power of their angular frequencies: 1 for a jump of speed, 2 for one of acceleration.
    #[must_use]
    pub fn over_frequency(&self, power: i32) -> f64 {
        let over = |mode: &Mode| powi(TAU * mode.frequency_hz, -power);
        let part = self.part_of_frame();
        (1.0 - part) * over(self.own) + self.frame.map_or(0.0, |mode| part * over(mode))
    }
}

/// N/mm over kg, in 1/s^2: 1 N moves 1 kg by 1000 mm/s^2.
const MM_PER_M: f64 = 1000.0;

/// All modes, the slowest first.
///
/// # Errors
/// Nothing holds the machine.
pub fn modes(elastic: &Elastic) -> Result<Vec<Mode>, NotHeld> {
    let moving = elastic.with_part(ElasticPart::Moves);
    let stiffness = condensed(elastic, &moving)?;
    let mass = submatrix(&elastic.mass, &moving, &moving);
    let damping = submatrix(&elastic.damping, &moving, &moving);
    let root = mass.clone().cholesky().ok_or(NotHeld)?.l();
    let half = root.solve_lower_triangular(&stiffness).ok_or(NotHeld)?;
    let symmetric = root.solve_lower_triangular(&half.transpose()).ok_or(NotHeld)?;
    let solved = symmetric.symmetric_eigen();
    let coordinates: Vec<Coordinate> =
        moving.iter().filter_map(|i| elastic.links.coordinates.get(*i)).copied().collect();
    let mut modes = Vec::new();
    for (square, vector) in solved.eigenvalues.iter().zip(solved.eigenvectors.column_iter()) {
        if square.is_nan() {
            return Err(NotHeld);
        }
        let shape = root.tr_solve_lower_triangular(&vector.into_owned()).ok_or(NotHeld)?;
        let momentum = &mass * &shape;
        let shares = coordinates.iter().zip(shape.iter().zip(momentum.iter())).map(|(c, (q, p))| (*c, q * p)).collect();
        let omega = (square.max(0.0) * MM_PER_M).sqrt();
        // The shape's mass is 1 kg.
        let friction = shape.dot(&(&damping * &shape)) * MM_PER_M;
        let damping_ratio = if omega > 0.0 { friction / (2.0 * omega) } else { 0.0 };
        modes.push(Mode { frequency_hz: omega / TAU, shares, damping_ratio });
    }
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Ok(modes)
}
