//! Commands that wait: for the user (M0, M1, M600, M601), for time (G4), and the pause of a print (M24, M25, M602).

use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::waiting::Waiting;
use crate::motion::Work;
use crate::port::{Clock, Pend};
use crate::units::{SubTicks, TICKS_PER_MS};

/// The print is paused.
const PAUSED: &str = "// action:paused";

/// The print goes on.
const RESUMED: &str = "// action:resumed";

/// A question to the user begins.
const ASK: &str = "// action:prompt_begin Paused";
const ASK_FOR_FILAMENT: &str = "// action:prompt_begin Change the filament";

/// Nobody need answer any more.
const PROMPT_END: &str = "// action:prompt_end";

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Says the same to all hosts. One that is not being served and has no room for it misses it.
    async fn announce(&mut self, lines: &[&'static str]) -> Result<(), Interrupt> {
        for line in lines {
            self.hosts.tell_others(format_args!("{line}"));
            self.tell(Answer::Line(line)).await?;
        }
        Ok(())
    }

    /// M0, M1, M600, M601: lets the motion end, and waits for M108, M24, M602 or an answer, or for `ms`; 0 is for ever.
    pub(in crate::machine) async fn await_user(&mut self, ms: u32, filament: bool) -> Result<(), Interrupt> {
        self.finish().await?;
        let question = if filament { ASK_FOR_FILAMENT } else { ASK };
        self.announce(&[PAUSED, question, "// action:prompt_button Continue", "// action:prompt_show"]).await?;
        let deadline = self.ports.clock.now().after_ms(ms);
        self.targets_before = None;
        self.pauses.begin_for_user();
        while !(self.pauses.is_over() || (ms > 0 && self.ports.clock.now() >= deadline)) {
            if let Err(interrupt) = self.turn().await {
                self.pauses.end();
                self.hosts.tell_all(format_args!("{PROMPT_END}"));
                return Err(interrupt);
            }
        }
        self.pauses.end();
        self.announce(&[PROMPT_END]).await?;
        self.heat_again().await?;
        self.announce(&[RESUMED]).await
    }

    /// M25. The hosts are told first, so that they stop sending while the motion ends.
    pub(in crate::machine) async fn pause(&mut self) -> Result<(), Interrupt> {
        self.pauses.pause_print();
        self.announce(&[PAUSED]).await?;
        self.finish().await
    }

    /// M24, M602. Where it has ended another command's wait, that command has told the hosts.
    pub(in crate::machine) async fn resume(&mut self) -> Result<(), Interrupt> {
        if self.pauses.resume_print() {
            self.announce(&[RESUMED]).await?;
        }
        Ok(())
    }

    /// G4: lets time pass in the motion itself; M108 ends it.
    pub(in crate::machine) async fn dwell(&mut self, ms: u32) -> Result<(), Interrupt> {
        self.finish().await?;
        if ms == 0 {
            return Ok(());
        }
        self.until(|c| c.link.has_room()).await?;
        self.pauses.begin(Waiting::Time);
        self.link.send(Work::Dwell(SubTicks::of_ticks(u64::from(ms) * u64::from(TICKS_PER_MS))));
        self.until(|c| c.pauses.is_over() || c.link.is_idle()).await?;
        if !self.link.is_idle() {
            self.drop_motion().await?;
        }
        Ok(())
    }
}
