//! The report: tables for people.

use super::contexts::Context;
use super::figures::Figure;
use super::jobs::Job;
use super::profile::{Profile, Work};
use super::rooms::Room;
use crate::image_code::Code;
use anyhow::Result;

/// Functions that a profile shows.
const SHOWN: usize = 40;

/// Characters of a function's name.
const NAME: usize = 76;

/// Prints the figures next to the goals and to other firmware.
pub fn print_figures(figures: &[Figure]) {
    println!("{:<42} {:>12} {:>11}  others", "", "ours", "goal");
    for figure in figures {
        let sign = if figure.is_rate { ">=" } else { "<=" };
        let goal = figure.goal.map(|goal| format!("{sign} {goal}")).unwrap_or_default();
        println!("{:<42} {:>12} {goal:>11}  {}", figure.name, short(figure.value), figure.peers);
    }
}

/// Enough digits to tell a change.
fn short(value: f64) -> String {
    let decimals = if value < 10.0 { 4 } else { usize::from(value < 1e5) };
    format!("{value:.decimals$}")
}

/// Prints where the instructions of a job went.
pub fn print_profile(job: Job, profile: &Profile, code: &Code<'_>) -> Result<()> {
    let (unit, units) = if job.moves() > 1 { ("move", u64::from(job.moves())) } else { ("event", profile.events) };
    let per_unit = |count: u64| count as f64 / units as f64;
    let Profile { events, motor_steps, seconds, .. } = profile;
    println!("\njob {job}: {} moves, {events} events, {motor_steps} motor steps, {seconds:.3} s", job.moves());
    println!(
        "{:<14} {:>10} {:>12} {:>12} {:>10} {:>10}",
        "",
        "entries",
        "instructions",
        "cycles",
        per(unit),
        "longest"
    );
    for context in Context::BUSY {
        let Work { instructions, cycles } = profile.in_context(context);
        let (entries, longest, each) = (profile.entries(context), profile.longest(context), per_unit(instructions));
        println!("{context:<14} {entries:>10} {instructions:>12} {cycles:>12} {each:>10.1} {longest:>10}");
    }
    for room in Room::ALL {
        let Work { instructions, cycles } = profile.in_room(room);
        println!("{room:<14} {:>10} {instructions:>12} {cycles:>12} {:>10.1}", "", per_unit(instructions));
    }
    println!();
    println!("{:>12} {:>12} {:>10}  {:<14} {:<9} function", "instructions", "cycles", per(unit), "in", "for");
    for function in profile.functions(code)?.iter().take(SHOWN) {
        let Work { instructions, cycles } = function.work;
        let room = function.room.map(|room| room.to_string()).unwrap_or_default();
        let name: String = function.name.chars().take(NAME).collect();
        let (context, each) = (function.context, per_unit(instructions));
        println!("{instructions:>12} {cycles:>12} {each:>10.1}  {context:<14} {room:<9} {name}");
    }
    Ok(())
}

fn per(unit: &str) -> String {
    format!("a {unit}")
}
