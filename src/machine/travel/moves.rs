//! Commands that move: straight moves (G0, G1), arcs (G2, G3), retraction (G10, G11).
//!
//! Each ends in `plan` of the main loop, which waits until there is room for the move.

use super::arcs::arc::{Arc, Shape, Way, join, split};
use crate::connectors::Heater;
use crate::gcode::{ArcWords, AxisWords, MoveCommand, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::belt::align::lacks_alignment;
use crate::machine::heat::heating::{await_readings, heat_again};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::ports::PortSet;
use crate::machine::print::detour::is_own;
use crate::machine::print::pause::{Going, hold, resume_stream};
use crate::machine::state::commanded::{Commanded, LEAST_FILAMENT, Wanted};
use crate::machine::state::held_line::HoldReason;
use crate::machine::state::job::any_of;
use crate::machine::state::modal::{FARTHEST, Modal, are_apart};
use crate::machine::state::notices::Notice;
use crate::machine::state::program::Program;
use crate::machine::state::soft_endstops::clamp;
use crate::machine::states::States;
use crate::motion::Target;
use crate::port::{EndstopSet, Wake};
use crate::settings::{Alignment, HomedAxis};
use crate::text::Text;
use crate::units::{Feed, Mm, part_of};
use core::pin::pin;

/// Keeps the tool within the reach of any machine; a point of an arc may lie beyond.
fn bounded(position: [Mm; 4]) -> [Mm; 4] {
    let [x, y, z, e] = position;
    let [x, y, z] = [x, y, z].map(|at| FARTHEST.clamp(at));
    [x, y, z, e]
}

/// A target of z so far below the top that real z is within the machine on the bed's surface, too.
fn below_top<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, z: Mm, [_, _, from, _]: [Mm; 4]) -> Mm {
    let (s, motion) = (&*main_loop.settings, &main_loop.motion);
    let ([.., is_homed], is_on_surface) = (main_loop.homed.axes(), motion.is_on_surface());
    let Some(mesh) = motion.mesh().filter(|_| is_on_surface && is_homed && s.soft_endstops) else { return z };
    z.min(from.max(s.reach(HomedAxis::Z).most.saturating_sub(mesh.above_top())))
}

/// The axes that move between two positions.
pub(in crate::machine) fn moving([x, y, z, _]: [Mm; 4], [to_x, to_y, to_z, _]: [Mm; 4]) -> [bool; 3] {
    [are_apart(x, to_x), are_apart(y, to_y), are_apart(z, to_z)]
}

/// Borrowed context of a motion command: main loop, and states of commands.
pub(in crate::machine) struct Moves<'c, 'm, P: PortSet, W: Wake> {
    pub main_loop: &'c mut MainLoop<'m, P, W>,
    pub states: &'c mut States,
}

/// The answer to a printing move of a belt whose motors may strain it.
const NOT_ALIGNED: Answer<'static> = Answer::Line(packed!("echo:move ignored: align the belt motors first (M915)"));

/// Whether a line may be carried out.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::machine) enum Gate {
    Open,
    /// It may move, and the meaning of its words has changed.
    Changed,
    /// It is held.
    Held,
}

/// Whether a line is straight.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Course {
    Straight,
    Arc,
}

/// The conditions that a line in a print must meet before it is carried out.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Asked {
    /// The axes that it moves.
    pub moves: [bool; 3],
    /// Filament forth, or back if it is negative.
    pub filament: Mm,
}

impl Asked {
    /// Whether it prints.
    fn prints(&self) -> bool {
        let [x, y, _] = self.moves;
        self.filament >= LEAST_FILAMENT && (x || y)
    }
}

/// Whether z goes down on a way.
fn goes_down([.., from, _]: [Mm; 4], [.., to, _]: [Mm; 4]) -> bool {
    to < from
}

impl<P: PortSet, W: Wake> Moves<'_, '_, P, W> {
    /// G0 to G3.
    pub async fn make(&mut self, command: &MoveCommand) -> Result<Answer<'static>, Interrupt> {
        match *command {
            MoveCommand::Line { rapid: _, ref to, feed } => self.line(to, feed).await,
            MoveCommand::Circulate { ref to, belt, feed } => apart(pin!(self.circulate(to, belt, feed))).await,
            MoveCommand::Arc(ref words) => apart(pin!(self.arc(words))).await,
        }
    }

    /// G0, G1. A line that is refused changes nothing, F included.
    pub async fn line(&mut self, to: &AxisWords, feed: Option<Number>) -> Result<Answer<'static>, Interrupt> {
        let mut wanted = self.wanted(to);
        let mut asked = self.asked(&wanted, Course::Straight);
        match self.hold_back(asked, Some((to, Course::Straight))).await? {
            Gate::Open => {}
            Gate::Changed => {
                wanted = self.wanted(to);
                asked = self.asked(&wanted, Course::Straight);
            }
            Gate::Held => return Ok(Answer::Held),
        }
        let feed = self.states.clamps.feed(&self.states.modal, feed).unwrap_or(self.states.modal.feed);
        self.tell_of(&wanted);
        if !self.may_move(asked.moves) {
            return Ok(Answer::NotHomed);
        }
        let [x, y, _] = asked.moves;
        if (x || y) && !self.may_print(wanted.position) {
            return Ok(NOT_ALIGNED);
        }
        let may_be_script = is_own(self.main_loop);
        self.main_loop.commanded.leave_park(wanted.position, to, &self.states.modal, may_be_script);
        self.go(wanted.position, feed).await?;
        self.states.modal.feed = feed;
        self.main_loop.commanded.count_extrusion(wanted.extrusion);
        self.note_printed(asked);
        Ok(Answer::Nothing)
    }

    /// Where the words of a line lead.
    fn wanted(&self, to: &AxisWords) -> Wanted {
        let main_loop = &*self.main_loop;
        main_loop.commanded.target(to, &self.states.modal, &main_loop.settings, self.states.is_too_cold(main_loop))
    }

    /// The conditions of a line to there.
    fn asked(&self, wanted: &Wanted, course: Course) -> Asked {
        self.asked_of(&self.main_loop.commanded, &self.states.modal, wanted, course)
    }

    /// The same of a program that stands there.
    fn asked_of(&self, commanded: &Commanded, modal: &Modal, wanted: &Wanted, course: Course) -> Asked {
        let [x, y, z] = moving(commanded.position(), wanted.position);
        let [in_x, in_y, in_z, _] = match course {
            Course::Straight => [false; 4],
            Course::Arc => join(modal.plane, [true, true], [false, false]),
        };
        let filament = wanted.extrusion.saturating_sub(commanded.extrusion());
        let filament = if self.states.modal.dry_run { Mm::ZERO } else { filament };
        Asked { moves: [x || in_x, y || in_y, z || in_z], filament }
    }

    /// Whether these words, if a print is paused and they may be a line of its stream, print there, or move a machine
    /// that has lost its place.
    fn goes_on_in_stream(&self, (to, course): (&AxisWords, Course)) -> bool {
        let main_loop = &*self.main_loop;
        let Some(Program { commanded, modal, .. }) = main_loop.stream.program() else { return false };
        if main_loop.job.line().reason().is_some() || !is_own(main_loop) {
            return false;
        }
        let wanted = commanded.target(to, modal, &main_loop.settings, false);
        let asked = self.asked_of(commanded, modal, &wanted, course);
        let is_lost = main_loop.homed.lacks_one_of(main_loop.job.to_home([false; 3], false));
        asked.prints() && main_loop.stream.may_print()
            || is_lost && asked.moves != [false; 3] && !main_loop.stream.is_away()
    }

    /// In a print, a line waits for a heater that has switched off by itself. A line that cannot be carried out,
    /// because the hotend is too cold for it or an axis has lost its place, is kept. The answer says so. A line that
    /// prints begins a print. It ends a pause if it prints in the modes of the print's stream.
    pub(in crate::machine) async fn hold_back(
        &mut self,
        mut asked: Asked,
        words: Option<(&AxisWords, Course)>,
    ) -> Result<Gate, Interrupt> {
        let mut gate = Gate::Open;
        let why = 'why: {
            if asked.filament != Mm::ZERO
                && self.main_loop.heat.is_unread(Heater::Hotend, &self.main_loop.settings.thermal)
            {
                await_readings(self.main_loop, Heater::ALL.map(|heater| heater == Heater::Hotend)).await?;
                gate = Gate::Changed;
            }
            if self.main_loop.job.is_paused() {
                let Some((to, course)) = words.filter(|words| self.goes_on_in_stream(*words)) else { break 'why None };
                gate = Gate::Changed;
                if let Going::Not(why) = resume_stream(self.main_loop, self.states).await? {
                    break 'why Some(why);
                }
                asked = self.asked(&self.wanted(to), course);
            }
            if asked.prints() {
                let host = self.main_loop.hosts.serving();
                self.main_loop.job.begin(host);
            }
            if !self.main_loop.job.is_printing() {
                break 'why None;
            }
            let (homed, job) = (&self.main_loop.homed, &self.main_loop.job);
            // What is printed is at a height, whatever the line moves.
            let needed = any_of(asked.moves, [false, false, asked.prints()]);
            let to_home = job.to_home(asked.moves, self.main_loop.settings.require_homing);
            if homed.has_lost_one_of(needed) || homed.lacks_one_of(to_home) {
                break 'why Some(HoldReason::Lost(any_of(needed, to_home)));
            }
            if asked.filament.saturating_abs() < LEAST_FILAMENT {
                break 'why None;
            }
            if self.main_loop.job.targets().is_some() {
                gate = Gate::Changed;
                apart(pin!(heat_again(self.main_loop))).await?;
            }
            (asked.filament > Mm::ZERO && self.states.is_too_cold(self.main_loop)).then_some(HoldReason::Cold)
        };
        let Some(why) = why else { return Ok(gate) };
        // The line is held for that reason, and is carried out as if it came then.
        self.states.clamps.clear();
        hold(self.main_loop, &self.states.modal, why).await?;
        Ok(Gate::Held)
    }

    /// A move that prints was planned. In a pause it is a button's: the line that ends a pause ends it before.
    fn note_printed(&mut self, asked: Asked) {
        if asked.prints() && !self.main_loop.job.is_paused() {
            let position = self.main_loop.commanded.position();
            self.main_loop.job.note_printed(position);
            self.main_loop.stream.note_number(self.main_loop.hosts.window().0.is_some());
        }
    }

    /// Whether these axes may move: they are homed, or need not be. In the second case the host is told once. An axis
    /// with a homing that failed does not move.
    pub(in crate::machine) fn may_move(&mut self, moves: [bool; 3]) -> bool {
        if !self.main_loop.homed.lacks_one_of(moves) {
            return true;
        }
        if self.main_loop.settings.require_homing || self.main_loop.homed.has_failed_one_of(moves) {
            self.states.clamps.clear();
            return false;
        }
        let line = text!("echo:motion before homing (G28): the ends of the axes are unknown");
        self.tell_once(Notice::MotionBeforeHoming, line);
        true
    }

    /// Says a line if the host has not got that notice yet.
    fn tell_once(&mut self, notice: Notice, line: Text<'_>) {
        if self.states.notices.give(notice) {
            self.main_loop.say(line);
        }
    }

    /// Whether x and y may move to `position`. They may if the move does not print, if the motors of the belt are
    /// aligned, or if they need not be. In the last case the host is told once.
    fn may_print(&mut self, position: [Mm; 4]) -> bool {
        let ([.., to], [.., from]) = (position, self.main_loop.commanded.position());
        let rule = self.main_loop.settings.belt.alignment;
        if rule == Alignment::Off || to.wrapping_sub(from) < LEAST_FILAMENT || !lacks_alignment(self.main_loop) {
            return true;
        }
        if rule == Alignment::Required {
            self.states.clamps.clear();
            return false;
        }
        let line = text!("echo:printing with belt motors that are not aligned (M915)");
        self.tell_once(Notice::NotAligned, line);
        true
    }

    /// Plans a move within the reachable space and takes it as the commanded position.
    pub(super) async fn go(&mut self, position: [Mm; 4], speed: Feed) -> Result<(), Interrupt> {
        let (inside, moved) = {
            let main_loop = &*self.main_loop;
            // The limits apply to the machine position, including the offset of a parked pause.
            let [px, py, pz, _] = main_loop.commanded.parked();
            let parked = |[x, y, z, e]: [Mm; 4]| [x.saturating_add(px), y.saturating_add(py), z.saturating_add(pz), e];
            let (to, from) = (parked(bounded(position)), parked(main_loop.commanded.position()));
            let ([x, y, z, e], moved) = clamp(to, from, main_loop.homed, &main_loop.settings, z_reach(main_loop));
            let z = below_top(main_loop, z, from);
            ([x.saturating_sub(px), y.saturating_sub(py), z.saturating_sub(pz), e], moved)
        };
        if moved {
            self.tell_of_edge();
        }
        if self.main_loop.motion.is_raising() && goes_down(self.main_loop.commanded.position(), inside) {
            // Fast moves pass before a shift of z, so this one would go too low.
            self.main_loop.finish().await?;
        }
        let position = self.main_loop.commanded.of_machine(inside);
        self.main_loop.plan(Target { position, speed, has_overrides: true, watch: EndstopSet::NONE }).await?;
        self.main_loop.commanded.go_to(inside);
        Ok(())
    }

    /// Reports once that a target was beyond the edge.
    pub(in crate::machine) fn tell_of_edge(&mut self) {
        let line = text!("echo:target out of reach, moved to the edge of the reachable space");
        self.tell_once(Notice::Edge, line);
    }

    /// The target of a line's words; the host is told of values beyond the limits.
    pub(in crate::machine) fn target(&mut self, to: &AxisWords) -> Wanted {
        let wanted = self.wanted(to);
        self.tell_of(&wanted);
        wanted
    }

    /// Reports words beyond the limits.
    fn tell_of(&mut self, wanted: &Wanted) {
        if wanted.is_held_back {
            self.tell_of_cold();
        }
        if wanted.too_much {
            let most = self.main_loop.settings.axes.e.length.to_num::<i32>();
            self.main_loop.say(text!("echo:E left out: more than {most} mm of filament in one move"));
        }
        if wanted.is_too_far {
            self.tell_of_edge();
        }
    }

    /// Reports once per print that filament was left out, because the hotend is too cold for it.
    pub(in crate::machine) fn tell_of_cold(&mut self) {
        self.tell_once(Notice::Cold, text!("echo: cold extrusion prevented"));
    }

    /// G2, G3. The axis across the plane and E run evenly along the arc.
    pub async fn arc(&mut self, words: &ArcWords) -> Result<Answer<'static>, Interrupt> {
        let mut wanted = self.wanted(&words.to);
        let mut asked = self.asked(&wanted, Course::Arc);
        match self.hold_back(asked, Some((&words.to, Course::Arc))).await? {
            Gate::Open => {}
            Gate::Changed => {
                wanted = self.wanted(&words.to);
                asked = self.asked(&wanted, Course::Arc);
            }
            Gate::Held => return Ok(Answer::Held),
        }
        let speed = self.states.clamps.feed(&self.states.modal, words.feed).unwrap_or(self.states.modal.feed);
        self.tell_of(&wanted);
        let plane = self.states.modal.plane;
        let (start, [sz, se]) = split(plane, self.main_loop.commanded.position());
        let (end, [ez, ee]) = split(plane, wanted.position);
        let arc = Shape::new(words.shape, plane, |n| self.states.modal.length(n)).and_then(|shape| {
            let way = Way { clockwise: words.clockwise, turns: words.turns };
            Arc::new(
                start,
                end,
                shape,
                way,
                self.main_loop.settings.arc_tolerance,
                self.states.modal.rounding(words.decimals),
            )
        });
        let arc = match arc {
            Ok(arc) => arc,
            Err(error) => {
                self.states.clamps.clear();
                return Ok(Answer::Line(error.text()));
            }
        };
        let [x, y, z, _] = join(plane, [true, true], [are_apart(sz, ez), false]);
        if !self.may_move([x, y, z]) {
            return Ok(Answer::NotHomed);
        }
        if !self.may_print(wanted.position) {
            return Ok(NOT_ALIGNED);
        }
        let may_be_script = is_own(self.main_loop);
        self.main_loop.commanded.leave_park(wanted.position, &words.to, &self.states.modal, may_be_script);
        self.states.modal.feed = speed;
        let begin = self.main_loop.commanded.extrusion();
        let between = |from: Mm, to: Mm, part: u32| {
            let length = to.to_bits().wrapping_sub(from.to_bits());
            Mm::from_bits(from.to_bits().wrapping_add(part_of(length, u64::from(part), u64::from(arc.chords()))))
        };
        for part in 1..=arc.chords() {
            let along = [between(sz, ez, part), between(se, ee, part)];
            self.go(join(plane, arc.point(part), along), speed).await?;
            self.main_loop.commanded.count_extrusion(between(begin, wanted.extrusion, part));
        }
        self.note_printed(asked);
        Ok(Answer::Nothing)
    }
}
