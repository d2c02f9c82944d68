//! The bed and the probe as commands ask for them.

use anyhow::Result;
use clap::Args;
use corehbot::settings::Settings;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::options;

/// The bed under the nozzle, on a machine with a probe.
#[derive(Args)]
pub struct BedArgs {
    /// A bed and a probe that differ from the machine's settings, such as `tilt.x=0.0004,bowl=0.25,noise=0.005`. An
    /// unknown key gets a list of the known ones (docs/reference/commands.md).
    #[arg(long, value_name = "KEY=VALUE,..", allow_hyphen_values = true)]
    bed: Option<String>,
}

impl BedArgs {
    /// The bed, if the option asks for one, on a machine with these settings.
    ///
    /// # Errors
    /// No such bed, or no probe that could find it.
    pub fn plant(&self, settings: &Settings) -> Result<Option<Box<BedPlant>>> {
        Ok(self.bed.as_deref().map(|text| options::bed(text, settings)).transpose()?)
    }
}
