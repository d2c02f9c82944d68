//! Circulation: the belt circulates with the tool at rest or moving in x and y. `travel::circulate` has the command.

use crate::kinematics::Grouping;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::regroup::regroup;
use crate::machine::ports::PortSet;
use crate::machine::state::modal::FARTHEST;
use crate::port::Wake;
use crate::units::{Feed, Mm, Steps};
use core::pin::pin;

/// Lets a belt that can circulate do so a little after homing, so that it does not always bend at the same teeth.
pub(in crate::machine) async fn advance_belt<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let belt = main_loop.settings.belt;
    if !belt.is_closed || belt.homing_advance == Mm::ZERO {
        return Ok(());
    }
    let position = main_loop.commanded.position();
    let [x, y, ..] = position;
    let farther = main_loop.circulation.commanded() + belt.homing_advance;
    // Wrapped within the range of numbers.
    let target =
        if FARTHEST.holds(farther) { farther } else { main_loop.circulation.commanded() - belt.homing_advance };
    apart(pin!(run_round(main_loop, [x, y], target, belt.max_speed.into()))).await?;
    main_loop.commanded.go_to(position);
    Ok(())
}

/// Moves the tool to x and y while the belt circulates up to `belt`.
pub(in crate::machine) async fn run_round<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    to: [Mm; 2],
    belt: Mm,
    speed: Feed,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    main_loop.power_up(main_loop.motion.groups().mechanism().belt_motors()).await?;
    // The motors' position, which may differ from the end of the last move (`motion::stepgen::alignment`).
    let ([x, y, ..], [.., z, e]) = (main_loop.motion.real_steps(), main_loop.motion.end());
    let [.., z_mm, _] = main_loop.motion.end_mm();
    main_loop.circulation.begin((z, z_mm));
    regroup(main_loop, Grouping::Circulation, [x, y, Steps::ZERO, e]).await?;
    let [.., filament] = main_loop.motion.end_mm();
    let [to_x, to_y] = to;
    let [to_x, to_y, to, e] = main_loop.motion.to_steps([to_x, to_y, belt, filament]);
    let way = to.wrapping_round().wrapping_sub(Steps::wrapping_from_num(main_loop.circulation.steps()));
    main_loop.motion.plan_whole([to_x, to_y, way, e], speed, true, &main_loop.settings);
    main_loop.finish().await?;
    end_circulation(main_loop).await?;
    main_loop.circulation.go_to(belt);
    Ok(())
}

/// The belt has reached its circulation or was stopped: z has its place again. Motion is at rest.
pub(in crate::machine) async fn end_circulation<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    if main_loop.motion.grouping() != Grouping::Circulation {
        return Ok(());
    }
    // No distance, unless it was stopped between two places where the counts agree.
    main_loop.motion.plan_whole(
        main_loop.motion.end(),
        main_loop.settings.belt.max_speed.into(),
        false,
        &main_loop.settings,
    );
    main_loop.finish().await?;
    let [x, y, c, e] = main_loop.motion.end();
    main_loop.circulation.add(c.wrapping_round().to_num());
    let lies = main_loop.circulation.length(main_loop.settings.axes.x.steps_per_mm);
    main_loop.circulation.go_to(lies);
    let (z, _) = main_loop.circulation.z();
    regroup(main_loop, Grouping::Tool, [x, y, z, e]).await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(())
}
