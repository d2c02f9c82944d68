//! Commands that take time, in one match without a wildcard: a new one does not compile before it is decided what it does.
//!
//! They are awaited: motion, power, storage, drivers, questions to the user. Meanwhile the crank goes on turning.

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
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
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

/// Carries out a command that takes time, with the states that it names, and returns what there is to say before its `ok`.
pub(super) async fn carry_out_blocking<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    states: &mut States,
    command: Blocking<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let States { modal, retraction, clamps, notices, pieces, cold } = states;
    match command {
        Blocking::Line { to, feed } => return Moves { crank, modal, clamps, notices, cold }.line(to, feed).await,
        Blocking::Circulate { to, belt, feed } => {
            return Moves { crank, modal, clamps, notices, cold }.circulate(to, belt, feed).await;
        }
        Blocking::Arc(words) => return Moves { crank, modal, clamps, notices, cold }.arc(&words).await,
        Blocking::Dwell { ms } => dwell(crank, ms).await?,
        Blocking::Retract => return Moves { crank, modal, clamps, notices, cold }.retract(retraction).await,
        Blocking::Recover => return Moves { crank, modal, clamps, notices, cold }.recover(retraction).await,
        Blocking::Home(flags) => home(crank, notices, flags).await?,
        Blocking::Finish => crank.finish().await?,
        Blocking::EmergencyStop => return Err(Interrupt::Halt),
        Blocking::Conditional => {
            crank
                .tell(Answer::Line("Error:which lines run depends on this one, and this firmware would run them all"))
                .await?;
            return Err(Interrupt::Halt);
        }
        Blocking::EnableMotors(flags) => crank.power(motors_of(crank.groups(), flags)).await?,
        Blocking::DisableMotors(flags) => {
            crank.finish().await?;
            crank.unpower(motors_of(crank.groups(), flags));
            notices.renew_for_position();
            let all = !(flags.x || flags.y || flags.z || flags.e);
            if all || flags.e {
                crank.commanded_mut().forget_retraction();
            }
            if all || flags.x || flags.y || flags.z {
                end_by_line(crank, modal).await?;
            }
        }
        Blocking::AwaitUser { ms, filament, park } => {
            return await_user(crank, modal, cold, (ms, filament), park).await;
        }
        Blocking::Pause { parks, park } => return pause(crank, modal, cold, parks, park).await,
        Blocking::Resume => return resume(crank, modal, cold).await,
        Blocking::EndJob => end_by_line(crank, modal).await?,
        Blocking::SaveSettings => return save_settings(crank, pieces).await.map(Answer::Storage),
        Blocking::LoadSettings => return load_settings(crank).await.map(Answer::Storage),
        Blocking::DefaultSettings => return reset_settings(crank).await.map(Answer::Storage),
        Blocking::CheckStorage => return check_storage(crank).await.map(Answer::Storage),
        Blocking::StepsPerMm(words) => return change_resolution(crank, clamps, words).await,
        Blocking::Shaper(words) => return change_shapers(crank, clamps, &words).await,
        Blocking::Advance { time, window } => return change_advance(crank, clamps, time, window).await,
        Blocking::Stealth { on, axes } => return change_mode(crank, modal, clamps, on, axes).await,
        Blocking::FeedPercent(percent) => crank.override_feed(percent).await?,
        Blocking::Heat { words, cools } => return heat_and_wait(crank, notices, clamps, &words, cools).await,
        Blocking::AwaitHeaters => return await_heaters(crank, notices).await,
        Blocking::Fan { fan, speed } => return set_fan(crank, notices, clamps, fan, speed).await,
        Blocking::Tune(words) => return tune(crank, clamps, &words).await,
        Blocking::SelfTest => return test_heaters(crank).await,
        Blocking::MachineRecord(order) => return exchange_machine(crank, pieces, order).await,
        Blocking::AlignBelt { diagnoses: false, repairs: false } => return align_belt(crank, notices).await,
        Blocking::AlignBelt { diagnoses: _, repairs } => return examine_belt(crank, notices, repairs).await,
        Blocking::ReportEndstops => {
            crank.look_at_endstops();
            crank.turn().await?;
            return Ok(Answer::Endstops(crank.status().endstops()));
        }
        Blocking::Diagnose => return diagnose(crank).await,
    }
    Ok(Answer::Nothing)
}
