//! Machines that were measured by formulae, not by the model.

use super::{BAR, CENTRE, HEAD, SLIP, ring};
use corehbot_twin::calibration::{CalibrateError, Calibrated, Direction, Figure, Measurement, Parameter, calibrate};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};

/// A CoreXY's belts by their free lengths (docs/research/twin.md, closed forms), with motors of 0.4 N m in 50 pole
/// pairs.
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
