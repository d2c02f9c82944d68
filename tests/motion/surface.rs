//! A surface under the motion: z follows it within half a step, and nothing else feels it.

use super::shaped::positions;
use super::timing::{groups, steps_of, wander};
use crate::dice::Dice;
use crate::line::{Step, generate_from, on_mesh, plan, shaping, target};
use corehbot::motion::{Move, MoveMemory, Planner, WHOLE, Work};
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::surface::{Heights, Mesh, UNITS_PER_MM};
use corehbot::units::{Hertz, Mm, Ratio, Seconds, SubTicks};

/// The group of the Z screws.
const Z: usize = 2;

/// A mesh over most of the bed, with heights up to `most` mm up and down.
fn mesh(points: usize, most: f64, fade: f64, seed: u64) -> Mesh {
    let mut dice = Dice(seed);
    let filled = Heights::filled(points, points, |_, _| {
        Some(((2.0 * dice.roll() - 1.0) * most * f64::from(UNITS_PER_MM)).round() as i16)
    });
    let (first, last) = ([Mm::from_num(30); 2], [Mm::from_num(350), Mm::from_num(360)]);
    Mesh::new(filled.unwrap_or(Heights::NONE), first, last, Mm::from_num(fade)).unwrap()
}

/// The law by itself: Catmull-Rom by differences, in double precision.
struct Law {
    points: Vec<Vec<f64>>,
    first: [f64; 2],
    cell: [f64; 2],
    mean: f64,
    fade: f64,
}

fn along(line: &[f64], at: f64) -> f64 {
    let last = line.len() - 1;
    let at = at.clamp(0.0, last as f64);
    let i = (at as usize).min(last - 1);
    let t = at - i as f64;
    let (p1, p2) = (line[i], line[i + 1]);
    let p0 = if i == 0 { 2.0 * p1 - p2 } else { line[i - 1] };
    let p3 = if i + 1 == last { 2.0 * p2 - p1 } else { line[i + 2] };
    let (m1, m2) = ((p2 - p0) / 2.0, (p3 - p1) / 2.0);
    let (d, s) = (p2 - p1, m1 + m2);
    p1 + t * (m1 + t * (3.0 * d - m1 - s + t * (s - 2.0 * d)))
}

impl Law {
    fn new(mesh: &Mesh) -> Self {
        let heights = mesh.heights();
        let unit = 1.0 / f64::from(UNITS_PER_MM);
        let row = |row| (0..heights.columns()).map(|column| f64::from(heights.get(column, row)) * unit).collect();
        let (first, last) = (mesh.first().map(Mm::to_num::<f64>), mesh.last().map(Mm::to_num::<f64>));
        let cells = [heights.columns() - 1, heights.rows() - 1];
        let points: Vec<Vec<f64>> = (0..heights.rows()).map(row).collect();
        let mean = points.iter().flatten().sum::<f64>() / points.iter().flatten().count() as f64;
        let cell = std::array::from_fn(|i| (last[i] - first[i]) / cells[i] as f64);
        Self { points, first, cell, mean, fade: mesh.fade().to_num() }
    }

    /// Real z in mm.
    fn raised(&self, [x, y, z]: [f64; 3]) -> f64 {
        let [u, v] = [(x - self.first[0]) / self.cell[0], (y - self.first[1]) / self.cell[1]];
        let column: Vec<f64> = self.points.iter().map(|row| along(row, u)).collect();
        let height = along(&column, v);
        let share = if self.fade > 0.0 { (1.0 - z / self.fade).clamp(0.0, 1.0) } else { 1.0 };
        z + self.mean + share * (height - self.mean)
    }
}

fn settings(kind: ShaperKind, advance: f64) -> Settings {
    let mut s = Settings::prototype();
    let shaper = Shaper::new(kind, Hertz::from_num(60), Ratio::from_num(0.05));
    (s.shapers.x, s.shapers.y) = (shaper, shaper);
    s.advance.time = Seconds::from_num(advance);
    s
}

fn steps_on(mesh: &Mesh, moves: &[Move], s: &Settings) -> Vec<Step> {
    generate_from(shaping(s).chain(on_mesh(mesh, s)).chain(moves.iter().map(|m| Work::Move(*m))), s)
}

/// The steps of z, and by how much they come too early or too late, in steps.
fn errors(targets: &[([f64; 4], f64)], mesh: &Mesh, s: &Settings) -> (usize, f64) {
    let (moves, law) = (plan(targets, s), Law::new(mesh));
    let (positions, steps) = (positions(targets, &moves, s), steps_on(mesh, &moves, s));
    let per_mm = s.axes.map(|axis| axis.steps_per_mm.to_num::<f64>()).to_array();
    let real = |tick: f64| {
        let at = positions(tick / 1e7);
        law.raised([at[0] / per_mm[0], at[1] / per_mm[1], at[2] / per_mm[2]]) * per_mm[2]
    };
    // It begins at the origin of the planner without a step, which is the surface there.
    let mut at = (real(0.0) + 0.5).floor() as i64;
    let mut of_z = steps_of(&steps, Z).into_iter().peekable();
    let count = of_z.len();
    let mut worst = 0f64;
    for step in &steps {
        let exact = real(step.tick as f64);
        while let Some((_, way)) = of_z.next_if(|(tick, _)| *tick <= step.tick) {
            let edge = at as f64 + 0.5 * f64::from(way);
            worst = worst.max((exact - edge).abs());
            at += i64::from(way);
        }
        // Between two steps, too.
        worst = worst.max((exact - at as f64).abs() - 0.5);
    }
    assert_eq!(at as f64, (real(1e15) + 0.5).floor(), "it ends where it was sent");
    (count, worst)
}

#[test]
fn z_follows_the_surface_within_half_a_step() {
    use ShaperKind::{Mzv, None, Zvd};
    for (kind, advance, points, most, fade) in [
        (None, 0.0, 5, 0.15, 0.0),
        (None, 0.0, 9, 0.3, 10.0),
        (Mzv, 0.0, 5, 0.15, 10.0),
        (Mzv, 0.04, 9, 0.3, 0.0),
        (Zvd, 0.0, 9, 0.5, 8.0),
    ] {
        let mesh = mesh(points, most, fade, 0x1234_5678_9ABC_DEF1);
        let s = settings(kind, advance);
        let (count, worst) = errors(&wander(150, 0x0BAD_CAFE_0BAD_CAFE), &mesh, &s);
        println!("{kind:?} {points} {most} {fade}: {count} steps of z, worst {worst:.3} steps");
        assert!(count > 300 && worst <= 0.5, "{kind:?} {points} {most}: {worst} steps");
    }
}

#[test]
fn long_fast_moves_are_divided_as_the_surface_bends() {
    let mesh = mesh(9, 0.3, 0.0, 77);
    let mut dice = Dice(99);
    let targets: Vec<_> = (0..25)
        .map(|_| ([10.0 + 370.0 * dice.roll(), 10.0 + 380.0 * dice.roll(), 0.2 + 3.0 * dice.roll(), 0.0], 300.0))
        .collect();
    for kind in [ShaperKind::None, ShaperKind::Mzv] {
        let (count, worst) = errors(&targets, &mesh, &settings(kind, 0.0));
        println!("{kind:?}: {count} steps of z, worst {worst:.3} steps");
        assert!(count > 5_000 && worst <= 0.5, "{kind:?}: {worst} steps");
    }
}

#[test]
fn the_belts_and_the_extruder_do_not_feel_the_surface() {
    for kind in [ShaperKind::None, ShaperKind::Mzv] {
        let s = settings(kind, 0.03);
        let moves = plan(&wander(200, 0x5EED_5EED_5EED_5EED), &s);
        let flat = generate_from(shaping(&s).chain(moves.iter().map(|m| Work::Move(*m))), &s);
        let raised = steps_on(&mesh(7, 0.3, 10.0, 5), &moves, &s);
        for group in (0..groups().len()).filter(|group| *group != Z) {
            assert!(steps_of(&flat, group) == steps_of(&raised, group), "group {group}");
        }
        assert!(steps_of(&flat, Z) != steps_of(&raised, Z));
    }
}

/// Z ends where it was sent, step by step, however the tool got there.
#[test]
fn p9_after_ten_thousand_moves_no_step_is_lost() {
    let (mesh, s) = (mesh(7, 0.2, 10.0, 3), settings(ShaperKind::Mzv, 0.0));
    let law = Law::new(&mesh);
    let per_mm: f64 = s.axes.z.steps_per_mm.to_num();
    let mut targets = wander(10_000, 0xABCD_EF01_2345_6789);
    targets.push(([0.0, 0.0, 0.0, 0.0], 200.0));
    let steps = steps_on(&mesh, &plan(&targets, &s), &s);
    let of_z = steps_of(&steps, Z);
    assert!(of_z.len() > 100_000, "{} steps", of_z.len());
    assert_eq!(of_z.iter().map(|(_, way)| i64::from(*way)).sum::<i64>(), 0, "back where it began");
    assert!((law.raised([0.0; 3]) * per_mm).abs() > 1.0, "it began on the mesh");
}

/// A planner's moves on a mesh, from the origin.
fn plan_on(mesh: &Mesh, targets: &[([f64; 4], f64)], s: &Settings) -> Vec<Move> {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, s, [Mm::ZERO; 4]);
    planner.set_mesh(Some(*mesh));
    planner.use_mesh(true, s);
    let mut moves = Vec::new();
    for (position, speed) in targets {
        if !planner.has_room() {
            planner.release_some();
            moves.extend(std::iter::from_fn(|| planner.pop()));
        }
        planner.push(&target(*position, *speed), s);
    }
    planner.release_all();
    moves.extend(std::iter::from_fn(|| planner.pop()));
    moves
}

/// Its time, its end and the share of its slow end, see [`phases`].
type Phase = (f64, f64, Option<(f64, bool)>);

/// The phases of a move: their time in s, the fraction of the path at their end, and the shares of the times at their
/// slower speed (`None` at constant speed). The last part is whether they slow down.
fn phases(m: &Move) -> [Phase; 3] {
    let part = |fraction: u32| f64::from(fraction) / f64::from(WHOLE);
    let time = |time: SubTicks| time.0 as f64 / 65536.0 / 1e7;
    let is_last = |phase: usize| [m.cruise, m.decelerate][phase..].iter().all(|time| *time == SubTicks::ZERO);
    [
        (
            time(m.accelerate),
            part(if is_last(0) { WHOLE } else { m.accelerated }),
            Some((part(m.entry_share), m.brakes_first)),
        ),
        (time(m.cruise), part(if is_last(1) { WHOLE } else { m.cruised }), None),
        (time(m.decelerate), 1.0, Some((part(m.exit_share), true))),
    ]
}

/// The greatest speed and acceleration of real z within moves, and the greatest speed along the path.
fn greatest(moves: &[Move], mesh: &Mesh, s: &Settings) -> [f64; 3] {
    let (law, per_mm) = (Law::new(mesh), s.axes.map(|axis| axis.steps_per_mm.to_num::<f64>()).to_array());
    let end = |m: &Move| -> [f64; 3] { std::array::from_fn(|i| m.end[i].to_num::<f64>() / per_mm[i]) };
    // The way to the first place leads over the border, where the slope jumps.
    let (mut from, mut most) = (end(&moves[0]), [0f64; 3]);
    for m in &moves[1..] {
        let to = end(m);
        let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
        let mut begin = 0.0;
        for (time, end, ramp) in phases(m) {
            let covered = |t: f64| {
                let x = (t / time).clamp(0.0, 1.0);
                let way = |x: f64, share: f64| share * x + (1.0 - share) * x * x;
                begin
                    + (end - begin)
                        * match ramp {
                            None => x,
                            Some((share, false)) => way(x, share),
                            Some((share, true)) => 1.0 - way(1.0 - x, share),
                        }
            };
            let z = |t: f64| law.raised(std::array::from_fn(|i| from[i] + (to[i] - from[i]) * covered(t)));
            let dt = 1e-4;
            let mut t = dt;
            while t + dt < time {
                let (a, b, c) = (z(t - dt), z(t), z(t + dt));
                most[0] = most[0].max((c - a).abs() / (2.0 * dt));
                most[1] = most[1].max((c - 2.0 * b + a).abs() / (dt * dt));
                most[2] = most[2].max((covered(t + dt) - covered(t - dt)) * length / (2.0 * dt));
                t += dt;
            }
            begin = if time > 0.0 { end } else { begin };
        }
        from = to;
    }
    most
}

#[test]
fn moves_are_as_fast_as_z_bears_for_move_and_mesh_together() {
    let s = Settings::prototype();
    let (speed, accel): (f64, f64) = (s.axes.z.max_speed.to_num(), s.axes.z.max_acceleration.to_num());
    // Within the mesh: at its border the slope jumps.
    let within = |targets: Vec<([f64; 4], f64)>| -> Vec<_> {
        let inside = |at: f64| at.clamp(31.0, 349.0);
        targets.into_iter().map(|([x, y, z, e], v)| ([inside(x), inside(y), z - 4.0, e], v)).collect()
    };
    let mut dice = Dice(7);
    let mut roll = |most: f64| most * dice.roll();
    let long: Vec<_> =
        (0..30).map(|_| ([31.0 + roll(318.0), 31.0 + roll(318.0), 1.0 + roll(2.0), 0.0], 300.0)).collect();
    for targets in [within(wander(150, 0x0F0F_1234_F0F0_4321)), long] {
        for (most, fade) in [(0.02, 0.0), (0.3, 0.0), (1.0, 20.0), (3.0, 0.0)] {
            let mesh = mesh(9, most, fade, 11);
            let (moves, free) = (plan_on(&mesh, &targets, &s), plan(&targets, &s));
            let ([v, a, path], [.., free_path]) = (greatest(&moves, &mesh, &s), greatest(&free, &mesh, &s));
            println!("{most} {fade}: z {v:.1} mm/s, {a:.0} mm/s2, path {path:.0} of {free_path:.0} mm/s");
            assert!(v <= speed * 1.001 && a <= accel * 1.01, "{most} mm: {v} mm/s, {a} mm/s2");
        }
    }
    // Nothing is slower on a bed as it is.
    let gentle = Heights::filled(5, 5, |column, row| Some(((column + row) % 3) as i16 * 20)).unwrap_or(Heights::NONE);
    let gentle = Mesh::new(gentle, [Mm::from_num(30); 2], [Mm::from_num(350); 2], Mm::ZERO).expect("a mesh");
    let level: Vec<_> = wander(200, 5).into_iter().map(|([x, y, _, e], v)| ([x, y, 0.0, e], v)).collect();
    assert!(plan_on(&gentle, &level, &s) == plan(&level, &s));
}
