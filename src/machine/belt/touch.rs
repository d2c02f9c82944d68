//! Touch: the switches of x and y are met once more, to see whether the tool is where the steps say (M915 D), and what is to be done if
//! it is not (M915 R).

use super::align::{BeltError, trimmed};
use super::diagnosis::{Touched, diagnose, is_aside};
use crate::gcode::AxisFlags;
use crate::kinematics::Residuals;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::{BeltAnswer, Diagnosis};
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::HomedAxis;
use crate::units::Mm;

/// How far z is lifted while the tool goes to the switches, so that the nozzle does not touch the print.
const LIFT: Mm = Mm::const_from_int(5);

/// The axes of the belt.
const BELT_AXES: AxisFlags = AxisFlags { x: true, y: true, z: false, e: false };

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M915: x and y are homed, their motors aligned, and x and y homed again.
    pub(in crate::machine) async fn align_belt(&mut self) -> Result<Answer<'static>, Interrupt> {
        if self.residuals().is_empty() {
            return Ok(Answer::Belt(BeltAnswer::NoResidual));
        }
        let lift = self.lift().await?;
        self.home_and_align(BELT_AXES, true).await?;
        self.lower(lift).await?;
        Ok(Answer::Nothing)
    }

    /// Aligns the motors where the tool stands, and tells what came of it. Then x and y have to be homed again.
    pub(in crate::machine) async fn align_and_tell(&mut self) -> Result<(), Interrupt> {
        match self.align().await {
            Ok(()) => self.tell(Answer::Belt(BeltAnswer::Aligned)).await,
            Err(BeltError::Align(error)) => self.tell(Answer::Belt(BeltAnswer::NotAligned(error))).await,
            Err(BeltError::Interrupted(interrupt)) => Err(interrupt),
        }
    }

    /// M915 D and R: what has happened since the motors were aligned; with `repairs` it is set right.
    pub(in crate::machine) async fn examine_belt(&mut self, repairs: bool) -> Result<Answer<'static>, Interrupt> {
        let residuals = self.residuals();
        if residuals.is_empty() {
            return Ok(Answer::Belt(BeltAnswer::NoResidual));
        }
        let [x, y, _] = self.homed.axes();
        if !(self.trimming.is_aligned() && x && y && self.has_power(residuals.motors())) {
            return Ok(Answer::Belt(BeltAnswer::NothingToCompare));
        }
        let lift = self.lift().await?;
        let aside = self.touch_both().await?;
        self.tell(Answer::Belt(BeltAnswer::Touched(aside))).await?;
        // Until it is known that nothing has happened, nobody is to believe it: M410 may end this with a motor on its way.
        let (homed, trimming) = (self.homed, self.trimming);
        self.trimming.forget();
        self.homed.release(residuals.motors(), self.real.groups().mechanism());
        let mut answer = match self.examine(&residuals, aside, repairs).await {
            Ok(diagnosis) => BeltAnswer::Diagnosis(diagnosis),
            Err(BeltError::Align(error)) => BeltAnswer::NotAligned(error),
            Err(BeltError::Interrupted(interrupt)) => return Err(interrupt),
        };
        let is_well = matches!(answer, BeltAnswer::Diagnosis(Diagnosis::Nothing));
        let is_known = matches!(answer, BeltAnswer::Diagnosis(_));
        if is_well {
            // Something may have happened while loads were measured.
            let again = self.touch_both().await?;
            if self.is_aside(again) {
                self.tell(Answer::Belt(BeltAnswer::Touched(again))).await?;
                answer = BeltAnswer::Diagnosis(Diagnosis::Several);
            } else if self.has_power(residuals.motors()) {
                (self.homed, self.trimming) = (homed, trimming);
            }
        } else if repairs && is_known {
            self.trimming.align();
            self.tell(Answer::Belt(answer)).await?;
            self.home_and_align(BELT_AXES, false).await?;
            let proof = self.touch_both().await?;
            answer = BeltAnswer::Repaired(proof);
            if self.is_aside(proof) {
                answer = BeltAnswer::NotRepaired(proof);
                self.trimming.forget();
                self.homed.release(residuals.motors(), self.real.groups().mechanism());
            }
        }
        self.lower(lift).await?;
        Ok(Answer::Belt(answer))
    }

    /// Meets the switches of x and y, and backs off. Gives how many steps beside their places they were met.
    async fn touch_both(&mut self) -> Result<[i32; 2], Interrupt> {
        Ok([self.touch(HomedAxis::X).await?, self.touch(HomedAxis::Y).await?])
    }

    /// Whether a tool that is so many steps beside its place is where it should not be.
    fn is_aside(&self, aside: [i32; 2]) -> bool {
        let full_step = i32::from(self.settings.drivers.belt.microsteps);
        aside.into_iter().any(|aside| is_aside(aside, full_step))
    }

    /// What the switches and the residuals say together. Motors that have skipped are left without strain if that is to be repaired; all
    /// others are as they were.
    async fn examine(&mut self, residuals: &Residuals, aside: [i32; 2], repairs: bool) -> Result<Diagnosis, BeltError> {
        self.begin_measuring(residuals.motors()).await?;
        let result = self.examine_each(residuals, aside, repairs).await;
        if !matches!(result, Err(BeltError::Interrupted(_))) {
            self.end_measuring().await?;
        }
        result
    }

    async fn examine_each(
        &mut self,
        residuals: &Residuals,
        aside: [i32; 2],
        repairs: bool,
    ) -> Result<Diagnosis, BeltError> {
        let full_step = i32::from(self.settings.drivers.belt.microsteps);
        let mut said = Diagnosis::Nothing;
        for (number, residual) in residuals.iter().enumerate() {
            let Some((motor, times)) = trimmed(residual) else { continue };
            let preload = self.preload_steps();
            let Some(apex) = self.find_apex(residual).await? else { continue };
            let step = apex.step;
            let touched = Touched { aside, residual: -step * times - preload };
            let found = diagnose(&self.settings.mechanism, residual, touched, full_step);
            said = found.graver(said);
            if repairs && found != Diagnosis::Nothing {
                self.leave_at(number, residual, apex).await?;
            } else {
                self.trim(motor, -step).await?;
            }
        }
        Ok(said)
    }

    /// Lifts z if it is known where it is, and says by how much.
    async fn lift(&mut self) -> Result<Mm, Interrupt> {
        self.finish().await?;
        let [.., z] = self.homed.axes();
        let position = self.planner.mm(self.planner.end());
        let [_, _, at, _] = position;
        let lift = LIFT.min(self.settings.axes.z.length.saturating_sub(at)).max(Mm::ZERO);
        if !z {
            return Ok(Mm::ZERO);
        }
        self.shift_z(lift).await?;
        Ok(lift)
    }

    /// Takes back what [`lift`](Self::lift) did.
    async fn lower(&mut self, lift: Mm) -> Result<(), Interrupt> {
        self.shift_z(-lift).await
    }

    async fn shift_z(&mut self, by: Mm) -> Result<(), Interrupt> {
        if by == Mm::ZERO {
            return Ok(());
        }
        let mut position = self.planner.mm(self.planner.end());
        let [_, _, z, _] = &mut position;
        *z = z.saturating_add(by);
        let speed = self.settings.axes.z.max_speed;
        self.plan(Target { position, speed, has_overrides: false, watch: EndstopSet::NONE }).await?;
        self.finish().await?;
        self.modal.position = self.retraction.commanded(self.planner.mm(self.planner.end()));
        Ok(())
    }

    /// Whether printing moves may be made: the motors of a belt are aligned, or need not be.
    pub(in crate::machine) fn lacks_alignment(&self) -> bool {
        if self.trimming.is_aligned() {
            return false;
        }
        let motors = self.residuals().motors();
        // Who has no UART can't be aligned, and is not asked for it.
        !motors.is_empty() && motors.without(self.drivers.lines()).is_empty()
    }
}
