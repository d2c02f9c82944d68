//! First layer: what comes after the guide, in words.

use super::guide::{Found, Guide};
use super::step_error::StepError;
use corehbot::kinematics::Residuals;
use corehbot::settings::AxisEnd;

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let s = &guide.machine;
    let (z, bed) = (s.endstops.z, s.bed);
    found.note(match z.end {
        AxisEnd::Min => {
            "Home, heat the bed, and lower the nozzle onto a sheet of paper in the middle. M114 says Z then; subtract it from \
             homing.z.position in the machine file."
        }
        AxisEnd::Max => {
            "Home, heat the bed, and lower the nozzle onto a sheet of paper in the middle. M114 says Z then; subtract it from \
             homing.z.position, which is the height of the switch above the bed."
        }
    });
    found.note("Level the bed by its screws: the paper must drag alike in all four corners. Nothing here probes it.");
    let [width, depth] = [bed.width, bed.depth].map(|length| length.to_num::<i32>());
    found.note(format!("The slicer's bed is {width} x {depth} mm (M503 says where it begins)."));
    if !Residuals::new(&s.mechanism, s.belt.is_closed).is_empty() {
        found.note("Align the motors of the belt: M915, then M500 (docs/explanation/belt/alignment.md).");
    }
    found.note("Print a single layer of 100 x 100 mm first, a hand near M112.");
    Ok(found)
}
