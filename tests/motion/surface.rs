//! A surface under the motion: z follows it within half a step, and nothing else feels it.

use super::dice::Dice;
use super::line::{Step, generate_from, on_mesh, plan, shaping};
use super::shaped::positions;
use super::timing::{groups, steps_of, wander};
use corehbot::motion::{Move, Work};
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::surface::{Heights, Mesh, UNITS_PER_MM};
use corehbot::units::{Hertz, Mm, Ratio, Seconds};

/// The group of the Z screws.
const Z: usize = 2;

/// A mesh over most of the bed, with heights up to `most` mm up and down.
fn mesh(points: usize, most: f64, fade: f64, seed: u64) -> Mesh {
    let mut dice = Dice(seed);
    let filled = Heights::filled(points, points, |_, _| {
        Some(((2.0 * dice.roll() - 1.0) * most * f64::from(UNITS_PER_MM)).round() as i16)
    });
    let (first, last) = ([Mm::from_num(30); 2], [Mm::from_num(350), Mm::from_num(360)]);
    Mesh::new(filled.unwrap_or(Heights::NONE), first, last, Mm::from_num(fade)).expect("a mesh")
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
        let (count, worst) = errors(&wander(300, 0x0BAD_CAFE_0BAD_CAFE), &mesh, &s);
        println!("{kind:?} {points} {most} {fade}: {count} steps of z, worst {worst:.3} steps");
        assert!(count > 500 && worst <= 0.5, "{kind:?} {points} {most}: {worst} steps");
    }
}

#[test]
fn long_fast_moves_are_divided_as_the_surface_bends() {
    let mesh = mesh(9, 0.3, 0.0, 77);
    let mut dice = Dice(99);
    let targets: Vec<_> = (0..60)
        .map(|_| ([10.0 + 370.0 * dice.roll(), 10.0 + 380.0 * dice.roll(), 0.2 + 3.0 * dice.roll(), 0.0], 300.0))
        .collect();
    for kind in [ShaperKind::None, ShaperKind::Mzv] {
        let (count, worst) = errors(&targets, &mesh, &settings(kind, 0.0));
        println!("{kind:?}: {count} steps of z, worst {worst:.3} steps");
        assert!(count > 10_000 && worst <= 0.5, "{kind:?}: {worst} steps");
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
