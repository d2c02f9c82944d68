//! Accidents as commands ask for them.

use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::error::Error;
use clap::{Arg, Command};
use corehbot::settings::Settings;
use corehbot_sim::accident::{GRAMMAR, words};
use corehbot_sim::options::Breaks;
use std::ffi::OsStr;

/// What breaks, and when.
#[derive(Args, Default)]
pub struct AccidentArgs {
    #[arg(long = "break", value_name = GRAMMAR, value_parser = Words, help = words::help())]
    breaks: Vec<String>,
    /// Another name of --break.
    #[arg(long = "accident", value_name = GRAMMAR, hide = true)]
    accidents: Vec<String>,
    /// Another name of --break, from the time of `MOTOR,N[,S[,MS]]`.
    #[arg(long = "brake", value_name = GRAMMAR, hide = true, allow_hyphen_values = true)]
    brakes: Vec<String>,
}

impl AccidentArgs {
    /// Options and texts. Those of earlier options go first, as they did.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let Self { breaks, accidents, brakes } = self;
        let lists = [("brake", brakes), ("accident", accidents), ("break", breaks)];
        lists.into_iter().flat_map(|(option, texts)| texts.iter().map(move |text| (option, text.as_str())))
    }

    /// What they say, on a machine with these settings, which may have belts that stretch.
    ///
    /// # Errors
    /// No such accident, or none that this machine can have.
    pub fn read(&self, settings: &Settings, has_belts: bool) -> Result<Breaks> {
        Ok(Breaks::read(self.given(), settings, has_belts)?)
    }
}

/// Any text, which is read later, when the machine is known. Help and completion list the words of the table.
#[derive(Clone)]
struct Words;

impl TypedValueParser for Words {
    type Value = String;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<String, Error> {
        StringValueParser::new().parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(words::words().into_iter().map(|(word, says)| PossibleValue::new(word).help(says))))
    }
}
