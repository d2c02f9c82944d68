//! Replies: an answer is written here; if a part finds no room, the caller waits. What a command says on its way goes
//! ahead, into room that is held for it, so only `reply` has a place to wait in.

use super::heaters::Heaters;
use super::place::named_place;
use crate::connectors::Heater;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::{Progress, ReplyWriter};
use crate::machine::answers::words::{Facts, Words};
use crate::machine::hosts::schedule::Report;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::fan_report::FanTurns;
use crate::machine::reports::heat_report::Temperatures;
use crate::machine::state::known_bed::KnownBed;
use crate::machine::state::trimming::Trimming;
use crate::port::Wake;
use crate::protocol::{Echo, Owed, Replies};
use crate::settings::Settings;
use crate::status::Status;
use crate::storage::is_present;
use crate::text::Text;
use crate::units::Instant;

impl<'m, P: PortSet, W: Wake> MainLoop<'m, P, W> {
    /// Sends an answer to the host being served, as soon as there is room for it.
    pub async fn reply(&mut self, answer: Answer<'_>) -> Result<(), Interrupt> {
        self.progress = Progress::default();
        while !self.write(&answer) {
            self.poll().await?;
        }
        Ok(())
    }

    /// Says lines to the host being served, at once: they go ahead of what waits for room. Between two answers there is
    /// room for 1024 bytes of them. So a command says what it has to say on its way, and an answer of few lines.
    pub fn tell(&mut self, words: impl Fn(&mut ReplyWriter<'_>, &Facts<'_>)) {
        self.write_ahead(&words);
    }

    /// Says a line in the same way.
    pub fn say(&mut self, line: Text<'_>) {
        self.tell(|to, _| to.say(line));
    }

    #[inline(never)]
    fn write_ahead(&mut self, words: &dyn Words) {
        self.progress = Progress::default();
        self.hosts.output().0.go_ahead(true);
        let is_told = self.write(&Answer::Words(words));
        debug_assert!(is_told, "no command tells more than there is room for");
        self.hosts.output().0.go_ahead(false);
    }

    /// Writes the parts of an answer for which there is room; true if all are written.
    pub(super) fn write(&mut self, answer: &Answer<'_>) -> bool {
        self.progress.begin();
        if matches!(answer, Answer::Ok) {
            self.write_ok();
            return self.progress.is_complete();
        }
        let Self { hosts, progress, settings, status, storage, trimming, bed, heat, .. } = self;
        let to = &mut ReplyWriter::new(progress, hosts);
        match *answer {
            Answer::Nothing | Answer::Said | Answer::Held | Answer::Ok => {}
            Answer::LineNumber(number) => to.put(&|replies| replies.line_number(number)),
            Answer::TooLong => to.put(&Replies::too_long),
            Answer::Question(last) => to.put(&|replies| replies.question(last)),
            Answer::Resend(reason, last) => to.put(&|replies| replies.resend(reason, last)),
            Answer::Unknown(text) => to.put(&|replies| replies.unknown(text)),
            Answer::NotObeyed(command, word) => {
                to.say(text!("echo:{command} {} is not supported by this firmware", Echo(word)));
            }
            Answer::NotHomed => to.say(text!("echo:move ignored: home its axes first (G28)")),
            Answer::Line(line) => to.say(text!("{line}")),
            Answer::Words(words) | Answer::WordsWithOk(words) => {
                words.write(to, &facts(settings, status, heat, trimming, bed, is_present(storage)));
            }
        }
        self.progress.is_complete()
    }

    /// The temperatures of the heaters.
    fn temperatures(&self) -> Temperatures {
        let Self { settings, status, heat, trimming, bed, .. } = self;
        Temperatures::of(&facts(settings, status, heat, trimming, bed, false))
    }

    /// Writes `ok`, with the queue state for a host that fills a window, if it is wanted.
    fn write_ok(&mut self) {
        if !self.settings.advanced_ok {
            return ReplyWriter::new(&mut self.progress, &mut self.hosts).put(&Replies::ok);
        }
        let (line, bytes) = self.hosts.window();
        let moves = self.motion.room(&self.settings);
        ReplyWriter::new(&mut self.progress, &mut self.hosts).put(&|replies| replies.advanced_ok(line, moves, bytes));
    }

    /// Answers lines that were taken out of their turn, so that the bytes behind them can be read.
    pub(super) fn answer_early(&mut self) {
        for place in 0..self.hosts.len() {
            let Some((&mut Owed { position, .. }, _)) = self.hosts.owed(place) else { continue };
            let (temperatures, position) = (self.temperatures(), named_place(self, position == Some(true)));
            if let Some((owed, replies)) = self.hosts.owed(place) {
                owed.pay(replies, format_args!("ok {temperatures}"), format_args!("{position}"));
            }
        }
    }

    /// Sends the periodic reports.
    pub(super) fn report_unasked(&mut self, now: Instant) {
        if self.hosts.is_due(Report::Temperatures, now) {
            let temperatures = self.temperatures();
            self.hosts.report(Report::Temperatures, now, format_args!(" {temperatures}"));
        }
        if self.hosts.is_due(Report::FanTurns, now) {
            let turns = FanTurns { settings: &self.settings, heat: self.status.heat() };
            if turns.has_any() {
                self.hosts.report(Report::FanTurns, now, format_args!("{turns}"));
            }
        }
        if self.hosts.is_due(Report::Position, now) {
            let position = named_place(self, true);
            self.hosts.report(Report::Position, now, format_args!("{position}"));
        }
    }
}

/// What words may read.
fn facts<'f>(
    settings: &'f Settings,
    status: &'f Status,
    heat: &Heaters<'_>,
    trimming: &'f Trimming,
    bed: &'f KnownBed,
    has_storage: bool,
) -> Facts<'f> {
    let targets = Heater::ALL.map(|heater| heat.target(heater));
    Facts { settings, status, trimming, mesh: bed.mesh(), targets, is_testing: heat.is_testing(), has_storage }
}
