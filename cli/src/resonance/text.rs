//! Text: the answer for people.

use super::Answer;
use corehbot_resonance::axis::{Axis, Measured, Net, Ranking, Suggestion};
use corehbot_resonance::belts::Comparison;
use corehbot_resonance::klipper::Choice;
use corehbot_resonance::label;
use corehbot_resonance::motors::{Motors, Repeat};
use corehbot_resonance::profile::Profile;
use corehbot_resonance::symmetry::Symmetry;
use std::fmt::{Display, Formatter, Result};

impl Display for Answer {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for axis in &self.axes {
            told_axis(f, axis)?;
        }
        if let Some(belts) = &self.belts {
            told_belts(f, &belts.comparison)?;
            for recording in &belts.recordings {
                told_recording(f, recording)?;
            }
        }
        self.profile.as_ref().map_or(Ok(()), |profile| told_profile(f, profile))?;
        self.left_out.iter().try_for_each(|flaw| writeln!(f, "remark: left out, {flaw}"))
    }
}

fn told_axis(f: &mut Formatter<'_>, axis: &Axis) -> Result {
    match axis.axis {
        Some(axis) => writeln!(f, "Axis {}", axis.letter())?,
        None => writeln!(f, "Unknown axis: no file name tells it, give --axis x or --axis y for a line to set")?,
    }
    for recording in &axis.recordings {
        told_recording(f, recording)?;
    }
    match &axis.suggestion {
        Some(suggestion) => told_suggestion(f, suggestion, axis.axis)?,
        None => writeln!(f, "  no shaper is suggested: nothing rings within the sweep")?,
    }
    told_klipper(f, &axis.klipper)?;
    match &axis.tool {
        Some(tool) => told_tool(f, tool),
        None => writeln!(f, "  no ranking by the tool: no modes fit the response well"),
    }
}

/// What is left of the vibration stands first: it is what the measured spectrum says of the line.
fn told_suggestion(f: &mut Formatter<'_>, suggestion: &Suggestion, axis: Option<label::Axis>) -> Result {
    let rated = &suggestion.rated;
    write!(f, "  {:.1} % of the measured vibration is left", 100.0 * rated.remaining_vibration)?;
    match (&suggestion.line, axis) {
        (Some(line), _) => {
            let acceleration = rated.suggested_acceleration_mm_s2;
            writeln!(f, ": {line}    ; accelerations up to {acceleration:.0} mm/s2")?;
        }
        (None, Some(_)) => writeln!(f, "; no line: shapers are set for x and y")?,
        (None, None) => writeln!(f)?,
    }
    writeln!(f, "  {}", suggestion.why)
}

fn told_recording(f: &mut Formatter<'_>, recording: &Measured) -> Result {
    let Measured { file, rate_hz, lasts_s, remarks, fit, .. } = recording;
    match (lasts_s, rate_hz) {
        (Some(lasts_s), Some(rate_hz)) => writeln!(f, "  {file}: {lasts_s:.1} s at {rate_hz:.0} Hz")?,
        _ => writeln!(f, "  {file}: a spectrum")?,
    }
    if let Some(fit) = fit {
        for mode in &fit.modes {
            write!(f, "    {:.2} Hz +- {:.2}", mode.frequency_hz, 2.0 * mode.frequency_error_hz)?;
            write!(f, ", damping {:.4}", mode.damping_ratio)?;
            writeln!(f, ", {:.0} % of the motion", 100.0 * mode.part)?;
        }
        let one = if fit.modes.len() == 1 { "one mode only; " } else { "" };
        write!(f, "    {one}the fit is within {:.1} dB, RMS", fit.fit_error_db)?;
        let [share, off] = [fit.belt_damping_share, 2.0 * fit.belt_damping_share_error].map(|part| 100.0 * part);
        match off {
            ..50.0 => writeln!(f, "; {share:.0} % +- {off:.0} of the damping acts in the belts")?,
            _ => writeln!(f)?,
        }
    }
    remarks.iter().try_for_each(|remark| writeln!(f, "    remark: {remark}"))
}

fn told_klipper(f: &mut Formatter<'_>, choice: &Choice) -> Result {
    writeln!(f, "  Klipper's ranking, by how much the shaper rounds the command")?;
    writeln!(f, "      shaper     vibration  frequency  smoothing   score  acceleration")?;
    for s in &choice.shapers {
        let is_chosen = choice.suggestion.is_some_and(|chosen| chosen.shaper == s.shaper);
        let mark = if is_chosen { "*" } else { " " };
        write!(
            f,
            "    {mark} {:<9} {:>8.1} % {:>7.1} Hz",
            s.shaper.name(),
            100.0 * s.remaining_vibration,
            s.frequency_hz
        )?;
        write!(f, " {:>8.3} mm {:>7.4}", s.smoothing_mm, s.score)?;
        write!(f, " {:>6.0} mm/s2", s.suggested_acceleration_mm_s2)?;
        writeln!(f, "{}", if s.in_firmware { "" } else { "  (not in this firmware)" })?;
    }
    Ok(())
}

fn told_tool(f: &mut Formatter<'_>, tool: &Ranking) -> Result {
    let print = &tool.print;
    writeln!(f, "  Ranking by the error of the tool on the walls of a 10 mm square and an 8 mm hole")?;
    write!(f, "    at {:.0} mm/s2, {:.0} mm/s", print.acceleration_mm_s2, print.speed_mm_s)?;
    write!(f, ", corners at {:.0} mm/s; frequency within", print.corner_speed_mm_s)?;
    writeln!(f, " {:.1} %", 100.0 * tool.uncertainty)?;
    writeln!(f, "      shaper     vibration  frequency  net rounding    RMS error  at the worst  acceleration")?;
    let none = &tool.unshaped_wall;
    writeln!(f, "      none                                           {:>8.1} um", none.rms_um)?;
    for s in &tool.shapers {
        let mark = if s.rated.shaper == tool.nearest.rated.shaper { "*" } else { " " };
        told_net(f, mark, s)?;
    }
    Ok(())
}

fn told_net(f: &mut Formatter<'_>, mark: &str, s: &Net) -> Result {
    let rated = &s.rated;
    write!(f, "    {mark} {:<9} {:>8.1} %", rated.shaper.name(), 100.0 * rated.remaining_vibration)?;
    write!(f, " {:>7.1} Hz {:>7.2} a/w^2 {:>9.1} um", rated.frequency_hz, s.net_rounding_a_per_w2, s.wall.rms_um)?;
    writeln!(f, " {:>10.1} um {:>6.0} mm/s2", s.worst_wall.rms_um, rated.suggested_acceleration_mm_s2)
}

fn told_belts(f: &mut Formatter<'_>, belts: &Comparison) -> Result {
    writeln!(f, "Belt paths A (1,-1) and B (1,1): similarity {:.1} %", belts.similarity_percent)?;
    if let (Some(hz), Some(stiffness)) = (belts.frequency_difference_percent, belts.stiffness_difference_percent) {
        write!(f, "  A against B: frequency {hz:+.1} %, stiffness {stiffness:+.1} %")?;
        writeln!(f, ", vibration {:+.1} dB", belts.level_difference_db)?;
    }
    for [a, b] in &belts.pairs {
        writeln!(f, "  peak at {:.1} Hz (A) and {:.1} Hz (B)", a.frequency_hz, b.frequency_hz)?;
    }
    writeln!(f, "  {}", belts.verdict)
}

fn told_profile(f: &mut Formatter<'_>, profile: &Profile) -> Result {
    let angles: Vec<String> = profile.angles_deg.iter().map(|angle| format!("{angle:.0}")).collect();
    writeln!(f, "Vibration by speed, {} runs along {} degrees", profile.runs.len(), angles.join(", "))?;
    for s in &profile.speeds {
        let mark = if profile.loud_mm_s.contains(&s.speed_mm_s) { "  loud" } else { "" };
        write!(f, "  {:>6.1} mm/s  mean {:>7.0} mm/s2", s.speed_mm_s, s.mean_mm_s2)?;
        writeln!(f, ", at most {:>7.0}{mark}", s.max_mm_s2)?;
    }
    let quiet: Vec<String> = profile.quiet_mm_s.iter().map(|[from, to]| range(*from, *to)).collect();
    match quiet.is_empty() {
        true => writeln!(f, "  no speed is much quieter than the others"),
        false => writeln!(f, "  quiet along every angle: {} mm/s", quiet.join(", ")),
    }?;
    profile.symmetry.as_ref().map_or(Ok(()), |symmetry| told_symmetry(f, symmetry))?;
    profile.motors.iter().try_for_each(|motors| told_motors(f, motors))
}

fn told_symmetry(f: &mut Formatter<'_>, symmetry: &Symmetry) -> Result {
    let Symmetry { symmetry_percent, level_difference_db, shape_percent, worst, .. } = symmetry;
    let [a, b] = worst.angles_deg;
    writeln!(f, "Symmetry of directions that mirror each other: {symmetry_percent:.0} %")?;
    write!(f, "  level {level_difference_db:+.1} dB")?;
    if let Some(shape) = shape_percent {
        write!(f, ", shape over the speeds {shape:.0} % alike")?;
    }
    write!(f, "; most apart at {:.0} mm/s: {:.0} mm/s2", worst.speed_mm_s, worst.vibration_mm_s2[0])?;
    writeln!(f, " along {a:.0} degrees, {:.0} along {b:.0}", worst.vibration_mm_s2[1])
}

fn told_motors(f: &mut Formatter<'_>, motors: &Motors) -> Result {
    writeln!(f, "Motors {}, {} runs along {:.0} degrees", motors.motors, motors.runs, motors.angle_deg)?;
    for mode in &motors.modes {
        write!(f, "  {:.2} Hz +- {:.2}", mode.frequency_hz, 2.0 * mode.frequency_error_hz)?;
        writeln!(f, ", damping {:.4} +- {:.4}", mode.damping_ratio, 2.0 * mode.damping_ratio_error)?;
    }
    for order in &motors.orders {
        let name = match order.repeats {
            Repeat::ElectricalTurn => "electrical turns",
            Repeat::HalfTurn => "half turns",
            Repeat::FullStep => "full steps",
        };
        let most = order.amplitudes_um.iter().copied().fold(0.0, f64::max);
        write!(f, "  {name}: at most {most:.1} um")?;
        order.slow_um.map_or(Ok(()), |slow| write!(f, ", {slow:.1} um without the resonance"))?;
        writeln!(f)?;
    }
    motors.remarks.iter().try_for_each(|remark| writeln!(f, "  remark: {remark}"))
}

fn range(from: f64, to: f64) -> String {
    if from == to { format!("{from:.0}") } else { format!("{from:.0} to {to:.0}") }
}
