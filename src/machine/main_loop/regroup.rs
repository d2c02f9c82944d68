//! Regrouping: a circulating belt, or one motor of it, takes the place of z in the planner, the generator and the step
//! pins.
//!
//! Motors are regrouped at rest. `belt` gives the reason.

use super::MainLoop;
use crate::fault::{Cause, Fault};
use crate::kinematics::Grouping;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::motors::Coupling;
use crate::port::Wake;
use crate::units::Steps;

/// Regroups the motors at rest; the machine stands at `position` then.
pub(in crate::machine) async fn regroup<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    grouping: Grouping,
    position: [Steps; 4],
) -> Result<(), Interrupt> {
    let coupling = main_loop.motion.groups_in(grouping).coupling();
    couple(main_loop, grouping, &coupling, position).await
}

/// The same with a given coupling.
pub(super) async fn couple<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    grouping: Grouping,
    coupling: &Coupling,
    position: [Steps; 4],
) -> Result<(), Interrupt> {
    main_loop.motion.regroup(grouping, &main_loop.settings);
    if !main_loop.motion.are_groups_whole(&main_loop.settings) {
        // Unused groups are not scrubbed.
        main_loop.status.fault().set(Fault::plain(Cause::SettingsDamaged));
    }
    main_loop.power.couple(coupling);
    main_loop.adopt_exactly(position).await
}
