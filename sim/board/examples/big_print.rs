//! Writes a print with so many moves to standard output: `cargo run -p corehbot-sim --example big_print -- 500000`.
//!
//! Each layer has two walls of a wavy ring in chords of 0.5 mm, and lines of infill across it. Layers turn a little, so
//! no two are alike. Line types are commented as PrusaSlicer does it.
#![allow(clippy::print_stdout, reason = "the print is its output")]

use std::f64::consts::TAU;
use std::io::{self, BufWriter, Write};

/// Moves of a layer, about.
const A_LAYER: usize = 2500;

/// Filament in mm for a mm of line: 0.45 mm wide, 0.2 mm high, of 1.75 mm filament.
const FLOW: f64 = 0.45 * 0.2 / (TAU / 2.0 * 0.875 * 0.875);

/// The mean radius of the ring in mm, and its waves.
const RADIUS: f64 = 70.0;
const WAVES: f64 = 12.0;
const DEPTH: f64 = 3.0;

fn main() -> io::Result<()> {
    let wanted: usize = std::env::args().nth(1).and_then(|number| number.parse().ok()).unwrap_or(500_000);
    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "; a generated print of {wanted} moves\nG21\nG90\nM83\nG28")?;
    let mut left = wanted;
    for layer in 0.. {
        if left == 0 {
            break;
        }
        let moves = left.min(A_LAYER);
        left -= moves;
        // After the highest layer of the machine it begins again: only the number of moves counts.
        let z = 0.2 + 0.2 * f64::from(layer % 1500);
        writeln!(out, ";LAYER_CHANGE\n;Z:{z:.2}\nG1 Z{z:.2} F900")?;
        ring(&mut out, "External perimeter", RADIUS, f64::from(layer), moves * 2 / 5)?;
        ring(&mut out, "Perimeter", RADIUS - 0.45, f64::from(layer), moves * 2 / 5)?;
        infill(&mut out, layer, moves - 2 * (moves * 2 / 5))?;
    }
    writeln!(out, "M84")?;
    out.flush()
}

fn ring(out: &mut impl Write, name: &str, radius: f64, layer: f64, moves: usize) -> io::Result<()> {
    let place = |i: usize| {
        let angle = TAU * i as f64 / moves.max(1) as f64;
        let r = radius + DEPTH * (WAVES * angle + 0.05 * layer).sin();
        [195.0 + r * angle.cos(), 200.0 + r * angle.sin()]
    };
    let mut at = place(0);
    writeln!(out, ";TYPE:{name}\nG1 X{:.3} Y{:.3} F9000", at[0], at[1])?;
    for i in 1..moves {
        let to = place(i);
        let e = FLOW * (to[0] - at[0]).hypot(to[1] - at[1]);
        writeln!(out, "G1 X{:.3} Y{:.3} E{e:.5}{}", to[0], to[1], if i == 1 { " F4800" } else { "" })?;
        at = to;
    }
    Ok(())
}

fn infill(out: &mut impl Write, layer: i32, moves: usize) -> io::Result<()> {
    let half = 40.0;
    writeln!(out, ";TYPE:Internal infill")?;
    for i in 0..moves {
        let along = -half + 2.0 * half * i as f64 / moves.max(1) as f64;
        let across = if i % 2 == 0 { -half } else { half };
        let [x, y] = if layer % 2 == 0 { [along, across] } else { [across, along] };
        let e = if i == 0 { 0.0 } else { 2.0 * half * FLOW };
        writeln!(out, "G1 X{:.3} Y{:.3} E{e:.5} F9000", 195.0 + x, 200.0 + y)?;
    }
    Ok(())
}
