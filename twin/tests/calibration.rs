//! Machines are found again from what the model says of them, exactly and with noise; what cannot be told is refused.

mod closed_forms;
mod far;

use corehbot_twin::calibration::{
    CalibrateError, Calibrated, Direction, Figure, Measurement, Parameter, Unknown, Weighed, calibrate,
};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};

const CENTRE: Place = Place::flat(235.0, 235.0);
const CORNER: Place = Place::flat(60.0, 50.0);

const PLUCK: Figure = Figure::Pluck { length_mm: 380.0, belt: 0 };
const HEAD: Figure = Figure::Weight(Weighed::Head);
const BAR: Figure = Figure::Weight(Weighed::Bar);
const SLIP: Figure = Figure::Slip { lever_mm: 100.0 };

const fn ring(at: Place, along: Direction) -> Figure {
    Figure::Ring { at, along }
}

const fn push(along: Direction) -> Figure {
    Figure::Deflection { at: CENTRE, along, force_n: 20.0 }
}

/// All five kinds, and the belt on a scale.
const ALL: [Figure; 9] = [
    PLUCK,
    Figure::BeltMass,
    HEAD,
    BAR,
    SLIP,
    ring(CENTRE, Direction::X),
    ring(CENTRE, Direction::Y),
    push(Direction::X),
    push(Direction::Y),
];

/// The numbers that these determine.
const TOLD: [Parameter; 6] = [
    Parameter::BeltStiffness,
    Parameter::Preload,
    Parameter::BeltMass,
    Parameter::HeadMass,
    Parameter::BarMass,
    Parameter::HoldingTorque,
];

fn other() -> Params {
    Params {
        belt_ea_n: 47_000.0.into(),
        preload_n: 61.0.into(),
        belt_kg_per_m: 0.0117.into(),
        head_mass_kg: 0.43,
        bar_mass_kg: 0.92,
        holding_torque_nm: 0.31,
        ..Params::default()
    }
}

/// What the other machine measures, times a factor for each figure.
fn measured(figures: &[Figure], uncertainty: f64, mut factor: impl FnMut() -> f64) -> Vec<Measurement> {
    let one = |figure: &Figure| Measurement {
        figure: *figure,
        measured: factor() * figure.predict(Machine::CoreHBot, &other()).unwrap(),
        uncertainty,
    };
    figures.iter().map(one).collect()
}

fn found_from(figures: &[Figure], uncertainty: f64, fixed: &[Parameter]) -> Result<Calibrated, CalibrateError> {
    calibrate(Machine::CoreHBot, &Params::default(), &measured(figures, uncertainty, || 1.0), fixed)
}

/// From figures that are known to 1 %.
fn found(figures: &[Figure], fixed: &[Parameter]) -> Result<Calibrated, CalibrateError> {
    found_from(figures, 0.01, fixed)
}

fn uncertainty(found: &Calibrated, parameter: Parameter) -> f64 {
    found.estimates.iter().chain(&found.not_told).find(|e| e.parameter == parameter).unwrap().uncertainty
}

fn told(found: &[corehbot_twin::calibration::Estimate]) -> Vec<Parameter> {
    found.iter().map(|e| e.parameter).collect()
}

/// By what part each estimate is off.
fn errors(found: &Calibrated) -> Vec<(Parameter, f64)> {
    found.estimates.iter().map(|e| (e.parameter, e.value / e.unknown.of(&other()) - 1.0)).collect()
}

#[test]
fn five_kinds_of_measurements_tell_all_numbers() {
    let exact = found_from(&ALL, 1e-5, &[]).unwrap();
    assert_eq!(told(&exact.estimates), TOLD);
    assert!(errors(&exact).iter().all(|(_, error)| error.abs() < 1e-8), "{exact:?}");
    assert!(exact.misfits.iter().all(|misfit| misfit.part.abs() < 1e-8), "{exact:?}");
    // Of figures that are good to 1 % the nominal values, good to a factor of two, take next to nothing away.
    let found = found(&ALL, &[]).unwrap();
    let errors = errors(&found);
    assert!(errors.iter().all(|(_, error)| error.abs() < 1e-3), "{errors:?}");
    // A scale of 1 % alone tells a mass to 1 %; what else weighs on it can only better that.
    let uncertainty = |parameter| uncertainty(&found, parameter);
    assert!(uncertainty(Parameter::HeadMass) < 0.01 && uncertainty(Parameter::HoldingTorque) < 0.01);
    assert!(uncertainty(Parameter::BeltStiffness) < 0.02);
}

/// Tension goes with the square of the pitch and with the belt's mass, which all plucked parts share. More plucked
/// parts make the pitch better known and leave the mass as it is.
#[test]
fn plucking_more_parts_does_not_weigh_the_belt() {
    let preload = |figures: &[Figure]| uncertainty(&found(figures, &[]).unwrap(), Parameter::Preload);
    for count in [1, 4, 100] {
        let plucks = vec![PLUCK; count];
        // The nominal tension is one more look, good to a factor of two.
        let with_mass = |mass: f64| {
            let variance = 4e-4 / count as f64 + mass * mass;
            (1.0 / (1.0 / variance + std::f64::consts::LN_2.powi(-2))).sqrt()
        };
        assert!((preload(&plucks) / with_mass(0.1) - 1.0).abs() < 1e-6);
        // 1 % of the scale; what a belt of this kind usually has is good to a factor of two then, as all that is
        // nominal.
        let weighed = [plucks, vec![Figure::BeltMass]].concat();
        let mass = (1.0 / (1e4_f64 + std::f64::consts::LN_2.powi(-2))).sqrt();
        assert!((preload(&weighed) / with_mass(mass) - 1.0).abs() < 1e-6);
    }
    assert!(found(&[PLUCK], &[]).unwrap().not_told.iter().any(|e| e.parameter == Parameter::BeltMass));
}

/// A belt of steel cords of 21 g/m on a scale that is good to 10 %: its mass is that, not half way to the nominal one.
#[test]
fn a_weighed_belt_has_the_mass_that_the_scale_says() {
    let mass = Measurement { figure: Figure::BeltMass, measured: 0.021, uncertainty: 0.1 };
    let pluck = Measurement { figure: PLUCK, measured: 74.4, uncertainty: 0.02 };
    let found = calibrate(Machine::CoreHBot, &Params::default(), &[mass, pluck], &[]).unwrap();
    assert!((found.params.belt_kg_per_m.of(0) / 0.021 - 1.0).abs() < 0.025, "{found:?}");
    assert!((uncertainty(&found, Parameter::BeltMass) - 0.1).abs() < 0.003, "{found:?}");
    // T = 4 m L^2 f^2, a little nearer to the nominal 40 N by its factor of two.
    let tension = 4.0 * 0.021 * (0.38_f64 * 74.4).powi(2);
    assert!((found.params.preload_n.of(0) / tension - 1.0).abs() < 0.03, "{found:?}");
}

/// Refused is what the others contradict, not what is far from the nominal machine.
#[test]
fn a_fit_that_is_nonsense_is_refused() {
    let with = |figure: Figure, factor: f64| {
        let mut all = measured(&ALL, 0.01, || 1.0);
        all.iter_mut().filter(|m| m.figure == figure).for_each(|m| m.measured *= factor);
        calibrate(Machine::CoreHBot, &Params::default(), &all, &[])
    };
    for (figure, factor) in [(ring(CENTRE, Direction::X), 2.0), (push(Direction::Y), 10.0), (BAR, 1.5)] {
        assert!(matches!(with(figure, factor), Err(CalibrateError::Unlike(_))), "{figure:?}");
    }
    assert!(with(HEAD, 1.02).is_ok());
    // Rigid motors and a softer belt deflect and ring alike.
    let strong = with(SLIP, 20.0).unwrap();
    assert!((strong.params.holding_torque_nm / (20.0 * 0.31) - 1.0).abs() < 0.01, "{strong:?}");
    // A head of 30 kg is unusual, but nothing contradicts it.
    let alone = Measurement { figure: HEAD, measured: 30.0, uncertainty: 0.01 };
    let heavy = calibrate(Machine::CoreHBot, &Params::default(), &[alone], &[]).unwrap();
    assert!((heavy.params.head_mass_kg / 30.0 - 1.0).abs() < 2e-3, "{heavy:?}");
}

/// Fields are an eighth of a push of x. A torque that may be off by a factor of two leaves the belt uncertain by that
/// eighth, however well the deflection is known.
#[test]
fn what_is_not_told_makes_the_rest_uncertain() {
    let nominal = Params::default();
    let belt = |u: f64| {
        let figure = push(Direction::X);
        let moved = figure.predict(Machine::CoreHBot, &nominal).unwrap();
        let push = Measurement { figure, measured: moved, uncertainty: u };
        let found = calibrate(Machine::CoreHBot, &nominal, &[push], &[]).unwrap();
        assert_eq!(told(&found.estimates), [Parameter::BeltStiffness]);
        uncertainty(&found, Parameter::BeltStiffness)
    };
    // Of the compliance: stiffnesses with fields and without, docs/research/twin.md.
    let field: f64 = 1.0 - 251.2 / 287.6;
    let (ratio, prior) = (field / (1.0 - field), std::f64::consts::LN_2);
    // Two normal unknowns, one sum of them told exactly.
    let expected = prior * (ratio * ratio / (1.0 + ratio * ratio)).sqrt();
    assert!((belt(1e-4) / expected - 1.0).abs() < 0.01, "{} {expected}", belt(1e-4));
    assert!(belt(0.06) > 0.11 && belt(0.07) > belt(0.06), "{} {}", belt(0.06), belt(0.07));
}

/// Each of some sets of measurements, ever worse: nothing gets better known by that, and nothing is told that was not.
#[test]
fn worse_measurements_never_tell_more() {
    let rings = [ring(CENTRE, Direction::X), ring(CORNER, Direction::Y)];
    let sets: [&[Figure]; 7] = [
        &ALL,
        &[push(Direction::X)],
        &[push(Direction::X), SLIP],
        &rings,
        &[rings[0], rings[1], HEAD, PLUCK],
        &[PLUCK, Figure::BeltMass],
        &[Figure::Weight(Weighed::Both), HEAD, push(Direction::Y)],
    ];
    let machines = [Params::default(), other()];
    for (figures, machine) in sets.into_iter().flat_map(|set| machines.iter().map(move |machine| (set, machine))) {
        let mut before: Option<Option<Calibrated>> = None;
        for worse in 0..24 {
            let measurements: Vec<Measurement> = figures
                .iter()
                .map(|figure| Measurement {
                    figure: *figure,
                    measured: figure.predict(Machine::CoreHBot, machine).unwrap(),
                    uncertainty: 1e-3 * 1.3_f64.powi(worse),
                })
                .collect();
            let now = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]).ok();
            match (&before, &now) {
                (Some(None), Some(answer)) => panic!("{figures:?} were refused when they were better: {answer:?}"),
                (Some(Some(before)), Some(now)) => {
                    let all: Vec<Parameter> = told(&[&now.estimates[..], &now.not_told].concat());
                    for parameter in all {
                        let [before, now] = [before, now].map(|found| uncertainty(found, parameter));
                        assert!(now >= before * (1.0 - 1e-9), "{figures:?} {parameter:?}: {before} {now}");
                    }
                    assert!(told(&now.estimates).iter().all(|p| told(&before.estimates).contains(p)));
                }
                _ => {}
            }
            before = Some(now);
        }
        // At the end, 42 %, no set tells any stiffness.
        let last = before.unwrap();
        assert!(last.is_none_or(|found| !told(&found.estimates).contains(&Parameter::BeltStiffness)), "{figures:?}");
    }
}

/// Deflections and frequencies give masses without a scale.
#[test]
fn deflections_and_frequencies_weigh_the_machine() {
    let figures =
        [SLIP, ring(CENTRE, Direction::X), ring(CENTRE, Direction::Y), push(Direction::X), push(Direction::Y)];
    let found = found_from(&figures, 1e-4, &[]).unwrap();
    let unasked: Vec<Parameter> = found.unasked.iter().map(|unknown| unknown.parameter).collect();
    assert_eq!(unasked[..2], [Parameter::Preload, Parameter::BeltMass]);
    assert!(found.not_told.is_empty(), "{found:?}");
    assert_eq!(found.params.preload_n, 40.0.into());
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

/// 40 owners measure with 1 % of noise each. Errors over stated uncertainties are normal: 240 of them have a mean
/// square of 1 give or take 0.1 (standard), and none is beyond 4.
#[test]
fn with_noise_the_numbers_are_off_as_the_uncertainties_say() {
    const OWNERS: usize = 40;
    let mut random = Lehmer(20_221);
    let mut scaled = Vec::new();
    for _ in 0..OWNERS {
        let measurements = measured(&ALL, 0.01, || (0.01 * random.normal()).exp());
        let found = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]).unwrap();
        let off = |e: &corehbot_twin::calibration::Estimate| (e.value / e.unknown.of(&other())).ln() / e.uncertainty;
        scaled.extend(found.estimates.iter().map(off));
    }
    let mean_square = scaled.iter().map(|z| z * z).sum::<f64>() / scaled.len() as f64;
    assert_eq!(scaled.len(), 6 * OWNERS);
    assert!((0.7..1.3).contains(&mean_square), "{mean_square}");
    assert!(scaled.iter().all(|z| z.abs() < 4.0), "{scaled:?}");
}

#[test]
fn what_measurements_do_not_tell_is_refused_by_name() {
    let undetermined = |figures: &[Figure], fixed: &[Parameter]| match found(figures, fixed) {
        Err(CalibrateError::Undetermined(unknowns)) => unknowns.iter().map(|u| u.parameter).collect::<Vec<_>>(),
        answer => panic!("{answer:?}"),
    };
    let masses = [Parameter::HeadMass, Parameter::BarMass];
    let belt_and_head = [Parameter::BeltStiffness, Parameter::HeadMass];
    // The same twice: stiffness over mass.
    assert_eq!(undetermined(&[ring(CENTRE, Direction::X); 2], &[]), belt_and_head);
    // Masses known, what is left is the share of belts and of fields: the belt is told as far as that lets it.
    let twice = found(&[ring(CENTRE, Direction::X); 2], &masses).unwrap();
    assert!(uncertainty(&twice, Parameter::BeltStiffness) > 0.1, "{twice:?}");
    assert!(told(&twice.not_told).contains(&Parameter::HoldingTorque));
    // Different figures that depend on the same sum: half of the force moves the tool half as far.
    let half = Figure::Deflection { at: CENTRE, along: Direction::X, force_n: 10.0 };
    let halves = found(&[push(Direction::X), half, HEAD], &[]).unwrap();
    assert!(uncertainty(&halves, Parameter::BeltStiffness) > 0.1, "{halves:?}");
    assert!(told(&halves.not_told).contains(&Parameter::HoldingTorque));
    assert_eq!(undetermined(&[Figure::Weight(Weighed::Both)], &[]), masses);
    // Frequencies alone: all masses and stiffnesses could be greater together.
    let rings = [CENTRE, CORNER].map(|at| [ring(at, Direction::X), ring(at, Direction::Y)]).concat();
    let four = undetermined(&rings, &[]);
    assert!(four.contains(&Parameter::BeltStiffness) && four.contains(&Parameter::HeadMass), "{four:?}");
    assert_eq!(found(&[], &[]), Err(CalibrateError::Nothing));
    assert_eq!(found(&[HEAD], &masses), Err(CalibrateError::Nothing));
    assert_eq!(found(&[HEAD], &Parameter::ALL), Err(CalibrateError::Nothing));
    let unknown = |parameter| Unknown { parameter, part: 0, parts: 1 };
    let text = CalibrateError::Undetermined(belt_and_head.map(unknown).to_vec()).to_string();
    assert!(text.contains("belt_EA_N and head_mass_kg") && text.contains("`fixed`"), "{text}");
}

#[test]
fn a_fixed_number_makes_up_for_what_was_not_told() {
    let start = Params { holding_torque_nm: other().holding_torque_nm, ..Params::default() };
    let figures = measured(&[push(Direction::X), ring(CENTRE, Direction::X)], 1e-4, || 1.0);
    let found = calibrate(Machine::CoreHBot, &start, &figures, &[Parameter::HoldingTorque]).unwrap();
    assert_eq!(told(&found.estimates), [Parameter::BeltStiffness, Parameter::HeadMass]);
    assert!(errors(&found).iter().all(|(_, error)| error.abs() < 1e-6), "{found:?}");
}

#[test]
fn a_measurement_that_no_machine_makes_is_told() {
    let far = Measurement { figure: SLIP, measured: 4e6, uncertainty: 0.01 };
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &[far], &[]);
    assert_eq!(answer, Err(CalibrateError::NoMachine));
    // One of three scales is wrong by a half.
    let mut scales = measured(&[HEAD; 3], 0.01, || 1.0);
    scales[2].measured *= 1.5;
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &scales, &[]);
    let Err(CalibrateError::Unlike(misfits)) = answer else { panic!("{answer:?}") };
    assert!(misfits[2].uncertainties < -20.0 && misfits[2].is_suspect, "{misfits:?}");
}

/// Scales of 1 % that differ by 4 %: what they differ makes the mass as uncertain as they are, not as they claim.
#[test]
fn measurements_that_differ_more_than_stated_are_believed_less() {
    let weigh = |differs: f64| {
        let scale = |sign: f64| Measurement { figure: HEAD, measured: 0.6 * (1.0 + sign * differs), uncertainty: 0.01 };
        calibrate(Machine::CoreHBot, &Params::default(), &[1.0, -1.0, 1.0, -1.0].map(scale), &[]).unwrap()
    };
    let [alike, unlike] = [weigh(0.005), weigh(0.03)];
    assert!((alike.spread - 1.0).abs() < 1e-9 && (alike.estimates[0].uncertainty - 0.005).abs() < 1e-4);
    // Four scales, one unknown: the root of 4 times 3 squares over 3.
    let spread = (4.0_f64 * 9.0 / 3.0).sqrt();
    assert!((unlike.spread / spread - 1.0).abs() < 0.01, "{}", unlike.spread);
    assert!((unlike.estimates[0].uncertainty / (0.005 * spread) - 1.0).abs() < 0.01, "{unlike:?}");
}

/// What would help most does help: measured, it leaves the uncertainty that was foretold.
#[test]
fn the_next_measurement_helps_as_foretold() {
    let few = measured(&[HEAD, BAR, ring(CENTRE, Direction::X)], 0.01, || 1.0);
    let found = calibrate(Machine::CoreHBot, &other(), &few, &[]).unwrap();
    assert!(!found.further.is_empty() && found.further.windows(2).all(|pair| pair[0].removes >= pair[1].removes));
    for further in &found.further {
        let next = Measurement {
            figure: further.figure,
            measured: further.figure.predict(Machine::CoreHBot, &other()).unwrap(),
            uncertainty: further.figure.usual_uncertainty(),
        };
        let then = calibrate(Machine::CoreHBot, &other(), &[&few[..], &[next]].concat(), &[]).unwrap();
        for improved in &further.improves {
            let known = uncertainty(&then, improved.parameter);
            assert!((known / improved.then - 1.0).abs() < 0.02, "{further:?}: {known}");
        }
    }
}
