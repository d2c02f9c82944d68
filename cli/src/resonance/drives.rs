//! Drives: the groups of a machine's motors that move x and y.

use corehbot::kinematics::Groups;
use corehbot::settings::Settings;
use corehbot_resonance::motors::Drive;

/// The groups of these settings.
pub(super) fn of(settings: &Settings) -> Vec<Drive> {
    let Settings { axes, mechanism, .. } = settings;
    let steps_per_mm = [axes.x.steps_per_mm, axes.y.steps_per_mm].map(|steps| steps.to_num::<f64>());
    let drive = |lead, row: [i8; 4], motors: String| {
        let microsteps = f64::from(settings.driver_of(lead).microsteps);
        let full_steps_per_mm = [0, 1].map(|axis| f64::from(row[axis]) * steps_per_mm[axis] / microsteps);
        Drive { motors, full_steps_per_mm }
    };
    let groups = Groups::new(mechanism);
    let belts = groups.iter().filter(|group| group.is_belt());
    let names = |group: &corehbot::kinematics::Group| {
        let all = group.motors().iter().map(|motor| settings.name_of(motor).as_str().to_owned());
        all.collect::<Vec<_>>().join(", ")
    };
    belts.map(|group| drive(group.lead, group.row, names(group))).collect()
}
