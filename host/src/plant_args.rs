//! The belt plant as commands ask for it.

use anyhow::Result;
use clap::{Args, ValueEnum};
use corehbot::units::Mm;
use corehbot_machine_file::Machine;
use corehbot_sim::asked::Belts;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_twin::description::Description;

/// The plant in place of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Plant {
    /// Belts that stretch, rotors that skip.
    Belt,
}

/// The plant, and its accidents.
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
    /// A belt motor, by its name in the machine file (m1, m4, m8, m11), rubs with N newtons at the belt, from second S
    /// of motion time on, for good or for MS milliseconds. May be repeated.
    #[arg(long, value_name = "MOTOR,N[,S[,MS]]", requires = "plant", allow_hyphen_values = true)]
    brake: Vec<String>,
    /// A part breaks at second TIME of motion time: `seized`, `loose`, `jump` or `cord`, at a belt motor by its name in
    /// the machine file or a pulley by its number in `twin geometry`. Such as `seized:7@20s`, `loose:m1:15N@20s+5s`,
    /// `jump:m8:-1@1m` or `cord:m1:50%@20s`; docs/explanation/belt/plant.md has them all. May be repeated.
    #[arg(long, value_name = "WHAT:WHERE[:HOW]@TIME[+TIME]", requires = "plant")]
    accident: Vec<String>,
}

impl PlantArgs {
    fn belts(&self) -> Option<Belts<'_>> {
        let Self { plant, seed, hit, brake, accident } = self;
        let Plant::Belt = (*plant)?;
        Some(Belts { seed: *seed, hits: hit, brakes: brake, accidents: accident })
    }

    /// The plant of this description, if the options ask for one.
    ///
    /// # Errors
    /// No such accident.
    pub fn setup(&self, twin: &Description) -> Result<Option<BeltSetup>> {
        Ok(self.belts().map(|belts| belts.setup(twin)).transpose()?)
    }

    /// The plant of this machine, if one is asked for.
    ///
    /// # Errors
    /// No such accident, or no belts do what the machine's motors do.
    pub fn belt(&self, machine: &Machine, homed: Option<[Mm; 3]>) -> Result<Option<Box<BeltPlant>>> {
        Ok(self.belts().map(|belts| belts.plant(machine, homed)).transpose()?)
    }
}
