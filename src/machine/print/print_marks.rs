//! M75, M77: a print begins, and ends.

use super::job::end_by_line;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Jobs, pauses and waits", &[75, 77])
    .does("", "a job begins, ends")
    .examples(&[("M75", &[]), ("M77", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if command.code() == 75 {
        let host = main_loop.hosts.serving();
        main_loop.job.begin(host);
    } else {
        end_by_line(main_loop, modal).await?;
    }
    Ok(Answer::Nothing)
}
