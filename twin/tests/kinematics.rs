//! The routing tables against what the CoreH-bot paper says of them, and against figures that were computed
//! independently.

use corehbot_twin::geometry::{Layout, layout, workspace};
use corehbot_twin::model::displacements::displacements;
use corehbot_twin::model::links::Links;
use corehbot_twin::model::loads::load;
use corehbot_twin::model::ways::{Ways, residual_mm};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Block, Machine, Place};

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// Places all over what every machine reaches.
fn places() -> impl Iterator<Item = Place> {
    (0..6).flat_map(|i| (0..6).map(move |j| Place::flat(60.0 + 70.0 * f64::from(i), 31.2 + 81.5 * f64::from(j))))
}

#[test]
fn sixty_equations_in_sixty_two_unknowns_have_rank_59() {
    let matrix = displacements(Machine::CoreHBot, &Params::default());
    assert_eq!(matrix.shape(), (60, 62));
    assert!(matrix.iter().all(|entry| [-1.0, 0.0, 1.0].contains(entry)));
    let mut values: Vec<f64> = matrix.svd(false, false).singular_values.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    // One is zero to rounding, the next is far from it.
    assert!(values[0] < 1e-12 && values[1] > 0.05, "{values:?}");
}

/// The paper's equation 10 solved for the motors with the belt at rest on the whole.
#[test]
fn the_sign_table_follows_from_the_routing() {
    let table = [
        (Machine::CoreHBot, vec![[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]]),
        (Machine::HBot, vec![[1.0, 1.0], [1.0, -1.0]]),
        (Machine::CoreXy, vec![[1.0, 1.0], [1.0, -1.0]]),
        (Machine::AwdCoreXy, vec![[1.0, 1.0], [1.0, -1.0], [1.0, 1.0], [1.0, -1.0]]),
    ];
    for (machine, rows) in table {
        let ways = Ways::new(machine, &Params::default());
        for (row, expected) in ways.rows.iter().zip(&rows) {
            assert!(near(row[0], expected[0], 1e-12) && near(row[1], expected[1], 1e-12), "{machine:?}: {row:?}");
        }
        assert_eq!(ways.motors.len(), rows.len());
    }
}

#[test]
fn ten_millimetres_are_eight_hundred_steps_of_each_motor_and_leave_no_residual() {
    let ways = Ways::new(Machine::CoreHBot, &Params::default());
    for (axis, steps) in [[-800.0, -800.0, 800.0, 800.0], [800.0, -800.0, -800.0, 800.0]].iter().enumerate() {
        let turned: Vec<f64> = ways.rows.iter().map(|row| (row[axis] * 10.0 * 80.0).round()).collect();
        assert_eq!(turned, steps);
        assert_eq!(residual_mm(Machine::CoreHBot, &turned), Some(0.0));
        let tool = ways.tool(&turned);
        assert!(near(tool[axis], 800.0, 1e-9) && near(tool[1 - axis], 0.0, 1e-9));
    }
}

/// The four x, y, circulation and residual are an orthogonal transform of the four motors (Hadamard's), each of the
/// length 2.
#[test]
fn tool_circulation_and_residual_are_orthogonal() {
    let ways = Ways::new(Machine::CoreHBot, &Params::default());
    let column = |i: usize| ways.rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let rows = [column(0), column(1), vec![1.0; 4], Machine::CoreHBot.residuals()[0].to_vec()];
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows.iter().enumerate() {
            let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            assert!(near(product, if i == j { 4.0 } else { 0.0 }, 1e-9));
        }
    }
}

#[test]
fn belts_have_the_lengths_of_equations_16_to_18_wherever_the_tool_is() {
    let nominal = Params::default();
    let tight = Params { head_pulleys_mm: 2.0 * nominal.pulley_radius_mm, ..nominal.clone() };
    let point = Params { head_pulleys_mm: 0.0, ..nominal.clone() };
    let table = [
        (Machine::CoreHBot, &tight, 3727.691),
        (Machine::CoreHBot, &nominal, 3593.091),
        (Machine::HBot, &point, 2784.095),
        (Machine::CoreXy, &point, 1874.747),
        (Machine::AwdCoreXy, &point, 1874.747),
    ];
    for (machine, params, length) in table {
        for tool in places() {
            for belt in layout(machine, params, tool).belt_lengths_mm {
                assert!(near(belt, length, 1e-3), "{machine:?} at {tool:?}: {belt}");
            }
        }
    }
}

/// The lengths of the paper's table 1, for a head whose pulleys touch.
#[test]
fn segments_and_wraps_are_those_of_table_1() {
    let params = Params { head_pulleys_mm: 12.7, ..Params::default() };
    let (w, d, r, bar) = (params.width_mm, params.depth_mm, params.pulley_radius_mm, params.bar_pulleys_mm);
    for tool in places() {
        let Place { x, y, .. } = tool;
        let front = [y - bar / 2.0, w - 4.0 * r, y - bar / 2.0, y - 2.0 * r, w - x - r];
        let back = [w - x - r, d - y - 2.0 * r, d - y - bar / 2.0, w - 4.0 * r, d - y - bar / 2.0];
        let left = [d - y - 2.0 * r, x - r, x - r, y - 2.0 * r];
        let expected = front.into_iter().chain(back).chain(left);
        let Layout { segments, wraps, .. } = layout(Machine::CoreHBot, &params, tool);
        assert_eq!(segments.len(), 14);
        assert!(segments.iter().zip(expected).all(|(segment, length)| near(segment.length_mm, length, 1e-9)));
        let stops = Machine::CoreHBot.stops();
        for wrap in wraps {
            let is_half = [1, 4, 6, 8, 11, 13].contains(&stops[wrap.stop].number);
            assert!(near(wrap.angle_rad.to_degrees(), if is_half { 180.0 } else { 90.0 }, 1e-9));
        }
    }
}

#[test]
fn the_tool_reaches_what_equations_20_and_21_say() {
    let nominal = Params::default();
    let tight = Params { head_pulleys_mm: 12.7, ..nominal.clone() };
    let point = Params { head_pulleys_mm: 0.0, ..nominal.clone() };
    let table = [
        (Machine::CoreHBot, &tight, [6.35, 463.65]),
        (Machine::CoreHBot, &nominal, [40.0, 430.0]),
        (Machine::HBot, &point, [12.7, 457.3]),
        (Machine::CoreXy, &point, [12.7, 457.3]),
        (Machine::HBot, &nominal, [52.7, 417.3]),
    ];
    for (machine, params, x) in table {
        let reach = workspace(machine, params);
        assert!(near(reach.x[0], x[0], 1e-9) && near(reach.x[1], x[1], 1e-9), "{machine:?}: {reach:?}");
        // Equation 21 counts y from the belt's line at the head, 19.85 mm in front of the bar's middle.
        assert!(near(reach.y[0], 26.2, 1e-9) && near(reach.y[1], 443.8, 1e-9), "{machine:?}: {reach:?}");
    }
}

#[test]
fn half_a_full_step_of_every_motor_takes_the_tool_a_tenth_of_a_millimetre_at_most() {
    let params = Params::default();
    let ways = Ways::new(Machine::CoreHBot, &params);
    let error = ways.greatest_error_mm(Machine::CoreHBot, &params, 0.9_f64.to_radians());
    assert!(near(error, 0.099_75, 5e-6), "{error}");
}

/// There x + y is (r11 th11 - r4 th4) / 2 and x - y is (r8 th8 - r1 th1) / 2. With a on motors 1 and 8 and b on 4 and
/// 11 they are up to a e and b e, and the tool is off by ((a^2 + b^2) / 2)^(1/2) e.
#[test]
fn with_pulleys_of_two_sizes_the_error_is_between_those_of_each() {
    use corehbot_twin::params::Each;
    let (a, b) = (6.35, 5.08);
    let error = |machine: Machine, radii: &[f64]| {
        let params = Params { motor_radius_mm: Each::listed(radii).unwrap(), ..Params::default() };
        Ways::new(machine, &params).greatest_error_mm(machine, &params, 0.9_f64.to_radians())
    };
    let expected = ((a * a + b * b) / 2.0_f64).sqrt() * 0.9_f64.to_radians();
    for (machine, radii) in
        [(Machine::CoreHBot, vec![a, b, a, b]), (Machine::AwdCoreXy, vec![a, b, a, b]), (Machine::CoreXy, vec![a, b])]
    {
        assert!(near(error(machine, &radii), expected, 1e-9), "{machine:?}: {}", error(machine, &radii));
    }
}

/// One newton more on one side and one less on the other, as the paper loads the belt (equations 26 to 36).
#[test]
fn a_unit_of_tension_pushes_as_the_statics_say() {
    let params = Params::default();
    let patterns = [("R", "L", [0.0, 0.0], [4.0, 0.0]), ("up", "lo", [0.0, 4.0], [0.0, 0.0])];
    for tool in places() {
        let laid = layout(Machine::CoreHBot, &params, tool);
        let links = Links::segments(Machine::CoreHBot, &params, tool).links;
        for (more, less, both, head) in patterns {
            let tension = |span: &str| f64::from(u8::from(span == more)) - f64::from(u8::from(span == less));
            let tensions: Vec<f64> = links.iter().map(|link| tension(link.span)).collect();
            let on_head = load(Machine::CoreHBot, &laid, &tensions, Block::Head, tool);
            let on_bar = load(Machine::CoreHBot, &laid, &tensions, Block::Bar, tool);
            assert!(near(on_head.x_n, head[0], 1e-9) && near(on_head.y_n, head[1], 1e-9), "{on_head:?}");
            assert!(near(on_head.x_n + on_bar.x_n, both[0], 1e-9), "{on_bar:?}");
            assert!(near(on_head.y_n + on_bar.y_n, both[1], 1e-9), "{on_bar:?}");
            // Equations 35 and 37 (with the bar's mass, docs/research/twin.md): none along x, the lever to the middle
            // along y.
            let couple = if more == "R" { 0.0 } else { 2.0 * (params.width_mm - 2.0 * tool.x) };
            assert!(near(on_head.couple_n_mm + on_bar.couple_n_mm, couple, 1e-6), "{on_bar:?} {on_head:?}");
            // Motors turn against each other in pairs: their torques on the frame cancel.
            let torque: f64 = motor_torques(&links, &tensions).iter().sum();
            assert!(near(torque, 0.0, 1e-9));
        }
    }
}

/// Force at the belt that each motor adds for tensions of the segments.
fn motor_torques(links: &[corehbot_twin::model::links::Link], tensions: &[f64]) -> Vec<f64> {
    use corehbot_twin::model::coordinate::Coordinate;
    let coordinates = Links::segments(Machine::CoreHBot, &Params::default(), Place::flat(235.0, 235.0)).coordinates;
    let at = |motor: u8| coordinates.iter().position(|c| *c == Coordinate::Motor(motor)).unwrap();
    let torque = |motor: u8| links.iter().zip(tensions).map(|(link, tension)| link.row[at(motor)] * tension).sum();
    [1, 4, 8, 11].into_iter().map(torque).collect()
}
