//! Watched: a host that shows its progress, and that can be stopped.

use crate::stop::Stop;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// A bar on a terminal, and no bar elsewhere.
pub(crate) fn progress_bar(length: u64, of: &'static str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template(&format!("{{wide_bar}} {{pos}}/{{len}} {of}, {{eta}} left")) {
        bar.set_style(style);
    }
    bar
}

/// A host that shows its progress, and that can be stopped.
pub(crate) struct Watched<'s> {
    host: FileHost,
    bar: ProgressBar,
    stop: &'s Stop,
}

impl<'s> Watched<'s> {
    /// With a bar, if there is a terminal.
    pub(crate) fn new(host: FileHost, stop: &'s Stop) -> Self {
        let bar = progress_bar(host.commands(), "commands");
        Self { host, bar, stop }
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) -> FileHost {
        self.bar.finish_and_clear();
        self.host
    }
}

impl Host for Watched<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.host.send(out);
        let answered = self.host.answered();
        // A position a command would cost more than the command.
        if answered.is_multiple_of(64) {
            self.bar.set_position(answered);
        }
    }

    fn clock(&mut self, tick: u64) {
        self.host.clock(tick);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        self.host.interject(out);
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done() || self.stop.is_set()
    }
}
