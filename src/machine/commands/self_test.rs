//! The self-test of the heaters: by itself before the first heating after an update, and SELF_TEST.
//!
//! No firmware has an M-code for it, so it has a name, as Klipper's commands do.

use super::heating::LINE_MS;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::waiting::Waiting;
use crate::port::{Clock, Pend, Storage};
use crate::status::SelfTest;
use crate::thermal::test_subject;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Heaters are about to be switched on: those that were not tested since the last update are tested first. Their targets
    /// wait in the thermal context.
    pub(in crate::machine) fn test_before_heating(&mut self) {
        let Some(image) = self.ports.storage.image() else { return };
        let subject = test_subject(&self.settings.thermal, image);
        if self.self_tests.is_needed(subject) {
            self.begin_self_test(subject, false);
        }
    }

    fn begin_self_test(&mut self, subject: u32, is_asked: bool) {
        self.self_tests.begin(subject, is_asked);
        self.heat_orders.test();
        self.send_orders();
    }

    /// Tells how a self-test ended. One that fails is a fault, which tells of itself.
    pub(in crate::machine) fn follow_self_test(&mut self) {
        let heat = self.link.status().heat();
        let state = heat.self_test();
        let Some(end) = self.self_tests.follow(!self.heat_orders.is_test_waiting(), heat.periods(), state) else {
            return;
        };
        self.hosts.tell_all(match end {
            SelfTest::Passed => format_args!("echo:Self-test passed: each heater warms its own sensor"),
            SelfTest::PutOff => {
                format_args!("echo:Self-test put off until all heaters have readings, and these are below 50 C")
            }
            SelfTest::None | SelfTest::Testing => format_args!("echo:Self-test ended"),
        });
    }

    /// SELF_TEST.
    pub(in crate::machine) async fn test_heaters(&mut self) -> Result<Answer<'static>, Interrupt> {
        if !self.settings.thermal.has_heater() {
            return Ok(Answer::Line("echo:no heaters configured, ignored"));
        }
        self.finish().await?;
        if !self.self_tests.is_under_way() {
            let image = self.ports.storage.image().unwrap_or_default();
            self.begin_self_test(test_subject(&self.settings.thermal, image), true);
        }
        self.pauses.begin(Waiting::SelfTest);
        self.await_self_test().await?;
        self.pauses.end();
        Ok(Answer::Nothing)
    }

    /// Waits for the end of a self-test that is under way, or for M108.
    pub(in crate::machine) async fn await_self_test(&mut self) -> Result<(), Interrupt> {
        let mut next_line = self.ports.clock.now();
        while self.self_tests.is_under_way() && !self.pauses.is_over() {
            if self.ports.clock.now() >= next_line {
                next_line = next_line.after_ms(LINE_MS);
                self.tell(Answer::Heating(None)).await?;
            }
            self.turn().await?;
        }
        Ok(())
    }
}
