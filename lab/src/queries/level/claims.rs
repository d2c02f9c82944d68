//! Claims: what Carlyle says about racking and levelling, on this machine.

use super::{Ask, Case, Claim, Kind, LevelError, MODES, Study, TAKEN, THOUSAND, shown};
use corehbot_twin::geometry::workspace;
use corehbot_twin::math::hypot;
use corehbot_twin::routing::{Machine, Place};

/// A soft spring idler, N/mm: assumed.
const A_SPRING: f64 = 1.0;

/// Smaller angles count as none: mrad, for a mm of take-up, 1 m/s2, or the preload.
const NONE: f64 = 1e-10;

/// A smaller part of another angle counts as none.
const SMALL: f64 = 1e-6;

/// The internal pattern, the last of `MODES`.
const INTERNAL: [f64; 4] = MODES[3].1;

/// Racking and both tilts.
const fn angles(case: &Case) -> [f64; 3] {
    [case.bar_mrad, case.gantry_mrad[0], case.gantry_mrad[1]]
}

/// Tilt about the axis that has it.
fn tilt(case: &Case) -> f64 {
    hypot(case.gantry_mrad[0], case.gantry_mrad[1])
}

impl Study<'_> {
    /// Largest tilt in rad per mm of the internal pattern, over the reach.
    fn worst_internal(&self) -> Result<f64, LevelError> {
        let reach = workspace(self.machine, self.params);
        let at = |[low, high]: [f64; 2], part: f64| low + part * (high - low);
        const PARTS: [f64; 3] = [0.1, 0.5, 0.9];
        let mut worst = 0.0_f64;
        for (x, y, z) in PARTS.iter().flat_map(|x| PARTS.iter().flat_map(move |y| PARTS.iter().map(move |z| (x, y, z))))
        {
            let tool = Place { x: at(reach.x, *x), y: at(reach.y, *y), z: at(reach.z, *z) };
            let [about_x, about_y] = self.turned("", INTERNAL, tool)?.gantry_mrad;
            worst = worst.max(hypot(about_x, about_y) / (THOUSAND * self.ask.taken_mm.abs()));
        }
        Ok(worst)
    }

    pub(super) fn claims(&self, cases: &[Case]) -> Result<Vec<Claim>, LevelError> {
        let none = NONE * self.ask.taken_mm.abs();
        let case = |name: &str| cases.iter().find(|case| case.name == name).ok_or(LevelError::NotHeld);
        let [three, skewed, pair, other] = [
            case("belts A, B and C alone")?,
            case("A shorter")?,
            case("A shorter, C longer")?,
            case("B shorter, D longer")?,
        ];
        let mut claims = vec![Claim::new(
            "of three belts one is not balanced, which racks",
            three.bar_mrad.abs() > NONE,
            format!("the preload racks the bar by {} N m on its guides", shown(three.bar_nm, 2)),
        )];
        if let Some(idle) = cases.iter().find(|case| case.kind == Kind::Preload && case.name != three.name) {
            claims.push(Claim::new(
                "a fourth belt balances it at rest",
                angles(idle).iter().all(|angle| angle.abs() <= SMALL * three.bar_mrad.abs()),
                format!("{} N m on the guides of the bar", shown(idle.bar_nm, 3)),
            ));
        }
        // Off the middle of the reach the inertia of the head racks every machine.
        let middle = workspace(self.machine, self.params).centre();
        let motions = Study { tool: middle, ..*self }.motions()?;
        let moved: Vec<String> = motions.iter().map(|case| shown(case.bar_nm, 3)).collect();
        let racks = motions.iter().any(|case| case.bar_mrad.abs() > NONE * self.ask.acceleration.abs());
        claims.push(Claim::new(
            "(left open) racking in motion: only with an undriven fourth belt",
            racks == (self.machine == Machine::CoreXyzThree),
            format!(
                "in the middle of the reach {} N m on the guides of the bar along x, y and z at {} m/s2 with {} motors",
                moved.join(", "),
                self.ask.acceleration,
                self.machine.motors().len()
            ),
        ));
        claims.push(Claim::new(
            "one belt alone skews the gantry diagonally and racks gantry and bar",
            angles(skewed).iter().all(|angle| angle.abs() > none),
            format!(
                "{} mm of A: {} N m on the gantry's guides, {} N m on the bar's",
                self.ask.taken_mm,
                shown(hypot(skewed.gantry_nm[0], skewed.gantry_nm[1]), 3),
                shown(skewed.bar_nm, 3)
            ),
        ));
        let both = [pair, other];
        claims.push(Claim::new(
            "opposing pairs tilt it in any direction, and do not rack the bar",
            both.iter().all(|case| tilt(case) > none && case.bar_mrad.abs() <= SMALL * tilt(case))
                && (pair.gantry_mrad[0] * other.gantry_mrad[1] - pair.gantry_mrad[1] * other.gantry_mrad[0]).abs()
                    > SMALL * tilt(pair) * tilt(other),
            both.map(|case| {
                format!("{}: {} and {} mrad", case.name, shown(case.gantry_mrad[0], 4), shown(case.gantry_mrad[1], 4))
            })
            .join("; "),
        ));
        let spring = self.ask.spring_n_per_mm.unwrap_or(A_SPRING);
        let with = |spring_n_per_mm| {
            let study = Study { ask: Ask { spring_n_per_mm, ..self.ask }, ..*self };
            study.taken("", TAKEN[1].1)
        };
        let (free, sprung) = (with(None)?, with(Some(spring))?);
        let left = sprung.gantry_mrad[0] / free.gantry_mrad[0];
        let spread = |case: &Case| case.tensions_n.iter().map(|(_, change)| change.abs()).fold(0.0, f64::max);
        claims.push(Claim::new(
            "matched spring idlers keep tensions constant while moved pulleys level the gantry",
            left > 0.5,
            format!(
                "with {spring} N/mm tensions change by {} N instead of {}, and {} % of the tilt is left",
                shown(spread(&sprung), 3),
                shown(spread(&free), 3),
                shown(100.0 * left, 0)
            ),
        ));
        if self.machine == Machine::CoreXyz {
            let internal = self.turned("", INTERNAL, middle)?;
            let worst = self.worst_internal()?;
            let strain = internal.tensions_n.iter().map(|(_, n)| n.abs()).fold(0.0, f64::max) / self.ask.taken_mm;
            claims.push(Claim::new(
                "(ours) four motors cannot level the gantry: three patterns move the tool, the fourth racks the bar",
                tilt(&internal) <= SMALL * internal.bar_mrad.abs(),
                format!(
                    "in the middle a mm of the fourth racks by {} mrad, tilts by {} and strains belts by {} N; elsewhere \
                     it tilts by at most {} mrad",
                    shown(internal.bar_mrad.abs() / self.ask.taken_mm, 3),
                    shown(hypot(internal.gantry_mrad[0], internal.gantry_mrad[1]) / self.ask.taken_mm, 3),
                    shown(strain, 1),
                    shown(THOUSAND * worst, 3)
                ),
            ));
        }
        Ok(claims)
    }
}
