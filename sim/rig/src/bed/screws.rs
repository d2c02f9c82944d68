//! Screws: the motors of z, each of which lifts the bed where it is, with a play of its own.
//!
//! A motor's own steps, less the mean of all, tilt the bed. Two screws tilt it along the line between them, more of
//! them as the plane that fits best: the bed is stiff. The mean is z, which [`Rig`](crate::Rig) counts.

use corehbot::motors::MOTORS;
use corehbot::settings::Settings;

/// Most screws that a machine has.
pub const MOST_SCREWS: usize = 4;

/// A screw, as a simulation asks for it. Lengths are mm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ScrewSetup {
    /// Its place in x and y.
    pub at: [f64; 2],
    /// By how much the bed is too high there at power-up.
    pub height: f64,
    /// Its play: the bed follows so much later when the motor turns round.
    pub play: f64,
}

/// A screw at work.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Screw {
    setup: ScrewSetup,
    motor: usize,
    /// mm of z a step, signed.
    step: f64,
    /// Steps of the motor when it was last looked at.
    seen: i32,
    /// How far the nut has gone since power-up, and how far the bed has followed it, in mm of z.
    nut: f64,
    bed: f64,
}

/// The screws of a machine.
#[derive(Clone, Debug)]
pub struct Screws {
    screws: heapless::Vec<Screw, MOST_SCREWS>,
    /// What they add to the bed's height: at 0, 0, and a mm of x and y.
    plane: [f64; 3],
}

impl Screws {
    /// The motors of z, in their order, at the places of `setup`. A motor that moves another axis too is no screw.
    #[must_use]
    pub fn new(settings: &Settings, setup: &[ScrewSetup]) -> Self {
        let pitch: f64 = settings.axes.z.steps_per_mm.to_num();
        let of_z = settings.mechanism.rows.iter().enumerate().filter(|(_, row)| row[2] != 0 && row[..2] == [0, 0]);
        let screws = of_z.zip(setup).map(|((motor, row), setup)| Screw {
            setup: *setup,
            motor,
            step: 1.0 / (f64::from(row[2]) * pitch),
            seen: 0,
            nut: 0.0,
            bed: 0.0,
        });
        let mut screws = Self { screws: screws.take(MOST_SCREWS).collect(), plane: [0.0; 3] };
        screws.level();
        screws
    }

    /// Screws are counted from 0 again, and stay as they are.
    pub fn restart(&mut self) {
        self.screws.iter_mut().for_each(|screw| screw.seen = 0);
    }

    /// The motors have made these steps.
    pub fn follow(&mut self, counts: &[i32; MOTORS]) {
        let mut has_turned = false;
        for screw in &mut self.screws {
            let count = counts.get(screw.motor).copied().unwrap_or_default();
            let steps = count.wrapping_sub(screw.seen);
            if steps != 0 {
                screw.seen = count;
                screw.nut += f64::from(steps) * screw.step;
                screw.bed = screw.bed.clamp(screw.nut - screw.setup.play, screw.nut);
                has_turned = true;
            }
        }
        if has_turned {
            self.level();
        }
    }

    /// What they add to the bed's height there.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let [height, of_x, of_y] = self.plane;
        height + of_x * x + of_y * y
    }

    /// Finds the plane through the screws.
    fn level(&mut self) {
        let n = self.screws.len() as f64;
        if n < 1.0 {
            return;
        }
        let mean = |of: fn(&Screw) -> f64| self.screws.iter().map(of).sum::<f64>() / n;
        // z grows as the bed falls, and has grown by as much as the nuts on the average.
        let z = mean(|screw| screw.nut);
        let (mx, my) = (mean(|screw| screw.setup.at[0]), mean(|screw| screw.setup.at[1]));
        let middle = mean(|screw| screw.setup.height - screw.bed) + z;
        let mut sums = [0.0; 5];
        for screw in &self.screws {
            let [x, y] = screw.setup.at;
            let (x, y, high) = (x - mx, y - my, screw.setup.height - screw.bed + z - middle);
            for (sum, part) in sums.iter_mut().zip([x * x, x * y, y * y, x * high, y * high]) {
                *sum += part;
            }
        }
        let [xx, xy, yy, xz, yz] = sums;
        let (along, determinant) = (xx + yy, xx * yy - xy * xy);
        let [of_x, of_y] = if along <= 0.0 {
            [0.0; 2]
        } else if determinant > 1e-6 * along * along {
            [(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant]
        } else {
            // Screws in a line tilt the bed along it alone.
            [(xx * xz + xy * yz) / (along * along), (xy * xz + yy * yz) / (along * along)]
        };
        self.plane = [middle - of_x * mx - of_y * my, of_x, of_y];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;

    const LEFT: ScrewSetup = ScrewSetup { at: [-25.0, 200.0], height: 0.399_143, play: 0.0 };
    const RIGHT: ScrewSetup = ScrewSetup { at: [455.0, 200.0], height: -0.259_143, play: 0.0 };

    fn is_near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-6
    }

    #[test]
    fn two_screws_tilt_the_bed_along_their_line_and_their_own_steps_level_it() {
        let settings = Settings::prototype();
        let mut screws = Screws::new(&settings, &[LEFT, RIGHT]);
        assert!(is_near(screws.at([40.0, 0.0]), 0.31) && is_near(screws.at([390.0, 380.0]), -0.17));
        let steps = |mm: f64| (mm * settings.axes.z.steps_per_mm.to_num::<f64>()).round() as i32;
        // Each by half: the left nut goes down, the right one up.
        let mut counts = [0; MOTORS];
        counts[prototype::Z1.index()] = steps(0.329_143);
        counts[prototype::Z2.index()] = -steps(0.329_143);
        screws.follow(&counts);
        assert!((screws.at([40.0, 0.0]) - 0.07).abs() < 0.001 && (screws.at([390.0, 0.0]) - 0.07).abs() < 0.001);
        // Both together are z, and tilt nothing; a restart of the count changes nothing.
        let before = screws.at([40.0, 0.0]);
        screws.restart();
        let mut counts = [0; MOTORS];
        counts[prototype::Z1.index()] = 800;
        counts[prototype::Z2.index()] = 800;
        screws.follow(&counts);
        assert!(is_near(screws.at([40.0, 0.0]), before));
    }

    #[test]
    fn a_screw_with_play_follows_late_when_it_turns_round() {
        let settings = Settings::prototype();
        let both = [LEFT, RIGHT].map(|screw| ScrewSetup { height: 0.0, play: 0.05, ..screw });
        let mut screws = Screws::new(&settings, &both);
        let mut turn = |steps| {
            let mut counts = [0; MOTORS];
            counts[prototype::Z1.index()] = steps;
            counts[prototype::Z2.index()] = steps;
            screws.follow(&counts);
            screws.at([200.0, 200.0])
        };
        // Down 1 mm: the bed is 0.05 mm higher than z says. Up again by less than the play, it has not moved.
        assert!(is_near(turn(800), 0.05));
        assert!(is_near(turn(780), 0.025));
        assert!(is_near(turn(760), 0.0));
        assert!(is_near(turn(700), 0.0));
    }

    #[test]
    fn three_screws_hold_a_plane() {
        let mut settings = Settings::prototype();
        // The extruder's place in the table serves as the third screw here.
        settings.mechanism.rows[prototype::E0.index()] = [0, 0, 1, 0];
        let at = |at, height| ScrewSetup { at, height, play: 0.0 };
        let setup = [at([-25.0, 0.0], 0.4), at([455.0, 0.0], -0.25), at([215.0, 400.0], 0.1)];
        let screws = Screws::new(&settings, &setup);
        assert!(setup.iter().all(|screw| is_near(screws.at(screw.at), screw.height)));
    }
}
