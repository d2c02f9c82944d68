//! Which of Yin's findings hold for which machines: rigs at random, from overdamped ones to belt printers.
//!
//! `cargo run -p corehbot-lab --example yin_findings` prints the figures of docs/research/twin-yin.md within a minute.
//! A fixed generator draws the same rigs every time.
mod sets;
mod study;

use corehbot_lab::yin::Error;
use sets::{Generator, Group, draw};
use study::{Finding, study};

/// Rigs of each group.
const RIGS: usize = 24;

/// m/s, as in figure 5 of the paper.
const SPEED: f64 = 0.079;

/// Rigs with a soft belt as the paper's, in four ranges of damping, and printers. Ranges are assumed. GT2 belts begin
/// at two thirds of 29 kN (6 mm wide, glass fibre), as measured once at 9 mm in the thread "Belt stretch and stepper
/// holding measured" on community.carbide3d.com. They end at 56 kN (9 mm, steel).
const GROUPS: [Group; 5] = [
    soft("damping ratio 2 to 3.5", [2.0, 3.5]),
    soft("1.3 to 2", [1.3, 2.0]),
    soft("0.8 to 1.3", [0.8, 1.3]),
    soft("0.1 to 0.35", [0.1, 0.35]),
    Group {
        name: "GT2 printer, 0.02 to 0.15",
        belt: [19e3, 56e3],
        section: [0.15, 0.6],
        mass: [0.25, 1.2],
        damping: [0.02, 0.15],
    },
];

const fn soft(name: &'static str, damping: [f64; 2]) -> Group {
    Group { name, belt: [400.0, 3000.0], section: [0.08, 0.3], mass: [0.05, 0.3], damping }
}

fn main() -> Result<(), Error> {
    println!("medians of {RIGS} rigs at {SPEED} m/s; quartiles in brackets; the error is that from x to y");
    for group in &GROUPS {
        let mut random = Generator(1);
        let mut findings = Vec::new();
        for _ in 0..RIGS {
            findings.push(study(&draw(group, SPEED, &mut random), SPEED)?);
        }
        println!("\n{}", group.name);
        print(&findings);
    }
    Ok(())
}

fn print(findings: &[Finding]) {
    for (i, name) in ["friction", "stiffness", "mass"].into_iter().enumerate() {
        let known: Vec<_> = findings.iter().filter_map(|f| f.exponents[i]).collect();
        println!("  exponent of {name:9} {}   of {} rigs", quartiles(known.clone()), known.len());
    }
    let all = |of: &dyn Fn(&Finding) -> f64| quartiles(findings.iter().map(of).collect());
    println!("  R2 over speed         {}", all(&|f| f.r_squared));
    println!("  4-DoF/full x to y     {}", all(&|f| f.four_over_full[0]));
    println!("  4-DoF/full y to x     {}", all(&|f| f.four_over_full[1]));
    println!("  error / (v/omega)     {}", all(&|f| f.of_swing[0]));
    println!("  overshoot / (v/omega) {}", all(&|f| f.of_swing[1]));
    let smaller = |i: usize| findings.iter().filter(|f| f.four_over_full[i] < 1.0).count();
    println!("  4-DoF smaller: x to y {}, y to x {} of {}", smaller(0), smaller(1), findings.len());
    for (is_slower, name) in [(true, "x is damped more"), (false, "y is damped more")] {
        let (larger, all) = findings
            .iter()
            .filter(|f| f.is_x_slower == is_slower)
            .fold((0, 0), |(larger, all), f| (larger + usize::from(f.is_x_larger), all + 1));
        println!("  x to y is the larger error in {larger} of {all} where {name}");
    }
}

/// "median [lower, upper]".
fn quartiles(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    let at = |part: f64| values.get((part * values.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    format!("{:7.3} [{:7.3}, {:7.3}]", at(0.5), at(0.25), at(0.75))
}
