//! Figure: a measurable property of a machine, and the model's value of it.
//!
//! The model has rotors, idlers and the bar's yaw: a head beside the middle also turns the bar when it is pushed or
//! rings along y.

use super::parameter::Parameter;
use crate::math::{ln, square};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::model::links::Links;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use crate::solve::balance::settled;
use crate::solve::modes::{Mode, mode_of, modes};
use nalgebra::DVector;
use std::f64::consts::FRAC_1_SQRT_2;

/// An axis of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the right.
    X,
    /// Away from the front.
    Y,
}

impl From<Direction> for Coordinate {
    fn from(direction: Direction) -> Self {
        match direction {
            Direction::X => Self::X,
            Direction::Y => Self::Y,
        }
    }
}

/// The weighed part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighed {
    /// All mass that moves in x.
    Head,
    /// All mass that moves in y besides the head.
    Bar,
    /// All mass that moves in y.
    Both,
    /// The gantry that carries the bar, where belts lift it.
    Gantry,
    /// A bed that moves in y.
    Bed,
}

/// A measurable property. The motors have power and hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Figure {
    /// Frequency in Hz of a plucked part of a belt between two pulleys, with the machine at rest.
    Pluck {
        /// Length of the part.
        length_mm: f64,
        /// The belt, in the order of the machine's belts.
        belt: usize,
    },
    /// Mass of a metre of belt in kg.
    BeltMass,
    /// Deflection of the head in mm along the direction of a force.
    Deflection {
        /// The tool's place.
        at: Place,
        /// Axis along which the force pulls.
        along: Direction,
        /// The force.
        force_n: f64,
    },
    /// The same along a diagonal: of crossed belts, each holds the tool along one.
    Diagonal {
        /// The tool's place.
        at: Place,
        /// Whether it is the diagonal (1, 1), belt path B; otherwise (1, -1), path A.
        rises: bool,
        /// The force.
        force_n: f64,
    },
    /// Frequency in Hz at which an axis rings.
    Ring {
        /// The tool's place.
        at: Place,
        /// The axis.
        along: Direction,
    },
    /// Frequency in Hz at which the bar yaws.
    YawRing {
        /// The tool's place.
        at: Place,
    },
    /// Damping ratio of the mode of an axis.
    Damping {
        /// The tool's place.
        at: Place,
        /// The axis.
        along: Direction,
    },
    /// How far the tension of the belts turns the bar, in mrad counter-clockwise. It may have either sign.
    Skew {
        /// The tool's place.
        at: Place,
    },
    /// Mass in kg.
    Weight(Weighed),
    /// Force in N at which a motor slips, at the end of a lever on its shaft, without belt.
    Slip {
        /// Length of the lever, from the shaft's axis.
        lever_mm: f64,
    },
}

/// A measured figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The measured property.
    pub figure: Figure,
    /// Its value in the figure's unit, above 0 unless it [has a sign](Figure::has_sign).
    pub measured: f64,
    /// Its standard uncertainty, above 0: a part of the value, of 1, or in its unit if the figure has a sign.
    pub uncertainty: f64,
}

impl Measurement {
    /// Excess of a value of the model, in uncertainties.
    #[must_use]
    pub fn excess(&self, says: f64) -> f64 {
        let excess = if self.figure.has_sign() { says - self.measured } else { ln(says / self.measured) };
        excess / self.uncertainty
    }
}

/// mm in an m, N mm in an N m, and mrad in a rad.
const THOUSAND: f64 = 1000.0;

/// A belt turns no bar if its couple has a lever below this, in mm: rounding.
const NO_COUPLE: f64 = 1e-6;

/// Tension of a plucked string: T = 4 m L^2 f^2 (Mersenne), in N.
///
/// A belt's bending stiffness raises the pitch a little, more for short parts.
#[must_use]
pub fn span_tension_n(length_mm: f64, mass_kg_per_m: f64, frequency_hz: f64) -> f64 {
    4.0 * mass_kg_per_m * square(length_mm / THOUSAND * frequency_hz)
}

impl Figure {
    /// Whether it may be negative or 0.
    #[must_use]
    pub const fn has_sign(&self) -> bool {
        matches!(self, Self::Skew { .. })
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self {
            Self::Pluck { .. } | Self::Ring { .. } | Self::YawRing { .. } => "Hz",
            Self::BeltMass => "kg/m",
            Self::Deflection { .. } | Self::Diagonal { .. } => "mm",
            Self::Damping { .. } => "of critical",
            Self::Skew { .. } => "mrad",
            Self::Weight(_) => "kg",
            Self::Slip { .. } => "N",
        }
    }

    /// Standard uncertainty by the method of docs/research/twin.md; all assumed.
    #[must_use]
    pub const fn usual_uncertainty(&self) -> f64 {
        match self {
            // 1 % of the phone, and 1.5 % of the span's length by a ruler and of its ends that hold it.
            Self::Pluck { .. } => 0.02,
            // Half a metre of belt on a scale of 0.1 g: 0.1 g of 6 g, and 1 mm of its length; for all parts that are
            // plucked alike.
            Self::BeltMass => 0.02,
            // A kitchen scale of 5 g under 600 g.
            Self::Weight(_) => 0.01,
            // A frequency from two seconds of a phone's accelerometer.
            Self::Ring { .. } | Self::YawRing { .. } => 0.015,
            // A dial gauge of 0.01 mm, read to a half of that, under 0.08 mm.
            Self::Deflection { .. } | Self::Diagonal { .. } => 0.06,
            // A spring scale that is pulled until the motor slips.
            Self::Slip { .. } => 0.10,
            // Ratio of a few swings, and no motor, guide or belt damps in proportion to speed alone.
            Self::Damping { .. } => 0.15,
            // 0.05 mm by a square on 300 mm.
            Self::Skew { .. } => 0.17,
        }
    }

    /// The part that this machine lacks for the figure, if it lacks one.
    #[must_use]
    pub fn lacks(&self, machine: Machine, params: &Params) -> Option<&'static str> {
        let lacks = |parameter: Parameter| parameter.parts(machine) == 0;
        match *self {
            Self::Weight(Weighed::Gantry) if lacks(Parameter::GantryMass) => Some("gantry that belts lift"),
            Self::Weight(Weighed::Bed) if lacks(Parameter::BedMass) => Some("bed that a belt moves"),
            Self::Skew { at } if Model::new(machine, params).couples_nmm(at).iter().all(|c| c.abs() < NO_COUPLE) => {
                Some("belts that turn its bar")
            }
            _ => None,
        }
    }

    /// Its value on this machine, in the figure's unit.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn predict(&self, machine: Machine, params: &Params) -> Result<f64, NotHeld> {
        Model::new(machine, params).says(self)
    }
}

/// The model of a machine; remembers modes, because several figures belong to one place.
pub struct Model<'m> {
    machine: Machine,
    params: &'m Params,
    modes: Vec<(Place, Vec<Mode>)>,
}

impl<'m> Model<'m> {
    /// Of this machine.
    #[must_use]
    pub const fn new(machine: Machine, params: &'m Params) -> Self {
        Self { machine, params, modes: Vec::new() }
    }

    /// The model's value of a figure.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn says(&mut self, figure: &Figure) -> Result<f64, NotHeld> {
        let params = self.params;
        Ok(match *figure {
            Figure::Pluck { length_mm, belt } => {
                let pull_of_a_hertz = span_tension_n(length_mm, params.belt_kg_per_m.of(belt), 1.0);
                (params.preload_n.of(belt) / pull_of_a_hertz).sqrt()
            }
            Figure::BeltMass => params.belt_kg_per_m.of(0),
            Figure::Deflection { at, along: Direction::X, force_n } => self.deflection(at, [1.0, 0.0], force_n)?,
            Figure::Deflection { at, along: Direction::Y, force_n } => self.deflection(at, [0.0, 1.0], force_n)?,
            Figure::Diagonal { at, rises, force_n } => {
                let across = if rises { FRAC_1_SQRT_2 } else { -FRAC_1_SQRT_2 };
                self.deflection(at, [FRAC_1_SQRT_2, across], force_n)?
            }
            Figure::Ring { at, along } => self.mode(at, along.into())?.frequency_hz,
            Figure::YawRing { at } => self.mode(at, Coordinate::Yaw)?.frequency_hz,
            Figure::Damping { at, along } => self.mode(at, along.into())?.damping_ratio,
            Figure::Skew { at } => self.skew_mrad(at),
            Figure::Weight(Weighed::Head) => params.head_mass_kg,
            Figure::Weight(Weighed::Bar) => params.bar_mass_kg,
            Figure::Weight(Weighed::Both) => params.head_mass_kg + params.bar_mass_kg,
            Figure::Weight(Weighed::Gantry) => params.gantry_mass_kg,
            Figure::Weight(Weighed::Bed) => params.bed_mass_kg,
            Figure::Slip { lever_mm } => params.holding_torque_nm * THOUSAND / lever_mm,
        })
    }

    fn elastic(&self, at: Place) -> Elastic {
        let freedom = Freedom { idlers: true, rotors: true, yaw: true, free_motor: None };
        Elastic::new(self.machine, self.params, at, freedom)
    }

    fn mode(&mut self, at: Place, of: Coordinate) -> Result<&Mode, NotHeld> {
        let known = self.modes.iter().position(|(place, _)| *place == at);
        let known = match known {
            Some(known) => known,
            None => {
                self.modes.push((at, modes(&self.elastic(at))?));
                self.modes.len() - 1
            }
        };
        self.modes.get(known).and_then(|(_, modes)| mode_of(modes, of)).ok_or(NotHeld)
    }

    /// A force on the head turns the bar, too; the head moves with it.
    fn deflection(&self, at: Place, [x, y]: [f64; 2], force_n: f64) -> Result<f64, NotHeld> {
        let elastic = self.elastic(at);
        let arm = at.x - self.params.width_mm / 2.0;
        let along = |coordinate: &Coordinate| match coordinate {
            Coordinate::X => x,
            Coordinate::Y => y,
            Coordinate::Yaw => y * arm,
            _ => 0.0,
        };
        let row = DVector::from_iterator(elastic.parts.len(), elastic.links.coordinates.iter().map(along));
        Ok(settled(&elastic, &(&row * force_n))?.dot(&row))
    }

    /// The turn at which the guides bear the couple of the tensions. These are the tensions of the turned machine, so
    /// no belt resists them.
    fn skew_mrad(&self, at: Place) -> f64 {
        let couples = self.couples_nmm(at);
        let couple: f64 = couples.iter().enumerate().map(|(belt, nmm)| nmm * self.params.preload_n.of(belt)).sum();
        // N mm over N m/rad are mrad.
        couple / self.params.bar_yaw_stiffness_nm_per_rad
    }

    /// Couple in N mm with which each belt turns the bar, for a tension of 1 N.
    fn couples_nmm(&self, at: Place) -> Vec<f64> {
        let mut couples = vec![0.0; self.machine.belts().len()];
        if !self.machine.has_yawing_bar() {
            return couples;
        }
        let links = Links::segments(self.machine, self.params, at);
        let yaw = links.index(Coordinate::Yaw);
        for link in &links.links {
            let row = yaw.and_then(|yaw| link.row.get(yaw)).copied().unwrap_or_default();
            if let Some(couple) = couples.get_mut(link.belt) {
                *couple -= row;
            }
        }
        couples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predict(figure: Figure) -> f64 {
        figure.predict(Machine::CoreHBot, &Params::default()).unwrap()
    }

    const CENTRE: Place = Place::flat(235.0, 235.0);

    /// A string of 0.4 m and 5 g under 40 N: c = sqrt(40 / 0.0125) = 56.57 m/s, f = c / 0.8 m.
    #[test]
    fn a_span_sounds_as_a_string() {
        let hz = predict(Figure::Pluck { length_mm: 400.0, belt: 0 });
        assert!((hz - 56.5685 / 0.8).abs() < 1e-3, "{hz}");
        assert!((span_tension_n(400.0, 0.0125, hz) - 40.0).abs() < 1e-9);
    }

    /// Stiffnesses and frequencies of an independent computation, with the motors' fields (docs/research/twin.md).
    #[test]
    fn the_model_deflects_and_rings_as_it_does_elsewhere() {
        for (along, n_per_mm, hz) in [(Direction::X, 251.2, 101.38), (Direction::Y, 244.1, 57.64)] {
            let deflection = predict(Figure::Deflection { at: CENTRE, along, force_n: 20.0 });
            assert!((deflection * n_per_mm / 20.0 - 1.0).abs() < 1e-3, "{deflection}");
            let rung = predict(Figure::Ring { at: CENTRE, along });
            assert!((rung / hz - 1.0).abs() < 5e-3, "{rung}");
        }
        // Guides of 2,000 N m/rad, a slender bar of 0.0221 kg m2, and idlers that turn with it.
        let yaw = predict(Figure::YawRing { at: CENTRE });
        assert!((yaw / 44.6 - 1.0).abs() < 2e-3, "{yaw}");
    }

    /// Beside the middle the bar turns, too: F arm^2 / k, with 20 N at 175 mm on 2,000 N m/rad.
    #[test]
    fn a_push_beside_the_middle_turns_the_bar() {
        let push =
            |x: f64| predict(Figure::Deflection { at: Place::flat(x, 235.0), along: Direction::Y, force_n: 20.0 });
        let turned = 20.0 * 0.175_f64.powi(2) / 2000.0 * 1000.0;
        assert!((push(60.0) - push(235.0) - turned).abs() < 1e-3 * turned, "{} {turned}", push(60.0));
    }

    #[test]
    fn scales_and_levers_tell_masses_and_torque() {
        assert_eq!([Weighed::Head, Weighed::Bar].map(|w| predict(Figure::Weight(w))), [0.6, 1.2]);
        assert!((predict(Figure::Weight(Weighed::Both)) - 1.8).abs() < 1e-12);
        assert!((predict(Figure::Slip { lever_mm: 100.0 }) - 4.0).abs() < 1e-12);
    }

    /// One belt pulls both ends of its bar alike; of two, the tighter one turns it.
    #[test]
    fn a_belt_that_is_tighter_than_the_other_skews_the_bar() {
        let skew = |machine, tensions: &[f64]| {
            let params = Params { preload_n: Each::listed(tensions).unwrap(), ..Params::default() };
            Figure::Skew { at: CENTRE }.predict(machine, &params).unwrap()
        };
        use crate::params::Each;
        assert!(skew(Machine::CoreHBot, &[55.0]).abs() < 1e-9 && skew(Machine::CoreXy, &[55.0]).abs() < 1e-9);
        let [left, right] = [[60.0, 40.0], [40.0, 60.0]].map(|both| skew(Machine::CoreXy, &both));
        assert!(left.abs() > 0.05 && (left + right).abs() < 1e-9, "{left} {right}");
    }

    /// 20 N more in one belt, whose ends pull 470 mm apart: 9.4 N m on the guides.
    #[test]
    fn guides_alone_bear_the_couple_of_the_tensions() {
        for (stiffness, mrad) in [(500.0, 18.8), (2000.0, 4.7), (20_000.0, 0.47)] {
            let params = Params {
                preload_n: crate::params::Each::listed(&[60.0, 40.0]).unwrap(),
                bar_yaw_stiffness_nm_per_rad: stiffness,
                ..Params::default()
            };
            for x in [235.0, 100.0] {
                let skew = Figure::Skew { at: Place::flat(x, 235.0) }.predict(Machine::CoreXy, &params).unwrap();
                assert!((skew.abs() / mrad - 1.0).abs() < 1e-9, "{skew} {mrad}");
            }
        }
    }
}
