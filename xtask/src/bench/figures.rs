//! The figures: results of the jobs' counts, next to our goals and to other firmware.

use super::contexts::Context;
use super::cycles::EXCEPTION;
use super::jobs::Job;
use super::last_resort::Counts;
use super::octopus::PlainStep;
use super::profile::Profile;
use super::rooms::Room;
use crate::image_code::Code;
use anyhow::{Context as _, Result};
use std::collections::BTreeMap;

/// Instructions that the STM32F446 is thought to execute in a second, and QEMU does in a virtual one.
const INSTRUCTIONS_PER_SECOND: f64 = 125e6;

/// Its clock.
const CYCLES_PER_SECOND: f64 = 180e6;

/// The Stepper checks closely one event in this many (`src/motion/queue/steps_in.rs`, REGULAR). It also checks the
/// event with which it asks the generator for more, once for each of the generator's entries.
const REGULAR: u64 = 256;

/// Such an event takes about this many cycles more: 0.3 us, by which it comes later in the emulator
/// (docs/explanation/performance.md, *Lateness*).
const CLOSE_LOOK: u64 = 54;

/// A figure.
pub struct Figure {
    /// Its name, which never changes.
    pub name: &'static str,
    /// The measured value.
    pub value: f64,
    /// Whether more is better.
    pub is_rate: bool,
    /// Whether two runs give the same; a figure that depends on the arrival of bytes is shown, but proves nothing.
    pub is_steady: bool,
    /// Our goal: at most this, or at least this for a rate.
    pub goal: Option<f64>,
    /// Figures of other firmware, from docs/explanation/performance.md.
    pub peers: &'static str,
}

impl Figure {
    /// Whether such a value is as good as a goal, or better.
    pub fn reaches(&self, value: f64, goal: f64) -> bool {
        if self.is_rate { value >= goal } else { value <= goal }
    }
}

const fn figure(name: &'static str, value: f64, goal: Option<f64>, peers: &'static str) -> Figure {
    Figure { name, value, is_rate: false, is_steady: true, goal, peers }
}

/// A rate per second on the STM32F446, from a rate per cycle.
fn rate(name: &'static str, per_cycle: f64, goal: Option<f64>, peers: &'static str) -> Figure {
    let value = (CYCLES_PER_SECOND * per_cycle).round();
    Figure { name, value, is_rate: true, is_steady: true, goal, peers }
}

/// All figures, from the profiles of all jobs and the way of a step on the Octopus.
pub fn figures(profiles: &BTreeMap<Job, Profile>, octopus: &PlainStep, code: &Code<'_>) -> Result<Vec<Figure>> {
    let profile = |job| profiles.get(&job).with_context(|| format!("the job {job} was not run"));
    let mut figures = of_octopus(octopus, profile(Job::S)?, profile(Job::Axis)?);
    figures.extend(of_steps(profile(Job::S)?));
    figures.extend(of_shares(profile(Job::S)?, profile(Job::Shaped)?));
    figures.extend(of_rates(octopus, profile(Job::Dense)?, profile(Job::Axis)?));
    figures.extend(of_planner(profile(Job::Planner)?, profile(Job::Gathered)?));
    figures.extend(of_lines(profile(Job::Parse)?, profile(Job::Plain)?));
    figures.extend(of_mesh(profile(Job::Shaped)?, profile(Job::Meshed)?, profile(Job::MeshedMoves)?, code));
    figures.extend(of_heat(profile(Job::Heat)?));
    Ok(figures)
}

/// Functions by which the generator finds where z is on a surface.
const STATE: [&str; 4] = ["state_on_surface", "slopes_at", "SurfaceFrame", "Heights"];

/// The shaped job on a mesh, compared with the same one without, and moves that are planned on the mesh.
fn of_mesh(flat: &Profile, meshed: &Profile, moves: &Profile, code: &Code<'_>) -> Vec<Figure> {
    let generator = |profile: &Profile| profile.in_context(Context::Generator).instructions as f64;
    let isr = meshed.in_context(Context::Steps).instructions as f64;
    let all = meshed.work(|_| true).instructions as f64;
    let calls = |name| meshed.calls(Context::Generator, code, name).max(1) as f64;
    let is_of_state = |address| STATE.iter().any(|name| code.symbol_of(address).contains(name));
    let of_states = meshed.work(|spot| spot.context == Context::Generator && is_of_state(spot.address));
    let planned = moves.in_room(Room::Planner).instructions as f64 / f64::from(Job::MeshedMoves.moves());
    vec![
        figure("mesh_isr_insn_per_event", isr / meshed.events as f64, None, ""),
        figure("mesh_stepgen_insn_per_event", generator(meshed) / meshed.events as f64, None, ""),
        figure("mesh_insn_per_piece", (generator(meshed) - generator(flat)) / calls("unbent"), None, ""),
        figure("mesh_insn_per_state", of_states.instructions as f64 / calls("state_on_surface"), None, ""),
        figure("mesh_states_per_piece", calls("state_on_surface") / calls("unbent"), None, ""),
        figure("mesh_planner_insn_per_move", planned, None, ""),
        figure("mesh_all_in_share_job_s", all / (INSTRUCTIONS_PER_SECOND * meshed.seconds), Some(0.045), ""),
    ]
}

/// Others, all in.
const ALL_IN: &str = "grblHAL 1.88 M without shaping, RRF 0.75 M, Prusa 0.13 M";

/// Others' step code, instructions for a motor step of job S.
const PEERS_ISR: &str = "grblHAL 52.7, Klipper 60.8, Marlin 84, RRF 126, Prusa 886";

/// Others' step code, motor steps a second of job S.
const PEERS_PEAK: &str = "Klipper 1.70 M, grblHAL 1.88 M, Marlin 1.19 M, RRF 0.75 M, Prusa 0.13 M";

/// A plain event on the Octopus, and how many motor steps that is in two jobs.
fn of_octopus(step: &PlainStep, s: &Profile, axis: &Profile) -> Vec<Figure> {
    let instructions = step.instructions as f64;
    let motor_steps = |job: &Profile| job.motor_steps as f64 / job.events as f64;
    let us = |cycles: u64| cycles as f64 / CYCLES_PER_SECOND * 1e6;
    let peak = |name, job, goal, peers| rate(name, motor_steps(job) / step.cycles as f64, Some(goal), peers);
    vec![
        figure("octopus_isr_insn_per_event", instructions, Some(30.0), ""),
        figure("octopus_isr_insn_per_motor_step", instructions / motor_steps(s), Some(17.0), PEERS_ISR),
        figure("octopus_isr_cycles_per_event", step.cycles as f64, Some(120.0), ""),
        figure("octopus_isr_cold_cycles_per_event", step.cold() as f64, None, ""),
        figure("octopus_isr_apb_accesses_per_event", step.apb as f64, Some(2.0), ""),
        figure("octopus_isr_flash_lines", (step.lines.len() + step.constants.len()) as f64, None, ""),
        figure("octopus_step_pulse_cycles", step.pulse as f64, None, ""),
        figure("octopus_lone_step_late_us", us(step.late.0), Some(0.5), ""),
        figure("octopus_lone_step_cold_late_us", us(step.late.1), Some(0.5), ""),
        peak("octopus_peak_motor_steps_per_s", s, 3e6, PEERS_PEAK),
        peak("octopus_peak_axis_motor_steps_per_s", axis, 5e6, ""),
    ]
}

/// Instructions from the entry of a fault's handler in the Octopus's image. Until heaters are low: the upper bound, and
/// the number that QEMU executes. And until drivers are off.
pub fn of_last_resort(most: usize, counted: Counts) -> [Figure; 3] {
    let figure = |name, instructions| figure(name, instructions as f64, Some(50.0), "");
    [
        figure("octopus_last_resort_insn", most),
        figure("octopus_heaters_low_insn", counted.heaters),
        figure("octopus_drivers_off_insn", counted.drivers),
    ]
}

/// Job S.
fn of_steps(s: &Profile) -> Vec<Figure> {
    let (events, motor_steps) = (s.events as f64, s.motor_steps as f64);
    let isr = s.in_context(Context::Steps).instructions as f64;
    let rig = s.work(|spot| spot.context == Context::Steps && spot.room == Some(Room::Rig)).instructions as f64;
    let generator = s.in_context(Context::Generator).instructions as f64;
    let all = s.work(|_| true).instructions as f64;
    let cycles = s.cycles(&[Context::Steps], |spot| spot.room != Some(Room::Rig)) as f64;
    vec![
        figure("isr_insn_per_event", isr / events, Some(30.0), ""),
        figure("isr_insn_per_motor_step", isr / motor_steps, Some(17.0), PEERS_ISR),
        figure("isr_without_rig_insn_per_event", (isr - rig) / events, Some(30.0), ""),
        figure("isr_without_rig_insn_per_motor_step", (isr - rig) / motor_steps, Some(17.0), PEERS_ISR),
        figure("isr_without_rig_cycles_per_motor_step", cycles / motor_steps, None, "grblHAL 95.6, Klipper 105.7"),
        figure("isr_insn_worst", s.longest(Context::Steps) as f64, None, ""),
        figure("isr_entries_per_event", s.entries(Context::Steps) as f64 / events, None, ""),
        figure("stepgen_insn_per_event", generator / events, None, "the prototype of a mere merge 59"),
        figure("all_in_insn_per_motor_step", all / motor_steps, None, ""),
    ]
}

/// Job S without and with shaping: the processor share of everything.
fn of_shares(plain: &Profile, shaped: &Profile) -> Vec<Figure> {
    let share = |profile: &Profile, with_rig: bool| {
        let work = profile.work(|spot| with_rig || spot.room != Some(Room::Rig)).instructions as f64;
        work / (INSTRUCTIONS_PER_SECOND * profile.seconds)
    };
    vec![
        figure("all_in_share_job_s", share(shaped, true), Some(0.1), "Prusa 0.12 for stepping alone"),
        figure("all_in_without_rig_share_job_s", share(shaped, false), None, ""),
        figure("all_in_plain_share_job_s", share(plain, true), None, ""),
    ]
}

/// The dense jobs: how many steps fit into a second if this work is all there is.
fn of_rates(octopus: &PlainStep, dense: &Profile, axis: &Profile) -> Vec<Figure> {
    let in_qemu = |name, job: &Profile, contexts: &[Context], with_rig, goal, peers| {
        let cycles = job.cycles(contexts, |spot| with_rig || spot.room != Some(Room::Rig));
        rate(name, job.motor_steps as f64 / cycles as f64, goal, peers)
    };
    // All except the step interrupt, which is replaced by the Octopus's, with its waits.
    let on_octopus = |name, job: &Profile, goal| {
        let others = job.cycles(&Context::BUSY, |spot| spot.context != Context::Steps);
        let exceptions = EXCEPTION * job.entries(Context::Steps);
        let close_looks = job.events / REGULAR + job.entries(Context::Generator);
        let steps = octopus.cycles * job.events + CLOSE_LOOK * close_looks;
        let cycles = others.saturating_sub(exceptions) + steps + job.flash(&Context::BUSY);
        rate(name, job.motor_steps as f64 / cycles as f64, Some(goal), ALL_IN)
    };
    let (all, isr) = (&Context::BUSY, &[Context::Steps]);
    let flash = |contexts: &[Context]| dense.flash(contexts) as f64 / dense.events as f64;
    vec![
        // A tenth of a cycle, because it shows the linker's placement.
        Figure { is_steady: false, ..figure("octopus_isr_flash_cycles_per_event", flash(isr), None, "") },
        figure("octopus_flash_cycles_per_event", flash(all), None, ""),
        in_qemu("sustained_motor_steps_per_s", dense, all, true, Some(2e6), ALL_IN),
        in_qemu("sustained_without_rig_motor_steps_per_s", dense, all, false, Some(2e6), ALL_IN),
        in_qemu("sustained_axis_motor_steps_per_s", axis, all, true, Some(2e6), ALL_IN),
        on_octopus("octopus_sustained_motor_steps_per_s", dense, 1.8e6),
        on_octopus("octopus_sustained_axis_motor_steps_per_s", axis, 3.2e6),
        in_qemu("peak_event_motor_steps_per_s", dense, isr, true, Some(3e6), PEERS_PEAK),
        in_qemu("peak_event_without_rig_motor_steps_per_s", dense, isr, false, Some(3e6), PEERS_PEAK),
        in_qemu("peak_event_axis_motor_steps_per_s", axis, isr, true, Some(5e6), ""),
        in_qemu("peak_event_axis_without_rig_motor_steps_per_s", axis, isr, false, Some(5e6), ""),
    ]
}

/// The planner's jobs.
fn of_planner(planner: &Profile, gathered: &Profile) -> Vec<Figure> {
    let mean =
        |job: Job, profile: &Profile| profile.in_room(Room::Planner).instructions as f64 / f64::from(job.moves());
    let worst = planner.most(Room::Planner) as f64;
    const PEERS: &str = "grblHAL 1120-4002, Marlin 3082-3859";
    let per_move = figure("planner_insn_per_move", mean(Job::Planner, planner), Some(1000.0), PEERS);
    let at_rest = mean(Job::Gathered, gathered);
    vec![
        // It depends a little on how the bytes fall.
        Figure { is_steady: false, ..per_move },
        figure("planner_gathered_insn_per_move", at_rest, Some(1000.0), PEERS),
        // A short slowdown of the stream replans all moves.
        Figure { is_steady: false, ..figure("planner_insn_worst", worst, Some(2000.0), "") },
    ]
}

/// The circle, with numbered lines and with plain ones.
fn of_lines(parse: &Profile, plain: &Profile) -> Vec<Figure> {
    let lines = f64::from(Job::Parse.moves());
    let bytes = |profile: &Profile| profile.entries(Context::Received) as f64;
    // The host pauses between two lines; work in the pauses does not belong to the lines.
    let in_room = |profile: &Profile, room| {
        profile.work(|spot| spot.context == Context::Console && spot.room == Some(room)).instructions as f64
    };
    let protocol = in_room(parse, Room::Protocol);
    vec![
        figure(
            "parse_insn_per_line",
            parse.in_room(Room::Gcode).instructions as f64 / lines,
            Some(1000.0),
            "grblHAL 1914, modal state included",
        ),
        figure("machine_insn_per_line", in_room(parse, Room::Machine) / lines, None, ""),
        figure("protocol_insn_per_line", protocol / lines, None, ""),
        figure("protocol_insn_per_byte", protocol / bytes(parse), None, ""),
        figure("plain_protocol_insn_per_line", in_room(plain, Room::Protocol) / lines, None, ""),
        // It depends on which interrupts fall in between.
        Figure { is_steady: false, ..figure("ok_insn_after_last_byte", parse.to_answer(), None, "") },
    ]
}

/// A control period with hotend and bed on, without the plant that they heat.
fn of_heat(heat: &Profile) -> Vec<Figure> {
    let periods = heat.entries(Context::Thermal) as f64;
    let work =
        heat.work(|spot| spot.context == Context::Thermal && spot.room == Some(Room::Thermal)).instructions as f64;
    // Most of a period's work depends on the measured values.
    vec![Figure { is_steady: false, ..figure("thermal_insn_per_period", work / periods, Some(3000.0), "") }]
}
