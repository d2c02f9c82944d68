//! Where the program is, or where the tool is.

use crate::kinematics::Grouping;
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::position::Position;
use crate::port::Wake;

/// Where the program is, or with `real` where the tool is.
pub(super) fn named_place<'m, P: PortSet, W: Wake>(main_loop: &MainLoop<'m, P, W>, real: bool) -> Position<'m> {
    let MainLoop { motion, circulation, trimming, commanded, settings, .. } = main_loop;
    let counts = motion.counts();
    let at_motors = motion.to_mm(motion.real_steps());
    let (_, z) = circulation.z();
    let at = if real { motion.seen(at_motors, z, trimming.held()) } else { commanded.position() };
    let ran = match (real, motion.grouping()) {
        (false, _) => circulation.commanded(),
        (true, Grouping::Tool | Grouping::Trim | Grouping::Screw) => circulation.length(settings.axes.x.steps_per_mm),
        (true, Grouping::Circulation) => {
            let [_, _, on_the_way, _] = at_motors;
            circulation.length(settings.axes.x.steps_per_mm) + on_the_way
        }
    };
    Position::new(at, settings.belt.is_closed.then_some(ran), counts, commanded, motion.real())
}

/// Says it, as the answer.
pub(in crate::machine) fn tell_place<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    real: bool,
) -> Answer<'static> {
    let place = named_place(main_loop, real);
    main_loop.say(text!("{place}"));
    Answer::Said
}
