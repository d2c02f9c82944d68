//! M503: all settings, as the lines that set them.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;
use crate::machine::reports::settings_report::report_settings;

pub(in crate::machine) const ENTRY: Entry =
    Entry::m("Settings", &[503]).nature(Nature::Report).does("S", "reports all settings; S0 as lines to send back");

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { retraction, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (is_for_replay, has_drivers) = (command.switch() == Some(false), !main_loop.power.uarts().is_empty());
    main_loop
        .reply(Answer::words(&|to, facts| {
            if !is_for_replay {
                to.echo_settings();
            }
            report_settings(to, facts.settings, retraction, has_drivers);
        }))
        .await?;
    Ok(Answer::Said)
}
