//! M500, M501, M502, M504: settings in storage.

use super::kept_mesh::{keep_mesh, take_mesh_to_use};
use super::stored::{check_storage, load_settings, reset_settings, save_settings};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Settings", &[500, 501, 502])
    .nature(Nature::Mode)
    .does("", "saves, loads, restores the defaults")
    .examples(&[
        ("M500", &["echo:Settings not stored: no storage on this machine"]),
        ("M501", &["echo:Settings unchanged: *"]),
        ("M502", &["echo:Hardcoded Default Settings Loaded"]),
    ]);

pub(in crate::machine) const CHECK: Entry =
    Entry::m("Settings", &[504]).nature(Nature::Mode).does("", "checks what is stored");

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { pieces, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    match command.code() {
        500 => {
            if let Some(news) = keep_mesh(main_loop).await? {
                main_loop.say(text!("{news}"));
            }
            save_settings(main_loop, pieces).await
        }
        501 => {
            let loaded = load_settings(main_loop, pieces).await?;
            if let Some(news) = take_mesh_to_use(main_loop).await? {
                main_loop.say(text!("{news}"));
            }
            match loaded {
                Ok(found) => main_loop.tell(|to, _| found.report_loaded(to)),
                Err(why) => main_loop.say(text!("echo:Settings unchanged: {why}")),
            }
            Ok(Answer::Said)
        }
        502 => reset_settings(main_loop).await,
        _ => check_storage(main_loop, pieces).await,
    }
}
