//! Real sliced files, if their folder is next to the checkout: their moves along x or y step all four belt motors in
//! the same events.

use crate::extent::is_all;
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};
use std::path::Path;

/// All belt motors.
const BELTS: u8 = 0x0F;

/// The ends of a file's moves in steps, from the origin.
fn corners(gcode: &str) -> Vec<[f64; 2]> {
    let (mut at, mut is_absolute) = ([0.0; 2], true);
    let mut all = vec![at];
    for line in gcode.lines() {
        let mut words = line.split(';').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("G0" | "G1" | "G00" | "G01") => {
                for word in words {
                    let axis = match word.as_bytes()[0] {
                        b'X' => 0,
                        b'Y' => 1,
                        _ => continue,
                    };
                    let value: f64 = word[1..].parse().unwrap();
                    // Targets beyond the edge are moved to it.
                    at[axis] = (if is_absolute { value } else { at[axis] + value }).clamp(0.0, [390.0, 417.6][axis]);
                }
                if at != all[all.len() - 1] {
                    all.push(at);
                }
            }
            Some("G90") => is_absolute = true,
            Some("G91") => is_absolute = false,
            Some("G92") => assert!(words.all(|word| word.starts_with('E')), "{line}"),
            _ => {}
        }
    }
    all.iter().map(|at| at.map(|mm| 80.0 * mm)).collect()
}

/// Follows the tool from corner to corner and checks the events of long moves along an axis, except within a step of
/// their ends.
struct Walk {
    corners: Vec<[f64; 2]>,
    /// The corner that the tool is on its way to.
    next: usize,
    counts: [i64; 2],
    /// Events of the present move, and events that lack a belt motor.
    events: (u64, u64),
    /// Long axis moves, those with a thousandth of lone events, and the events of all.
    moves: (u64, u64, u64),
}

impl Walk {
    fn at(&self) -> [f64; 2] {
        let [u, v] = self.counts.map(|count| count as f64);
        [(u + v) / 2.0, (u - v) / 2.0]
    }

    fn is_near(&self, corner: usize) -> bool {
        let (at, corner) = (self.at(), self.corners[corner]);
        (0..2).all(|i| (at[i] - corner[i]).abs() <= 1.01)
    }

    fn arrive(&mut self) {
        let ([x, y], [to_x, to_y]) = (self.corners[self.next - 1], self.corners[self.next]);
        let (dx, dy) = ((to_x - x).abs(), (to_y - y).abs());
        let (events, lone) = std::mem::take(&mut self.events);
        if (dx == 0.0) != (dy == 0.0) && dx.max(dy) >= 80.0 {
            self.moves.0 += 1;
            self.moves.1 += u64::from(lone * 1000 > events);
            self.moves.2 += events;
            assert!(events as f64 > dx.max(dy) - 5.0, "{events} events of a move of {dx} {dy} steps");
        }
        self.next += 1;
    }
}

impl Sink for Walk {
    fn event(&mut self, _tick: u64, steps: MotorSet, forward: MotorSet) {
        if steps.0 & BELTS == 0 {
            return;
        }
        let was_near = self.next > 0 && self.is_near(self.next - 1);
        for (count, motor) in self.counts.iter_mut().zip([prototype::M11, prototype::M8]) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
        if !was_near {
            self.events.0 += 1;
            self.events.1 += u64::from(steps.0 & BELTS != BELTS);
        }
        while self.next < self.corners.len() && self.is_near(self.next) {
            self.arrive();
        }
    }
}

#[test]
fn axis_moves_of_sliced_files_step_all_four_belt_motors_at_once() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/gcode");
    if !folder.is_dir() {
        println!("skipped: no folder with sliced files at ../shared/gcode");
        return;
    }
    // These lines have 419 such moves; `cargo xtask test --all` walks along whole files.
    let lines = if is_all() { usize::MAX } else { 5000 };
    for name in ["cura231_puzzle_reprap", "prusaslicer292_cubehelix_small", "slic3r129_benchy"] {
        let gcode = std::fs::read_to_string(folder.join(name).with_extension("gcode")).unwrap();
        let gcode: String = gcode
            .lines()
            .take(lines)
            .filter(|line| !line.starts_with("G28"))
            .fold(String::new(), |all, line| all + line + "\n");
        let mut walk = Walk { corners: corners(&gcode), next: 1, counts: [0; 2], events: (0, 0), moves: (0, 0, 0) };
        let mut host = FileHost::new(&gcode);
        run(&Settings::prototype(), Some([Mm::ZERO; 3]), &mut host, &mut walk).unwrap();
        assert!(host.failure().is_none(), "{name}: {:?}", host.failure());
        assert_eq!(walk.next, walk.corners.len(), "{name}: the tool left its path");
        let (moves, lone, events) = walk.moves;
        println!("{name}: {moves} axis moves, {events} events, {lone} moves with lone ones");
        assert!(moves > 0 && lone == 0, "{name}: {lone} of {moves} moves");
    }
}
