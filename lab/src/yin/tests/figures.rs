//! Figures 3 to 5 on the assumed rig, against figures computed elsewhere.

use super::super::figure::{Figure3, Figure4, Figure5, WAYS};
use super::super::*;
use super::assert_close;
use crate::queries::claim::Claim;
use crate::yin::fit::{exponent, line};

fn holds(claims: &[Claim], begins: &str) -> bool {
    claims.iter().find(|claim| claim.text.starts_with(begins)).unwrap_or_else(|| panic!("{claims:?}")).holds
}

#[test]
fn figure_3_has_the_independent_errors_in_both_directions() {
    let figure = Figure3::new(&NOMINAL, &Case::at(0.0)).unwrap();
    // mm from x to y and from y to x, by the full and by the 4-DoF model.
    let table = [
        [[0.2414, 0.0994], [0.2432, 0.0586]],
        [[0.4097, 0.1638], [0.4114, 0.0994]],
        [[0.7669, 0.3063], [0.7690, 0.1962]],
    ];
    assert_eq!(figure.panels.len(), 6);
    for (panel, expected) in figure.panels.iter().zip(table.iter().chain(&table)) {
        for (path, expected) in panel.paths.iter().zip(expected) {
            for (found, expected) in path.errors.both().into_iter().zip(expected) {
                assert_close(found, *expected, 0.003, &format!("{} {}", panel.speed_m_s, panel.direction));
            }
            // The path cuts its corner by this much: no place is nearer to the corner from x to y.
            let corner = if panel.direction == WAYS[0].1 { [0.0, 20.0] } else { [20.0, 20.0] };
            let nearest = path.places.iter().map(|[x, y]| (x - corner[0]).hypot(y - corner[1])).fold(9.0, f64::min);
            assert!((0.6 * expected[0]..1.1 * expected[0]).contains(&nearest), "{nearest} {expected:?}");
        }
    }
    assert!(holds(&figure.claims, "the error is larger from x to y") && holds(&figure.claims, "x has the larger"));
}

#[test]
fn figure_4_has_the_independent_lines() {
    let figure = Figure4::new(&NOMINAL, &Case::at(0.0)).unwrap();
    // The independent lines go through five of the nine speeds.
    let theirs = [0.010, 0.020, 0.039, 0.060, 0.079];
    for trend in figure.trends.iter().filter(|trend| trend.model == "full-DoF") {
        for (turn, (slope, intercept)) in [(8.885, 0.064), (3.459, 0.031)].into_iter().enumerate() {
            let points: Vec<_> = trend.points(turn).into_iter().filter(|(speed, _)| theirs.contains(speed)).collect();
            assert_eq!(points.len(), theirs.len());
            let line = line(&points);
            assert_close(line.slope, slope, 0.002, "slope");
            assert!((line.intercept - intercept).abs() < 0.001, "{line:?}");
        }
    }
    assert!(holds(&figure.claims, "the errors are linear") && holds(&figure.claims, "the 4-DoF model predicts"));
    // Not borne out: 0 to 1 % more from x to y.
    assert!(!holds(&figure.claims, "... and from x to y") && holds(&figure.claims, "(ours) the way round"));
}

#[test]
fn figure_5_has_the_independent_errors() {
    let figure = Figure5::new(&NOMINAL, &Case::at(0.0)).unwrap();
    let table = [
        ("friction", [0.3059, 0.5039, 0.7669, 1.1201, 1.6076], [1.20, 1.57]),
        ("stiffness", [1.5842, 1.1058, 0.7669, 0.5265, 0.3563], [-1.08, -1.27]),
        ("mass", [0.7920, 0.7819, 0.7669, 0.7446, 0.7126], [-0.08, -0.25]),
    ];
    for (one, (name, errors, exponents)) in figure.varied.iter().zip(table.iter().chain(&table)) {
        assert_eq!(one.name, *name);
        // The independent errors are at every second factor.
        assert_eq!(one.errors.len(), 2 * errors.len() - 1);
        for (found, expected) in one.errors.iter().step_by(2).zip(errors) {
            assert_close(found.x_to_y_mm, *expected, 0.002, name);
        }
        for (turn, expected) in exponents.iter().enumerate() {
            let points: Vec<_> = one.points(turn).into_iter().step_by(2).collect();
            let found = exponent(&points);
            assert!((found - expected).abs() <= 0.02, "{name}: {found:?}");
        }
    }
    let claims = &figure.claims;
    assert!(holds(claims, "the error is inversely") && holds(claims, "the error depends little on masses"));
    assert!(!holds(claims, "the error is proportional to friction"));
}
