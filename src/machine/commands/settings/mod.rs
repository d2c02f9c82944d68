//! Settings as G-code sees them: set and stored.
//!
//! | file | does | commands |
//! |---|---|---|
//! | [`plain`] | takes numbers of rows of `settings` if all are legal | as the rows say |
//! | [`rules`] | the rules of some of these commands | M92, M203, M205, M301, M304 |
//! | [`velocity_limit`] | limits in Klipper's words | SET_VELOCITY_LIMIT |
//! | [`machine_record`] | exchanges the whole machine with a computer | MACHINE_GET, MACHINE_PUT, MACHINE_STORE |
//! | [`kept_mesh`] | keeps the mesh of the bed there too | M500, M501, M420 L |
//! | [`stored`] | keeps all settings in memory that survives without power | M500, M501, M502, M504 |
//!
//! `crate::settings` defines a setting and its legal range, `crate::storage` its record. Settings of drivers and
//! shapers are set in the files of these names, one folder up, and stored here. The values of M207 and M208 are not
//! stored (`retraction`). `reports::settings_report` writes each setting as the line that sets it.

pub(in crate::machine) mod kept_mesh;
mod machine_record;
mod plain;
mod rules;
pub(in crate::machine) mod stored;
mod velocity_limit;

use super::shaping::{change_advance, change_shapers};
use super::states::States;
use crate::gcode::SettingCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use core::pin::pin;
use kept_mesh::{keep_mesh, take_mesh_to_use};
use machine_record::exchange_machine;
use plain::set_plain;
use stored::{check_storage, load_settings, reset_settings, save_settings};
use velocity_limit::set_velocity_limit;

/// Carries out a command about settings.
pub(super) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &SettingCommand<'a>,
) -> Result<Answer<'a>, Interrupt> {
    Ok(match *command {
        SettingCommand::Plain(ref words) => return set_plain(main_loop, states, words).await,
        SettingCommand::VelocityLimit(ref words) => {
            set_velocity_limit(words, &mut main_loop.live_settings(), &mut states.clamps)
        }
        SettingCommand::Shaper(ref words) => {
            return apart(pin!(change_shapers(main_loop, &mut states.clamps, words))).await;
        }
        SettingCommand::Advance { time, window } => {
            return change_advance(main_loop, &mut states.clamps, time, window).await;
        }
        SettingCommand::SaveSettings => {
            if let Some(news) = keep_mesh(main_loop).await? {
                main_loop.tell(Answer::Mesh(news));
            }
            return save_settings(main_loop, &mut states.pieces).await.map(Answer::Storage);
        }
        SettingCommand::LoadSettings => {
            let news = load_settings(main_loop, &mut states.pieces).await?;
            let mesh = take_mesh_to_use(main_loop).await?;
            main_loop.tell(mesh);
            Answer::Storage(news)
        }
        SettingCommand::DefaultSettings => return reset_settings(main_loop).await.map(Answer::Storage),
        SettingCommand::CheckStorage => return check_storage(main_loop, &mut states.pieces).await.map(Answer::Storage),
        SettingCommand::ReportSettings { for_replay } => Answer::Settings { retraction: states.retraction, for_replay },
        SettingCommand::MachineRecord(order) => {
            return exchange_machine(main_loop, &mut states.pieces, order).await;
        }
    })
}
