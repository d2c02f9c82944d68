//! Resonances.

use super::states::States;
use crate::gcode::ResonanceCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::resonance::test::{examine_sensor, test_resonances};
use crate::port::Wake;
use core::pin::pin;

/// Carries out a command about resonances.
pub(super) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &ResonanceCommand,
) -> Result<Answer<'static>, Interrupt> {
    let samples = match command {
        ResonanceCommand::Sensor => None,
        ResonanceCommand::Samples { count } => Some(count.map_or(1000, |count| count.to_u32())),
        ResonanceCommand::Sweep(words) => {
            return apart(pin!(test_resonances(main_loop, &mut states.clamps, words))).await;
        }
    };
    examine_sensor(main_loop, samples).await
}
