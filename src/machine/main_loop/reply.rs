//! Replies: an answer is written here; if a part finds no room, the caller waits. What a command says on its way goes
//! ahead, into room that is kept for it, so only `reply` has a place to wait in.
//!
//! An answer of one line is worded here, one of several lines in `reports`. If a report needs data that the main loop
//! does not own, the command returns that data in its answer.

use crate::connectors::Heater;
use crate::gcode::{Absent, Flaw, Named, Part};
use crate::kinematics::Grouping;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::{Progress, ReplyWriter};
use crate::machine::answers::setting::Setting;
use crate::machine::hosts::schedule::Report;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::belt_report::report_belt;
use crate::machine::reports::buzz_report::report_buzz;
use crate::machine::reports::driver_report::report_driver;
use crate::machine::reports::fan_report::FanTurns;
use crate::machine::reports::heat_report::{Temperatures, report_heat, report_tuned};
use crate::machine::reports::heat_settings_report::report_heat_setting;
use crate::machine::reports::machine_report::report_machine;
use crate::machine::reports::mesh_report::report_mesh;
use crate::machine::reports::probe_report::report_probe;
use crate::machine::reports::report::{Position, report_endstops, report_firmware, report_overload, report_z_offset};
use crate::machine::reports::resonance_report::report_resonance;
use crate::machine::reports::screw_report::report_screws;
use crate::machine::reports::settings_report::{report_setting, report_settings};
use crate::machine::reports::storage_report::report_storage;
use crate::port::{BoardFacts, Wake};
use crate::protocol::{Echo, Owed, Replies};
use crate::settings::Settings;
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

    /// Says an answer of few lines to the host being served, at once: they go ahead of what waits for room. It is for
    /// what a command says on its way, and the answer at its end waits.
    pub fn tell(&mut self, answer: Answer<'_>) {
        self.progress = Progress::default();
        self.hosts.output().0.go_ahead(true);
        let is_told = self.write(&answer);
        debug_assert!(is_told, "no command tells more than there is room for");
        self.hosts.output().0.go_ahead(false);
    }

    /// Says a line in the same way.
    pub fn say(&mut self, line: Text<'_>) {
        self.progress = Progress::default();
        self.progress.begin();
        self.hosts.output().0.go_ahead(true);
        ReplyWriter::new(&mut self.progress, &mut self.hosts).say(line);
        debug_assert!(self.progress.is_complete(), "no command tells more than there is room for");
        self.hosts.output().0.go_ahead(false);
    }

    /// Writes the parts of an answer for which there is room; true if all are written.
    pub(super) fn write(&mut self, answer: &Answer<'_>) -> bool {
        self.progress.begin();
        match answer {
            Answer::Nothing | Answer::Then(_) | Answer::Kept => {}
            Answer::Ok => self.reply_ok(),
            answer => self.reply_answer(answer),
        }
        self.progress.is_complete()
    }

    /// Where the program is, or with `real` where the tool is.
    fn position(&self, real: bool) -> Position<'m> {
        let counts = self.motion.counts();
        let at_motors = self.motion.to_mm(self.motion.real_steps());
        let (_, z) = self.circulation.z();
        let at = if real { self.motion.seen(at_motors, z, self.trimming.held()) } else { self.commanded.position() };
        let ran = match (real, self.motion.grouping()) {
            (false, _) => self.circulation.commanded(),
            (true, Grouping::Tool | Grouping::Trim | Grouping::Screw) => {
                self.circulation.length(self.settings.axes.x.steps_per_mm)
            }
            (true, Grouping::Circulation) => {
                let [_, _, on_the_way, _] = at_motors;
                self.circulation.length(self.settings.axes.x.steps_per_mm) + on_the_way
            }
        };
        let circulation = self.settings.belt.is_closed.then_some(ran);
        Position::new(at, circulation, counts, &self.commanded, self.motion.real())
    }

    /// The temperatures of the heaters.
    fn temperatures(&self) -> Temperatures {
        Temperatures::new(&self.settings, self.status.heat(), !self.heat.is_testing(), |heater| {
            self.heat.target(heater)
        })
    }

    fn reply_answer(&mut self, answer: &Answer<'_>) {
        if let Answer::Position { real } = *answer {
            let position = self.position(real);
            return ReplyWriter::new(&mut self.progress, &mut self.hosts).say(text!("{position}"));
        }
        if let Answer::Says(says) = answer {
            let to = &mut ReplyWriter::new(&mut self.progress, &mut self.hosts);
            return says.write(to, &self.settings, self.status);
        }
        // These need all of the main loop, which is taken apart in the next lines.
        let temperatures = self.temperatures();
        let targets = Heater::ALL.map(|heater| self.heat.target(heater));
        let Self {
            hosts, progress, settings, motion, status, power, board, storage, trimming, bed, first_layer, ..
        } = self;
        let s: &Settings = settings;
        let to = &mut ReplyWriter::new(progress, hosts);
        match *answer {
            Answer::Nothing
            | Answer::Then(_)
            | Answer::Kept
            | Answer::Ok
            | Answer::Position { .. }
            | Answer::Says(_) => {}
            Answer::LineNumber(number) => to.put(&|replies| replies.line_number(number)),
            Answer::TooLong => to.put(&Replies::too_long),
            Answer::Question(last) => to.put(&|replies| replies.question(last)),
            Answer::Resend(reason, last) => to.put(&|replies| replies.resend(reason, last)),
            Answer::Unknown(text) => to.put(&|replies| replies.unknown(text)),
            Answer::Malformed(flaw) => report_malformed(to, flaw),
            Answer::NotObeyed(command, word) => {
                to.say(text!("echo:{command} {} is not supported by this firmware", Echo(word)));
            }
            Answer::NotHomed => to.say(text!("echo:move ignored: home its axes first (G28)")),
            Answer::ZOffset => report_z_offset(to, motion.shifted_z(), s, first_layer.are_stored(s)),
            Answer::Temperatures => to.say(text!("ok {temperatures}")),
            Answer::Heating(None) => to.say(text!(" {temperatures} W:?")),
            Answer::Heating(Some(missing)) => to.say(text!(" {temperatures} W:{missing}")),
            Answer::NoHeat(code, fault) => to.say(text!("echo:{code} ignored: {fault}")),
            Answer::HeatSetting(setting) => report_heat_setting(to, setting, &s.thermal),
            Answer::Tuned(heater, tuned) => report_tuned(to, heater, &tuned),
            Answer::Start => {
                to.put(&Replies::start);
                to.say(text!("echo:corehbot {}", env!("CARGO_PKG_VERSION")));
            }
            Answer::Line(line) => to.say(text!("{line}")),
            // Not as a text: what a host said is not unpacked.
            Answer::Message(message) => to.put(&|replies| replies.line(format_args!("{message}"))),
            // Marlin's words (language.h, STR_SD_OPEN_FILE_FAIL).
            Answer::NoCard(name) => {
                let name = Echo(name);
                to.say(text!("echo:open failed, File: {name}. There is no card; lines up to M29 are ignored"));
            }
            Answer::UploadEnded(lines) => {
                to.say(text!("echo:upload ended: there is no card, ignored lines: {lines}"));
            }
            Answer::Firmware => report_firmware(to, is_present(storage), status.inputs(), s),
            Answer::Endstops(pressed) => {
                report_endstops(to, pressed, status.inputs(), &s.endstops, status.heat().filament());
            }
            Answer::Heat => report_heat(to, s, status.heat(), status.fault(), targets),
            Answer::Overload => {
                report_overload(to, status.overload());
                if let Some(warning) = board.warning() {
                    to.say(text!("echo:{warning}"));
                }
            }
            Answer::Machine(answer) => report_machine(to, &answer),
            // Marlin's words, which are no line of M503 (M113.cpp).
            Answer::Setting(Setting::Plain(113)) => to.say(text!("echo:M113 S{}", s.keepalive_s)),
            Answer::Setting(setting) => report_setting(to, setting, s),
            Answer::Words(words) => to.setting(text!("{words}")),
            Answer::Settings { retraction, for_replay } => {
                if !for_replay {
                    to.echo_settings();
                }
                report_settings(to, s, &retraction, !power.uarts().is_empty());
            }
            Answer::NoDriver(code, number) => {
                let driver = Part::Driver.name();
                to.say(text!("echo:{code} ignored: there is no {driver} {number}"));
            }
            Answer::SharedMotors(axes) => {
                to.say(text!("echo:M92 ignored: {axes} share motors and need the same value"));
            }
            Answer::Driver(motor, reading) => report_driver(to, (motor, reading), power.drivers(), s),
            Answer::Belt(answer) => report_belt(to, &answer, trimming, s),
            Answer::Buzz(answer) => report_buzz(to, &answer, s),
            Answer::Probe(answer) => report_probe(to, &answer),
            Answer::Mesh(answer) => report_mesh(to, &answer, bed.mesh(), s),
            Answer::Resonance(answer) => report_resonance(to, &answer),
            Answer::Screws(answer) => report_screws(to, &answer),
            Answer::Storage(news) => report_storage(to, &news),
        }
    }

    /// Writes `ok`, with the queue state for a host that fills a window, if it is wanted.
    fn reply_ok(&mut self) {
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
            let (temperatures, position) = (self.temperatures(), self.position(position == Some(true)));
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
            let position = self.position(true);
            self.hosts.report(Report::Position, now, format_args!("{position}"));
        }
    }
}

/// Says which part of a machine a line was for that is not there. OctoPrint learns from its own words for tools which
/// ones there are (comm.py, "Invalid extruder").
fn report_absent(to: &mut ReplyWriter<'_>, absent: &Absent<'_>) {
    let which = Echo(absent.which);
    let part = absent.part.name();
    match (absent.command, absent.part) {
        (Named::Code(b'T', number), _) => to.say(text!("echo:T{number} Invalid extruder")),
        (Named::Code(b'M', 104 | 109), Part::Tool) => to.say(text!("echo:T{which} Invalid extruder")),
        (Named::Code(letter, number), _) => {
            let letter = letter as char;
            to.say(text!("echo:{letter}{number} ignored: there is no {part} {which}"));
        }
        (Named::Name(name), _) => to.say(text!("echo:{name} ignored: there is no {part} {which}")),
    }
}

/// Says why a line was not carried out.
fn report_malformed(to: &mut ReplyWriter<'_>, flaw: Flaw<'_>) {
    match flaw {
        Flaw::NoWord(text) => {
            to.say(text!("echo:line ignored: \"{}\" is not a letter with a number", Echo(text)));
        }
        Flaw::NoPair(text) => {
            to.say(text!("echo:line ignored: \"{}\" is not a name with = and a number", Echo(text)));
        }
        Flaw::NoNumber(letter) => to.say(text!("echo:line ignored: {} needs a number", letter as char)),
        Flaw::OutOfRange(text) => to.say(text!("echo:line ignored: {} is out of range", Echo(text))),
        Flaw::NoAxis(letter) => to.say(text!("echo:line ignored: there is no axis {}", letter as char)),
        Flaw::SecondCommand(text) => {
            to.say(text!("echo:line ignored: {} is a second command on it", Echo(text)));
        }
        Flaw::Absent(absent) => report_absent(to, &absent),
    }
}
