//! Circulation: the belt runs round, with the tool standing or moving in x and y. `commands::circulate` is the line that asks for it.

use crate::kinematics::Grouping;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::state::modal::FARTHEST;
use crate::port::Pend;
use crate::units::{Mm, MmPerSec, Steps};

/// Has a belt that can run round do so a little, after homing, so that it does not always bend at the same teeth.
pub(in crate::machine) async fn advance_belt<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<(), Interrupt> {
    let belt = crank.settings().belt;
    if !belt.is_closed || belt.homing_advance == Mm::ZERO {
        return Ok(());
    }
    let position = crank.commanded().position();
    let [x, y, ..] = position;
    let farther = crank.circulation().commanded + belt.homing_advance;
    // Round and round: no farther than numbers go.
    let target = if FARTHEST.holds(farther) { farther } else { crank.circulation().commanded - belt.homing_advance };
    run_round(crank, [x, y], target, belt.max_speed).await?;
    crank.commanded_mut().go_to(position);
    Ok(())
}

/// The tool goes to x and y while the belt runs on up to `belt`.
pub(in crate::machine) async fn run_round<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    to: [Mm; 2],
    belt: Mm,
    speed: MmPerSec,
) -> Result<(), Interrupt> {
    crank.finish().await?;
    crank.power(crank.groups().mechanism().belt_motors()).await?;
    // Where the motors stand, which may be beside the end of the last move (`motion::stepgen::alignment`).
    let ([x, y, ..], [.., z, e]) = (crank.real_steps(), crank.planned_end());
    let [.., z_mm, _] = crank.planned_end_mm();
    crank.circulation_mut().begin((z, z_mm));
    crank.regroup(Grouping::Circulation, [x, y, Steps::ZERO, e]).await?;
    let [.., filament] = crank.planned_end_mm();
    let [to_x, to_y] = to;
    let [to_x, to_y, to, e] = crank.to_steps([to_x, to_y, belt, filament]);
    let way = to.wrapping_round().wrapping_sub(Steps::wrapping_from_num(crank.circulation().steps()));
    crank.plan_whole([to_x, to_y, way, e], speed, true);
    crank.finish().await?;
    end_circulation(crank).await?;
    crank.circulation_mut().commanded = belt;
    Ok(())
}

/// The belt has run as far as it should, or was stopped: z has its place again. Motion rests.
pub(in crate::machine) async fn end_circulation<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<(), Interrupt> {
    if crank.grouping() != Grouping::Circulation {
        return Ok(());
    }
    // No way at all, unless it was stopped between two places where the counts agree.
    crank.plan_whole(crank.planned_end(), crank.settings().belt.max_speed, false);
    crank.finish().await?;
    let [x, y, c, e] = crank.planned_end();
    crank.circulation_mut().add(c.wrapping_round().to_num());
    crank.circulation_mut().commanded = crank.circulation().length(crank.settings().axes.x.steps_per_mm);
    let (z, _) = crank.circulation().z();
    crank.regroup(Grouping::Tool, [x, y, z, e]).await?;
    crank.stand_at_end();
    Ok(())
}
