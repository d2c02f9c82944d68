//! Machines are found again from what the model says of them, exactly and with noise; what cannot be told is refused.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot_twin::calibration::{
    CalibrateError, Calibrated, Direction, Figure, Measurement, Parameter, Unknown, Weighed, calibrate,
};
use corehbot_twin::params::{Each, Params};
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

/// Tension goes with the square of the pitch and with the belt's mass, which all parts that are plucked share: more of
/// them make the pitch better known and leave the mass as it is.
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

/// A push of x, of which fields are an eighth: a torque that may be off by a factor of two leaves the belt uncertain by
/// that eighth of it, however well the deflection is known.
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

/// Another machine measured by formulae, not by the model: a CoreXY's belts by their free lengths
/// (docs/research/twin.md, closed forms), with motors of 0.4 N m in 50 pole pairs.
mod corexy {
    pub const EA: [f64; 2] = [36_000.0, 27_000.0];
    const W: f64 = 470.0;
    const E: f64 = 40.0;
    const HALF_BAR: f64 = 26.2;

    /// N/mm of each belt at the tool, its motor's field in series: belt A's lengths are L1 and what runs over the
    /// back, belt B's the mirrored ones. The tool moves both ends of each belt by one.
    fn belts(x: f64, y: f64) -> [f64; 2] {
        let (low, high) = (y - HALF_BAR, y + HALF_BAR);
        let over = |x: f64| (x - E) + (W - high) + W + W;
        let [l1, l2] = [low + x - E - 12.7, low + W - 12.7 - x - E];
        let [back1, back2] = [over(W - x), over(x)];
        // Both parts of a belt pull its motor: the field takes u = (k' - k) p / (k' + k + field).
        let field = 0.4 * 1000.0 / 6.35 * 50.0 / 6.35;
        let one = |ea: f64, near: f64, far: f64| {
            let (near, far) = (ea / near, ea / far);
            near + far - (near + far).powi(2) / (near + far + field)
        };
        [one(EA[0], l1, back1), one(EA[1], l2, back2)]
    }

    /// Deflection in mm along x, y and the two diagonals under a force, by both belts as springs along the diagonals.
    pub fn pushed(x: f64, y: f64, force: f64) -> [f64; 4] {
        let [a, b] = belts(x, y);
        // Kxx = Kyy = a + b, Kxy = a - b: along (1, 1) 2 a, along (1, -1) 2 b.
        let axis = force * (a + b) / ((a + b).powi(2) - (a - b).powi(2));
        [axis, axis, force / (2.0 * b), force / (2.0 * a)]
    }
}

/// Deflections by the closed forms of a CoreXY with unlike belts, good to 1 %: along the axes they determine the sum of
/// both belts, along the diagonals each.
#[test]
fn each_belt_of_a_corexy_is_found_from_pushes_along_the_diagonals() {
    // Guides so stiff that the bar does not turn, as in the formulae.
    let nominal = Params { bar_yaw_stiffness_nm_per_rad: 1e6, ..Params::default() };
    let [x, y, falls, rises] = corexy::pushed(235.0, 235.0, 20.0);
    let push = |along| Figure::Deflection { at: CENTRE, along, force_n: 20.0 };
    let diagonal = |rises| Figure::Diagonal { at: CENTRE, rises, force_n: 20.0 };
    let of = |all: &[(Figure, f64)]| {
        let one = |(figure, measured): &(Figure, f64)| Measurement {
            figure: *figure,
            measured: *measured,
            uncertainty: 0.01,
        };
        let all: Vec<Measurement> = all.iter().map(one).collect();
        // All else is known.
        let fixed = &Parameter::ALL[1..];
        calibrate(Machine::CoreXy, &nominal, &all, fixed).unwrap()
    };
    let axes = [(push(Direction::X), x), (push(Direction::Y), y)];
    let sum = of(&axes);
    let belts = |found: &Calibrated| [0, 1].map(|belt| found.params.belt_ea_n.of(belt));
    // The harmonic mean is seen along the axes.
    let uncertain = |found: &Calibrated| {
        let all = found.estimates.iter().chain(&found.not_told);
        all.filter(|e| e.parameter == Parameter::BeltStiffness).map(|e| e.uncertainty).collect::<Vec<_>>()
    };
    assert!(uncertain(&sum).iter().all(|u| *u > 0.1), "{sum:?}");
    assert!(sum.further.iter().any(|further| matches!(further.figure, Figure::Diagonal { .. })), "{:?}", sum.further);
    let each = of(&[axes[0], axes[1], (diagonal(false), falls), (diagonal(true), rises)]);
    let sorted = |mut both: [f64; 2]| {
        both.sort_by(f64::total_cmp);
        both
    };
    for (found, expected) in sorted(belts(&each)).into_iter().zip(sorted(corexy::EA)) {
        assert!((found / expected - 1.0).abs() < 0.02, "{:?}", belts(&each));
    }
    assert!(uncertain(&each).iter().all(|u| *u < 0.02), "{each:?}");
}

/// Yaw, masses and damping of a CoreH-bot in the middle by formulae: the reduced model's closed forms, each field and
/// its rotor in series with the belt. Idlers have mass in the model (0.6 Hz of 109.5), so that figures agree to 1 %.
#[test]
fn closed_forms_of_a_corehbot_give_its_numbers() {
    let (ea, head, bar, yaw, torque, beta) = (41_000.0, 0.5, 1.0, 3500.0, 0.3, 3e-4);
    let field = torque * 1000.0 / 6.35 * 50.0 / 6.35;
    let (rotor_kg, rotor_n_s_per_m) = (5.4e-6 / 6.35e-3_f64.powi(2), 2e-4 / 6.35e-3_f64.powi(2));
    // Kxx = 4 EA (1/LR + 1/LL) with 834.6 mm each, Kyy with 862.2 mm.
    let belt = [834.6, 862.2].map(|length| 8.0 * ea / length);
    let held = |k: f64, field: f64| 1.0 / (1.0 / k + 1.0 / (4.0 * field));
    let k = belt.map(|k| held(k, field));
    // Frequency and damping ratio. A rotor's inertia softens its field; it turns by F / 4 over both.
    let mode = |belt: f64, kg: f64, guide: f64| {
        let mut omega = (held(belt, field) * 1000.0 / kg).sqrt();
        for _ in 0..50 {
            omega = (held(belt, field - rotor_kg * omega * omega / 1000.0) * 1000.0 / kg).sqrt();
        }
        let left = field - rotor_kg * omega * omega / 1000.0;
        let (stretch, turn) = (held(belt, left) / belt, held(belt, left) / (4.0 * left));
        let mass = kg + 4.0 * rotor_kg * turn * turn;
        let friction = beta * belt * 1000.0 * stretch * stretch + 4.0 * rotor_n_s_per_m * turn * turn + guide;
        (omega / std::f64::consts::TAU, friction / (2.0 * mass * omega))
    };
    let [(fx, zx), (fy, zy)] = [mode(belt[0], head, 2.0), mode(belt[1], head + bar, 4.0)];
    let push = |along| Figure::Deflection { at: CENTRE, along, force_n: 20.0 };
    // 175 mm beside the middle the bar turns, too.
    let beside = 20.0 / k[1] + 20.0 * 0.175_f64.powi(2) / yaw * 1000.0;
    let side = Figure::Deflection { at: Place::flat(60.0, 235.0), along: Direction::Y, force_n: 20.0 };
    let all = [
        (HEAD, head, 0.01),
        (BAR, bar, 0.01),
        (SLIP, torque * 10.0, 0.05),
        (push(Direction::X), 20.0 / k[0], 0.03),
        (push(Direction::Y), 20.0 / k[1], 0.03),
        (side, beside, 0.03),
        (ring(CENTRE, Direction::X), fx, 0.015),
        (ring(CENTRE, Direction::Y), fy, 0.015),
        (Figure::Damping { at: CENTRE, along: Direction::X }, zx, 0.05),
        (Figure::Damping { at: CENTRE, along: Direction::Y }, zy, 0.05),
    ];
    let one = |(figure, measured, uncertainty)| Measurement { figure, measured, uncertainty };
    let measurements = all.map(one);
    let found = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]).unwrap();
    let p = &found.params;
    for (found, expected, part) in [
        (p.belt_ea_n.of(0), ea, 0.03),
        (p.head_mass_kg, head, 0.015),
        (p.bar_mass_kg, bar, 0.015),
        (p.bar_yaw_stiffness_nm_per_rad, yaw, 0.04),
        (p.holding_torque_nm, torque, 0.05),
        (p.belt_damping_s, beta, 0.06),
    ] {
        assert!((found / expected - 1.0).abs() < part, "{found} {expected}");
    }
    assert!(found.misfits.iter().all(|misfit| misfit.uncertainties.abs() < 1.0), "{:?}", found.misfits);
    // Each number names what it came from: a scale, a lever, the push beside the middle.
    let from = |parameter| found.estimates.iter().find(|e| e.parameter == parameter).unwrap().from.clone();
    assert_eq!((from(Parameter::HeadMass)[0], from(Parameter::HoldingTorque)[0]), (0, 2));
    assert_eq!(from(Parameter::YawStiffness)[0], 5);
    // One wrong measurement, whichever it is, is named; that it is the one follows from the others.
    for wrong in [0, 3, 6] {
        let mut bad = measurements;
        bad[wrong].measured *= 1.6;
        let answer = calibrate(Machine::CoreHBot, &Params::default(), &bad, &[]);
        let Err(CalibrateError::Unlike(misfits)) = answer else { panic!("{wrong}: {answer:?}") };
        assert!(misfits[wrong].is_suspect, "{wrong}: {misfits:?}");
    }
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

/// Deflections and dampings that guesses explain only together, far from the start: whole Gauss-Newton steps jump to
/// and fro over the minimum there.
#[test]
fn the_search_converges_far_from_the_start() {
    for machine in [Machine::HBot, Machine::CoreHBot, Machine::CoreXy] {
        for (figure, measured) in [
            (push(Direction::X), 0.1),
            (push(Direction::X), 0.15),
            (push(Direction::X), 0.2),
            (ring(CENTRE, Direction::X), 60.0),
            (ring(CENTRE, Direction::X), 75.0),
            (Figure::Damping { at: CENTRE, along: Direction::X }, 0.1),
            (Figure::Damping { at: CENTRE, along: Direction::Y }, 0.04),
        ] {
            let one = Measurement { figure, measured, uncertainty: figure.usual_uncertainty() };
            let weight = Measurement { figure: HEAD, measured: 0.6, uncertainty: 0.01 };
            let answer = calibrate(machine, &Params::default(), &[weight, one], &[]);
            let Ok(found) = answer else { panic!("{machine:?} {figure:?} {measured}: {answer:?}") };
            assert!(found.misfits.iter().all(|m| m.uncertainties.abs() < 3.0), "{machine:?} {figure:?}: {found:?}");
        }
    }
}

/// With equal tensions nothing depends on the stiffness of the yaw, at the start; with the plucked ones the skew does.
/// 60 and 40 N of a CoreXY: 9.4 N m turn guides of 3,000 N m/rad by 3.13 mrad.
#[test]
fn a_number_that_matters_only_away_from_the_start_is_found() {
    let sign = {
        let unlike = Params { preload_n: Each::listed(&[60.0, 40.0]).unwrap(), ..Params::default() };
        Figure::Skew { at: CENTRE }.predict(Machine::CoreXy, &unlike).unwrap().signum()
    };
    // T = 4 m L^2 f^2
    let pluck = |belt: usize, tension: f64| Measurement {
        figure: Figure::Pluck { length_mm: 380.0, belt },
        measured: (tension / (4.0 * 0.0125)).sqrt() / 0.38,
        uncertainty: 0.001,
    };
    let mass = Measurement { figure: Figure::BeltMass, measured: 0.0125, uncertainty: 0.001 };
    let skew = Measurement { figure: Figure::Skew { at: CENTRE }, measured: sign * 9.4 / 3.0, uncertainty: 0.02 };
    let all = [mass, pluck(0, 60.0), pluck(1, 40.0), skew];
    let found = calibrate(Machine::CoreXy, &Params::default(), &all, &[]).unwrap();
    assert!((found.params.bar_yaw_stiffness_nm_per_rad / 3000.0 - 1.0).abs() < 0.01, "{found:?}");
    assert!(told(&found.estimates).contains(&Parameter::YawStiffness), "{found:?}");
}

/// Fifteen times stiffer guides lift the bar's yaw over both axes' frequencies.
#[test]
fn guides_far_stiffer_than_the_nominal_ones_are_found() {
    let stiff = Params { bar_yaw_stiffness_nm_per_rad: 30_000.0, ..Params::default() };
    let side = Place::flat(60.0, 235.0);
    let figures = [
        HEAD,
        BAR,
        SLIP,
        push(Direction::X),
        push(Direction::Y),
        ring(CENTRE, Direction::X),
        ring(side, Direction::Y),
        Figure::YawRing { at: side },
        Figure::Deflection { at: side, along: Direction::Y, force_n: 20.0 },
    ];
    let one = |figure: Figure| Measurement {
        figure,
        measured: figure.predict(Machine::CoreHBot, &stiff).unwrap(),
        uncertainty: 0.002,
    };
    let found = calibrate(Machine::CoreHBot, &Params::default(), &figures.map(one), &[]).unwrap();
    assert!((found.params.bar_yaw_stiffness_nm_per_rad / 30_000.0 - 1.0).abs() < 0.05, "{found:?}");
}

/// A force in the wrong unit leaves no machine in reach; the others fit, and say what it should be.
#[test]
fn a_measurement_out_of_all_reach_is_named() {
    let mut all = measured(&[HEAD, BAR, SLIP], 0.01, || 1.0);
    all[2].measured *= 1e6;
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &all, &[]);
    let Err(CalibrateError::Unlike(misfits)) = answer else { panic!("{answer:?}") };
    assert!(misfits[2].is_suspect && misfits.iter().filter(|m| m.is_suspect).count() == 1, "{misfits:?}");
    assert!(misfits[..2].iter().all(|m| m.uncertainties.abs() < 0.1), "{misfits:?}");
    // The lever's nominal torque.
    assert!((misfits[2].model / 4.0 - 1.0).abs() < 1e-6, "{misfits:?}");
}

/// Two frequencies along y of stiff guides: the search from the nominal stiffness alone ends in another minimum.
#[test]
fn stiff_guides_are_found_past_the_nearest_minimum() {
    let stiff = Params { bar_yaw_stiffness_nm_per_rad: 30_000.0, ..Params::default() };
    let side = Place::flat(60.0, 235.0);
    let one = |figure: Figure| Measurement {
        figure,
        measured: figure.predict(Machine::CoreHBot, &stiff).unwrap(),
        uncertainty: 0.002,
    };
    let measurements = [HEAD, BAR, ring(side, Direction::Y), ring(CENTRE, Direction::Y)].map(one);
    let answer = calibrate(Machine::CoreHBot, &Params::default(), &measurements, &[]);
    let Ok(found) = answer else { panic!("{answer:?}") };
    assert!(found.misfits.iter().all(|m| m.uncertainties.abs() < 3.0), "{:?}", found.misfits);
    assert!(found.params.bar_yaw_stiffness_nm_per_rad > 5000.0, "{:?}", found.params);
}
