//! The belt plant as commands ask for it.

use anyhow::Result;
use clap::{Args, ValueEnum};
use corehbot::units::Mm;
use corehbot_machine_file::Machine;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::options::{Belts, Breaks};
use corehbot_twin::description::Description;

/// The plant in place of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Plant {
    /// Belts that stretch, rotors that skip.
    Belt,
}

/// The plant, and what is in its way.
#[derive(Args)]
pub struct PlantArgs {
    /// The plant that the motors turn; without it, a rigid machine.
    #[arg(long, value_enum)]
    plant: Option<Plant>,
    /// Draws the phase of each motor at power-up, and the noise of its driver; without it, phases are 0.
    #[arg(long, value_name = "N", requires = "plant")]
    seed: Option<u64>,
    /// The tool runs into something within 1 mm of X,Y: N newtons act against its motion for MS milliseconds. May be
    /// repeated.
    #[arg(long, value_name = "X,Y,N,MS", requires = "plant", allow_hyphen_values = true)]
    hit: Vec<String>,
}

impl PlantArgs {
    fn belts(&self) -> Option<Belts<'_>> {
        let Self { plant, seed, hit } = self;
        let Plant::Belt = (*plant)?;
        Some(Belts { seed: *seed, hits: hit })
    }

    /// Whether there are belts that stretch.
    #[must_use]
    pub const fn has_belts(&self) -> bool {
        matches!(self.plant, Some(Plant::Belt))
    }

    /// The plant of this description, if the options ask for one.
    ///
    /// # Errors
    /// No such hit.
    pub fn setup(&self, twin: &Description, breaks: &Breaks) -> Result<Option<BeltSetup>> {
        Ok(self.belts().map(|belts| belts.setup(twin, breaks)).transpose()?)
    }

    /// The plant of this machine, if one is asked for.
    ///
    /// # Errors
    /// No such hit, no such part, or no belts do what the machine's motors do.
    pub fn belt(&self, machine: &Machine, homed: Option<[Mm; 3]>, breaks: &Breaks) -> Result<Option<Box<BeltPlant>>> {
        Ok(self.belts().map(|belts| belts.plant(machine, homed, breaks)).transpose()?)
    }
}
