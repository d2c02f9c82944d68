//! Machines are found again from what the model says of them, exactly and with noise; what cannot be told is refused.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot_twin::calibration::{
    CalibrateError, Calibrated, Direction, Figure, Measurement, Parameter, Weighed, calibrate,
};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};

const CENTRE: Place = Place { x: 235.0, y: 235.0 };
const CORNER: Place = Place { x: 60.0, y: 50.0 };

const PLUCK: Figure = Figure::Pluck { length_mm: 380.0, mass_kg_per_m: 0.0125 };
const HEAD: Figure = Figure::Weight(Weighed::Head);
const BAR: Figure = Figure::Weight(Weighed::Bar);
const SLIP: Figure = Figure::Slip { lever_mm: 100.0 };

const fn ring(at: Place, along: Direction) -> Figure {
    Figure::Ring { at, along }
}

const fn push(along: Direction) -> Figure {
    Figure::Deflection { at: CENTRE, along, force_n: 20.0 }
}

/// All five kinds.
const ALL: [Figure; 8] = [
    PLUCK,
    HEAD,
    BAR,
    SLIP,
    ring(CENTRE, Direction::X),
    ring(CENTRE, Direction::Y),
    push(Direction::X),
    push(Direction::Y),
];

fn other() -> Params {
    Params {
        belt_ea_n: 47_000.0,
        preload_n: 61.0,
        head_mass_kg: 0.43,
        bar_mass_kg: 0.92,
        holding_torque_nm: 0.31,
        ..Params::default()
    }
}

/// What the other machine measures, times a factor for each figure, each known to 1 %.
fn measured(figures: &[Figure], mut factor: impl FnMut() -> f64) -> Vec<Measurement> {
    let one = |figure: &Figure| Measurement {
        figure: *figure,
        measured: factor() * figure.predict(Machine::CoreHBot, &other()).unwrap(),
        uncertainty: 0.01,
    };
    figures.iter().map(one).collect()
}

fn found(figures: &[Figure], fixed: &[Parameter]) -> Result<Calibrated, CalibrateError> {
    calibrate(Machine::CoreHBot, &Params::default(), &measured(figures, || 1.0), fixed)
}

/// By what part each estimate is off.
fn errors(found: &Calibrated) -> Vec<(Parameter, f64)> {
    found.estimates.iter().map(|e| (e.parameter, e.value / e.parameter.of(&other()) - 1.0)).collect()
}

#[test]
fn five_kinds_of_measurements_tell_all_five_numbers() {
    let found = found(&ALL, &[]).unwrap();
    assert_eq!(found.estimates.len(), 5);
    assert!(found.not_told.is_empty());
    assert!(errors(&found).iter().all(|(_, error)| error.abs() < 1e-6), "{found:?}");
    assert!(found.misfits.iter().all(|misfit| misfit.part.abs() < 1e-8), "{found:?}");
    // A scale of 1 % alone tells a mass to 1 %; what else weighs on it can only better that.
    let uncertainty = |parameter| found.estimates.iter().find(|e| e.parameter == parameter).unwrap().uncertainty;
    assert!(uncertainty(Parameter::HeadMass) < 0.01 && uncertainty(Parameter::HoldingTorque) < 0.01);
    // Tension goes with the square of the pitch.
    assert!((uncertainty(Parameter::Preload) - 0.02).abs() < 1e-6);
    assert!(uncertainty(Parameter::BeltStiffness) < 0.02);
}

/// Deflections and frequencies give masses without a scale.
#[test]
fn deflections_and_frequencies_weigh_the_machine() {
    let figures =
        [SLIP, ring(CENTRE, Direction::X), ring(CENTRE, Direction::Y), push(Direction::X), push(Direction::Y)];
    let found = found(&figures, &[]).unwrap();
    assert_eq!(found.not_told, [Parameter::Preload]);
    assert_eq!(found.params.preload_n, 40.0);
    assert_eq!(found.estimates.len(), 4);
    assert!(errors(&found).iter().all(|(_, error)| error.abs() < 1e-6), "{found:?}");
}

/// Uniform in 0 to 1: Lehmer's generator with the multiplier that Park and Miller came to prefer (CACM 36, 1993).
struct Lehmer(u64);

impl Lehmer {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    /// Normal with standard deviation 1: the sum of twelve uniform numbers.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// 40 owners measure with 1 % of noise each. Errors over stated uncertainties are normal: 200 of them have a mean square of
/// 1 give or take 0.1 (standard), and none is beyond 4.
#[test]
fn with_noise_the_numbers_are_off_as_the_uncertainties_say() {
    const OWNERS: usize = 40;
    let mut random = Lehmer(20_221);
    let mut scaled = Vec::new();
    for _ in 0..OWNERS {
        let measurements = measured(&ALL, || (0.01 * random.normal()).exp());
        let found = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]).unwrap();
        let off = |e: &corehbot_twin::calibration::Estimate| (e.value / e.parameter.of(&other())).ln() / e.uncertainty;
        scaled.extend(found.estimates.iter().map(off));
    }
    let mean_square = scaled.iter().map(|z| z * z).sum::<f64>() / scaled.len() as f64;
    assert_eq!(scaled.len(), 5 * OWNERS);
    assert!((0.7..1.3).contains(&mean_square), "{mean_square}");
    assert!(scaled.iter().all(|z| z.abs() < 4.0), "{scaled:?}");
}

#[test]
fn what_measurements_do_not_tell_is_refused_by_name() {
    let undetermined = |figures: &[Figure], fixed: &[Parameter]| match found(figures, fixed) {
        Err(CalibrateError::Undetermined(parameters)) => parameters,
        answer => panic!("{answer:?}"),
    };
    let masses = [Parameter::HeadMass, Parameter::BarMass];
    let belt_and_motors = [Parameter::BeltStiffness, Parameter::HoldingTorque];
    // The same twice.
    let twice = [ring(CENTRE, Direction::X); 2];
    assert_eq!(undetermined(&twice, &masses), belt_and_motors);
    // Different figures that depend on the same sum: half of the force moves the tool half as far.
    let half = Figure::Deflection { at: CENTRE, along: Direction::X, force_n: 10.0 };
    assert_eq!(undetermined(&[push(Direction::X), half, HEAD], &[]), belt_and_motors);
    assert!(undetermined(&[Figure::Weight(Weighed::Both)], &[]).contains(&Parameter::BarMass));
    // Frequencies alone: all masses and stiffnesses could be greater together.
    let rings = [CENTRE, CORNER].map(|at| [ring(at, Direction::X), ring(at, Direction::Y)]).concat();
    let four = undetermined(&rings, &[]);
    assert!(four.contains(&Parameter::BeltStiffness) && four.contains(&Parameter::HeadMass), "{four:?}");
    assert_eq!(found(&[], &[]), Err(CalibrateError::Nothing));
    assert_eq!(found(&[HEAD], &masses), Err(CalibrateError::Nothing));
    let text = CalibrateError::Undetermined(belt_and_motors.to_vec()).to_string();
    assert!(text.contains("belt_EA_N and holding_torque_Nm") && text.contains("`fixed`"), "{text}");
}

#[test]
fn a_fixed_number_makes_up_for_what_was_not_told() {
    let start = Params { holding_torque_nm: other().holding_torque_nm, ..Params::default() };
    let figures = measured(&[push(Direction::X), ring(CENTRE, Direction::X)], || 1.0);
    let found = calibrate(Machine::CoreHBot, &start, &figures, &[Parameter::HoldingTorque]).unwrap();
    assert_eq!(
        found.estimates.iter().map(|e| e.parameter).collect::<Vec<_>>(),
        [Parameter::BeltStiffness, Parameter::HeadMass]
    );
    assert!(errors(&found).iter().all(|(_, error)| error.abs() < 1e-6), "{found:?}");
}

#[test]
fn a_measurement_that_no_machine_makes_is_told() {
    let far = Measurement { figure: SLIP, measured: 4e6, uncertainty: 0.01 };
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &[far], &[]);
    assert_eq!(answer, Err(CalibrateError::NoMachine));
    // One of three scales is wrong by a half.
    let mut scales = measured(&[HEAD; 3], || 1.0);
    scales[2].measured *= 1.5;
    let found = calibrate(Machine::CoreHBot, &Params::default(), &scales, &[]).unwrap();
    assert!(found.misfits[2].uncertainties < -20.0, "{found:?}");
}
