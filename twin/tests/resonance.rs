//! Frequencies over the reach, and zig-zag of motors that step one after the other.

use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::model::ways::{Ways, residual_mm};
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::resonance::Resonance;
use corehbot_twin::routing::Machine;
use corehbot_twin::shaping::wall::Print;

/// With fixed motors x rings by x alone and y by y alone: 13.1 and 14.3 % faster at the ends than in the middle.
#[test]
fn axes_of_a_corehbot_ring_by_their_own_place_alone() {
    let found = Resonance::new(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), 5, 5).unwrap();
    let rise = |[low, high]: [f64; 2]| high / low - 1.0;
    assert!((rise(found.x.band_hz) - 0.131).abs() < 1e-3, "{:?}", found.x.band_hz);
    assert!((rise(found.y.band_hz) - 0.143).abs() < 1e-3, "{:?}", found.y.band_hz);
    assert!(found.x.coupling.abs() < 1e-9 && found.y.coupling.abs() < 1e-9);
    for row in &found.x.frequencies_hz {
        assert!(row.iter().zip(&found.x.frequencies_hz[0]).all(|(a, b)| (a - b).abs() < 1e-6));
    }
    // Belt damping 2e-4 s and guides of 2 and 4 N s/m.
    assert!((found.y.damping_ratio - (0.039_33 + 0.002_83)).abs() < 1e-4, "{}", found.y.damping_ratio);
    assert!((found.x.damping_ratio - (0.069_23 + 0.002_41)).abs() < 1e-4, "{}", found.x.damping_ratio);
    assert!(found.y.line.starts_with("M593 Y F"), "{}", found.y.line);
}

/// The bar on guides of 2,000 N m/rad, below both axes: 44.6 Hz with the head in the middle (docs/research/twin.md).
/// Off the middle inertia makes it slower, `I = m W^2 / 12 + M (x - W / 2)^2` coupled with y. A CoreXY's belts hold the
/// bar, so it yaws faster than y rings.
#[test]
fn the_yaw_of_the_bar_is_told_and_that_no_shaper_is_made_for_it() {
    let rotors = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let setup = Setup { freedom: rotors, ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let found = Resonance::new(&setup, 3, 3).unwrap();
    let yaw = found.yaw.as_ref().unwrap();
    assert!((yaw.frequencies_hz[1][1] - 44.6).abs() < 0.05, "{yaw:?}");
    let [low, high] = yaw.band_hz;
    assert!((30.0..34.0).contains(&low) && high < found.y.band_hz[0] && high < found.x.band_hz[0], "{yaw:?}");
    // Guides with 4 N s/m in all at both ends of the bar: `c = 4 (W/2)^2`, and the ratio is `c w / 2k`.
    let known = 4.0 * 0.235 * 0.235 * std::f64::consts::TAU * 44.6 / (2.0 * 2000.0);
    assert!((yaw.damping_ratio / known - 1.0).abs() < 0.01, "{yaw:?}: {known}");
    // An MZV for 60 Hz does little about 31 to 45 Hz.
    assert!(yaw.left_by_y.is_some_and(|left| (0.2..1.0).contains(&left)), "{yaw:?}");
    let text = found.to_string();
    assert!(text.contains("yaw of the bar on its guides") && text.contains("no line above is made for it"), "{text}");
    let corexy = Resonance::new(&Setup { machine: Machine::CoreXy, ..setup }, 3, 3).unwrap();
    let yaw = corexy.yaw.unwrap();
    assert!(yaw.frequencies_hz[1][1] > corexy.y.frequencies_hz[1][1], "{yaw:?}");
}

/// Where segments end or pulleys lie above each other too.
#[test]
fn every_machine_rings_at_every_place_up_to_the_ends_of_its_reach() {
    for machine in Machine::ALL {
        for freedom in [Freedom::default(), Freedom { idlers: true, rotors: true, ..Freedom::default() }] {
            let setup = Setup { freedom, ..Setup::nominal(machine, 235.0, 235.0) };
            let found = Resonance::new(&setup, 3, 3).unwrap();
            for axis in [&found.x, &found.y] {
                let all = axis.frequencies_hz.iter().flatten();
                assert!(all.clone().all(|hz| (40.0..1000.0).contains(hz)), "{machine:?}: {axis:?}");
            }
        }
    }
}

#[test]
fn speeds_that_excite_an_axis_are_its_frequency_times_what_repeats() {
    let rotors = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let setup = Setup { freedom: rotors, ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let found = Resonance::new(&setup, 3, 3).unwrap();
    let rise = |[low, high]: [f64; 2]| high / low - 1.0;
    // Motors that give way flatten the rise to 7 to 11 %.
    assert!(rise(found.x.band_hz) < 0.115 && rise(found.y.band_hz) < 0.12);
    // So a shaper of 3/4 of a period is enough everywhere.
    assert!(found.x.line.ends_with("T2") && found.y.line.ends_with("T2"), "{} {}", found.x.line, found.y.line);
    assert!((found.y.resonant_speeds.tooth_mm_s - 2.0 * 57.64).abs() < 0.6, "{:?}", found.y.resonant_speeds);
    assert!((found.y.resonant_speeds.full_step_mm_s - 0.1995 * 57.64).abs() < 0.06);
}

/// The text rates each line as it is printed: the two parts of a ZV against the vibration at both ends of the band,
/// written out here.
#[test]
fn both_lines_are_rated_as_they_are_printed() {
    let rotors = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let setup = Setup { freedom: rotors, ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let found = Resonance::new(&setup, 7, 7).unwrap().ranked_by_tool(&Print::default());
    let text = found.to_string();
    for (axis, line, told) in [(&found.x, "M593 X F108.5", "ZV 10.2 %."), (&found.y, "M593 Y F62.3", "ZV 11.1 %.")] {
        assert!(axis.line_by_tool.as_ref().is_some_and(|own| own.starts_with(line) && own.ends_with("T0")), "{text}");
        assert!(text.contains(told), "{text}");
        // The line's own numbers: two parts, half a damped period apart.
        let ranked = axis.by_tool.as_ref().unwrap();
        let left = |hz: f64| {
            let (shaper, own) = (ranked.damping_ratio, axis.damping_ratio);
            let root = |z: f64| (1.0 - z * z).sqrt();
            let late_s = 0.5 / (ranked.suggestion.frequency_hz * root(shaper));
            let part = (-std::f64::consts::PI * shaper / root(shaper)).exp();
            let w = std::f64::consts::TAU * hz;
            // The first part has decayed when the second one comes.
            let (first, turn) = ((-own * w * late_s).exp(), w * root(own) * late_s);
            (first + part * turn.cos()).hypot(part * turn.sin()) / (1.0 + part)
        };
        let known = axis.band_hz.map(left).into_iter().fold(0.0, f64::max);
        assert!((ranked.suggestion.worst_residual - known).abs() < 1e-9, "{ranked:?}: {known}");
    }
}

/// One step of an axis, made by motors one after the other in this order: the tool's greatest way aside, and the
/// greatest residual, in steps.
fn zigzag(machine: Machine, axis: usize, order: &[usize]) -> (f64, f64) {
    let ways = Ways::new(machine, &Params::default());
    let mut turned = vec![0.0; ways.motors.len()];
    let (mut aside, mut strain) = (0.0_f64, 0.0_f64);
    for motor in order {
        turned[*motor] += ways.rows[*motor][axis];
        aside = aside.max(ways.tool(&turned)[1 - axis].abs());
        strain = strain.max(residual_mm(machine, &turned).unwrap_or(0.0).abs());
    }
    (aside, strain)
}

/// All orders of four.
fn orders() -> Vec<Vec<usize>> {
    let mut orders = Vec::new();
    for code in 0..256_usize {
        let order: Vec<usize> = (0..4).map(|i| code >> (2 * i) & 3).collect();
        if (0..4).all(|motor| order.contains(&motor)) {
            orders.push(order);
        }
    }
    orders
}

/// Motors that step one after the other take the tool aside by half a step on a CoreXY. On a CoreH-bot it is a quarter
/// if pairs follow each other, and half in the worst order. Motors that step together do not take it aside.
#[test]
fn motors_one_after_the_other_zig_zag() {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
    for axis in [0, 1] {
        assert!(near(zigzag(Machine::CoreXy, axis, &[0, 1]).0, 0.5));
        assert!(near(zigzag(Machine::CoreXy, axis, &[1, 0]).0, 0.5));
        let all: Vec<(f64, f64)> = orders().iter().map(|order| zigzag(Machine::CoreHBot, axis, order)).collect();
        assert_eq!(all.len(), 24);
        assert!(near(all.iter().map(|(aside, _)| *aside).fold(0.0, f64::max), 0.5));
        assert!(near(all.iter().map(|(aside, _)| *aside).fold(1.0, f64::min), 0.25));
    }
    // +x by the order 1, 4, 8, 11; +y by 1, 11, 4, 8.
    for (axis, order) in [(0, [0, 1, 2, 3]), (1, [0, 3, 1, 2])] {
        let (aside, strain) = zigzag(Machine::CoreHBot, axis, &order);
        assert!(near(aside, 0.25) && near(strain, 1.0), "{aside} {strain}");
    }
}
