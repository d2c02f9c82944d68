//! Commands that take time, in one match without a wildcard: a new command does not compile without an arm.
//!
//! They are awaited: motion, power, storage, drivers, questions to the user. The main loop keeps running during these
//! waits.

use super::belt::{align_belt, examine_belt};
use super::drivers::change_mode;
use super::fans::set_fan;
use super::heating::{TargetWords, await_heaters, heat_and_wait};
use super::homing::home;
use super::job::end_by_line;
use super::machine_record::exchange_machine;
use super::motors::{diagnose, motors_of};
use super::moves::{ArcWords, Moves};
use super::pause::{await_user, pause, resume};
use super::self_test::test_heaters;
use super::settings::set::change_resolution;
use super::settings::stored::{check_storage, load_settings, reset_settings, save_settings};
use super::shaping::{ShaperWords, change_advance, change_shapers};
use super::states::States;
use super::tuning::{TuningWords, tune};
use super::waits::dwell;
use crate::gcode::{AxisFlags, AxisWords, MachineRecord, Number, ParkWords};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// A command that takes time.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Blocking<'c> {
    /// G0, G1.
    Line { to: &'c AxisWords, feed: Option<Number> },
    /// G0, G1 with C.
    Circulate { to: &'c AxisWords, belt: Number, feed: Option<Number> },
    /// G2, G3.
    Arc(ArcWords<'c>),
    /// G4.
    Dwell { ms: u32 },
    /// G10.
    Retract,
    /// G11.
    Recover,
    /// G28.
    Home(AxisFlags),
    /// M400.
    Finish,
    /// M112.
    EmergencyStop,
    /// A condition that other lines depend on.
    Conditional,
    /// M17.
    EnableMotors(AxisFlags),
    /// M18, M84.
    DisableMotors(AxisFlags),
    /// M915.
    AlignBelt { diagnoses: bool, repairs: bool },
    /// M0, M1, M600, M601.
    AwaitUser { ms: u32, filament: bool, park: &'c ParkWords },
    /// M25, M125.
    Pause { parks: bool, park: &'c ParkWords },
    /// M77.
    EndJob,
    /// M24, M602.
    Resume,
    /// M500.
    SaveSettings,
    /// M501.
    LoadSettings,
    /// M502.
    DefaultSettings,
    /// M504.
    CheckStorage,
    /// M92.
    StepsPerMm(&'c AxisWords),
    /// M593.
    Shaper(ShaperWords),
    /// M900, M572.
    Advance { time: Option<Number>, window: Option<Number> },
    /// M569.
    Stealth { on: Option<bool>, axes: AxisFlags },
    /// M220, with a percentage that is in range.
    FeedPercent(u16),
    /// M109, M190, M191.
    Heat { words: TargetWords, cools: bool },
    /// M116.
    AwaitHeaters,
    /// M106, M107.
    Fan { fan: u8, speed: Number },
    /// M303.
    Tune(TuningWords),
    /// SELF_TEST.
    SelfTest,
    /// MACHINE_GET, MACHINE_PUT, MACHINE_STORE.
    MachineRecord(MachineRecord<'c>),
    /// M119.
    ReportEndstops,
    /// M122.
    Diagnose,
}

/// Carries out a command that takes time, with the states that it names, and returns the answer before its `ok`.
pub(super) async fn carry_out_blocking<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: Blocking<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let States { modal, retraction, clamps, notices, pieces, cold } = states;
    match command {
        Blocking::Line { to, feed } => return Moves { main_loop, modal, clamps, notices, cold }.line(to, feed).await,
        Blocking::Circulate { to, belt, feed } => {
            return Moves { main_loop, modal, clamps, notices, cold }.circulate(to, belt, feed).await;
        }
        Blocking::Arc(words) => return Moves { main_loop, modal, clamps, notices, cold }.arc(&words).await,
        Blocking::Dwell { ms } => dwell(main_loop, ms).await?,
        Blocking::Retract => return Moves { main_loop, modal, clamps, notices, cold }.retract(retraction).await,
        Blocking::Recover => return Moves { main_loop, modal, clamps, notices, cold }.recover(retraction).await,
        Blocking::Home(flags) => home(main_loop, notices, flags).await?,
        Blocking::Finish => main_loop.finish().await?,
        Blocking::EmergencyStop => return Err(Interrupt::Halt),
        Blocking::Conditional => {
            main_loop
                .reply(Answer::Line("Error:this line decides which lines run, and this firmware cannot skip lines"))
                .await?;
            return Err(Interrupt::Halt);
        }
        Blocking::EnableMotors(flags) => main_loop.power_up(motors_of(main_loop.groups(), flags)).await?,
        Blocking::DisableMotors(flags) => {
            main_loop.finish().await?;
            main_loop.unpower(motors_of(main_loop.groups(), flags));
            notices.renew_for_position();
            let all = !(flags.x || flags.y || flags.z || flags.e);
            if all || flags.e {
                main_loop.commanded.forget_retraction();
            }
            if all || flags.x || flags.y || flags.z {
                end_by_line(main_loop, modal).await?;
            }
        }
        Blocking::AwaitUser { ms, filament, park } => {
            return await_user(main_loop, modal, cold, (ms, filament), park).await;
        }
        Blocking::Pause { parks, park } => return pause(main_loop, modal, cold, parks, park).await,
        Blocking::Resume => return resume(main_loop, modal, cold).await,
        Blocking::EndJob => end_by_line(main_loop, modal).await?,
        Blocking::SaveSettings => return save_settings(main_loop, pieces).await.map(Answer::Storage),
        Blocking::LoadSettings => return load_settings(main_loop).await.map(Answer::Storage),
        Blocking::DefaultSettings => return reset_settings(main_loop).await.map(Answer::Storage),
        Blocking::CheckStorage => return check_storage(main_loop).await.map(Answer::Storage),
        Blocking::StepsPerMm(words) => return change_resolution(main_loop, clamps, words).await,
        Blocking::Shaper(words) => return change_shapers(main_loop, clamps, &words).await,
        Blocking::Advance { time, window } => return change_advance(main_loop, clamps, time, window).await,
        Blocking::Stealth { on, axes } => return change_mode(main_loop, modal, clamps, on, axes).await,
        Blocking::FeedPercent(percent) => main_loop.override_feed(percent).await?,
        Blocking::Heat { words, cools } => return heat_and_wait(main_loop, notices, clamps, &words, cools).await,
        Blocking::AwaitHeaters => return await_heaters(main_loop, notices).await,
        Blocking::Fan { fan, speed } => return set_fan(main_loop, notices, clamps, fan, speed).await,
        Blocking::Tune(words) => return tune(main_loop, clamps, &words).await,
        Blocking::SelfTest => return test_heaters(main_loop).await,
        Blocking::MachineRecord(order) => return exchange_machine(main_loop, pieces, order).await,
        Blocking::AlignBelt { diagnoses: false, repairs: false } => return align_belt(main_loop, notices).await,
        Blocking::AlignBelt { diagnoses: _, repairs } => return examine_belt(main_loop, notices, repairs).await,
        Blocking::ReportEndstops => {
            main_loop.look_at_endstops();
            main_loop.poll().await?;
            return Ok(Answer::Endstops(main_loop.status().endstops()));
        }
        Blocking::Diagnose => return diagnose(main_loop).await,
    }
    Ok(Answer::Nothing)
}
