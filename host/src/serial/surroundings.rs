//! Surroundings: what is around a printer at a pseudo-terminal. The clock, the mistakes of its builder, and a hand.

use super::hand::Hand;
use super::pace::{self, Speed};
use anyhow::{Context as _, Result};
use clap::Args;
use corehbot::settings::Settings;
use corehbot_sim::wiring_mistakes::Plugs;

/// What is around a printer.
#[derive(Args)]
pub struct Surroundings {
    /// Speed in multiples of real time, or `max`: as fast as it can be computed, but in real time (after 0.25 s) while
    /// it waits for the host.
    #[arg(long, value_name = "X", default_value = "1", value_parser = pace::parse)]
    pub speed: Speed,
    /// A mistake in the wiring, such as `swap-motors:m1,m8`, `reverse-motor:m4` or `stuck-endstop:x`. May be repeated.
    /// An unknown word gets a list of the known ones.
    #[arg(long, value_name = "WHAT:NAMES", conflicts_with = "plant")]
    fault: Vec<String>,
    /// Takes what a hand does to the machine from standard input: `press x`, `let go`, `warm hotend`, `reset`, `off`;
    /// with `in 2 s` at its end, later.
    #[arg(long)]
    hand: bool,
}

impl Surroundings {
    /// The hand, if there is one.
    #[must_use]
    pub fn hand(&self) -> Option<Hand> {
        self.hand.then(Hand::at_input)
    }

    /// The mistakes of the wiring; `None` if there are none.
    ///
    /// # Errors
    /// There is no such mistake.
    pub fn plugs(&self, settings: &Settings) -> Result<Option<Plugs>> {
        let mut plugs = Plugs::default();
        for fault in &self.fault {
            plugs.make(fault, settings).with_context(|| format!("--fault {fault}"))?;
        }
        Ok((!self.fault.is_empty()).then_some(plugs))
    }
}
