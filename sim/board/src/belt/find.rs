//! Find: the part of a machine that an accident names.

use super::layout::{Layout, LayoutError};
use crate::accident::Accident;
use corehbot::motors::MotorName;
use corehbot_twin::routing::Belt;
use corehbot_twin::stepped_machine::failing::idlers_of;

/// A part of the belts, as an accident names it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum BrokenPart {
    /// A motor, by its place among the machine's.
    Motor(usize),
    /// Idlers of one number, by the indices of their stops.
    Idlers(Vec<usize>),
}

impl Layout {
    /// All motors of an accident's name, by their places: a driver may turn two. A number is that of one motor.
    ///
    /// # Errors
    /// There is no such motor.
    pub(super) fn motors_of(&self, accident: &Accident) -> Result<Vec<usize>, LayoutError> {
        let named = self.drives.iter().enumerate().filter(|(_, drive)| drive.name.as_str() == accident.name);
        let motors: Vec<usize> = named.map(|(index, _)| index).collect();
        if motors.is_empty() { Ok(vec![self.motor_part(accident)?]) } else { Ok(motors) }
    }

    /// The different names of its motors.
    fn names(&self) -> Vec<MotorName> {
        let mut names: Vec<MotorName> = Vec::new();
        for drive in &self.drives {
            if !names.contains(&drive.name) {
                names.push(drive.name);
            }
        }
        names
    }

    /// The part of an accident: a motor by its name, the first of two on one driver, or a pulley by its number.
    ///
    /// # Errors
    /// There is no such part.
    pub(super) fn part(&self, accident: &Accident) -> Result<BrokenPart, LayoutError> {
        let named = self.drives.iter().position(|drive| drive.name.as_str() == accident.name);
        let number = || accident.name.parse::<u8>().ok().filter(|number| *number > 0);
        let numbered = || self.machine.motors().iter().position(|motor| Some(*motor) == number());
        if let Some(motor) = named.or_else(numbered) {
            return Ok(BrokenPart::Motor(motor));
        }
        let stops = number().map_or_else(Vec::new, |number| idlers_of(self.machine, number));
        if stops.is_empty() {
            let mut idlers: Vec<u8> = self.machine.stops().iter().filter(|s| s.is_idler()).map(|s| s.number).collect();
            idlers.sort_unstable();
            idlers.dedup();
            return Err(LayoutError::NoPart(accident.text.clone(), accident.name.clone(), self.names(), idlers));
        }
        Ok(BrokenPart::Idlers(stops))
    }

    /// The same for an accident that only a motor can have.
    ///
    /// # Errors
    /// There is no such motor.
    pub(super) fn motor_part(&self, accident: &Accident) -> Result<usize, LayoutError> {
        let missing = || LayoutError::NoPart(accident.text.clone(), accident.name.clone(), self.names(), Vec::new());
        match self.part(accident) {
            Ok(BrokenPart::Motor(motor)) => Ok(motor),
            Ok(BrokenPart::Idlers(_)) | Err(_) => Err(missing()),
        }
    }

    /// 1 for a motor that drives forward counter-clockwise, otherwise -1.
    pub(super) fn sense(&self, motor: usize) -> f64 {
        self.drives.get(motor).map_or(1.0, |drive| f64::from(drive.sense))
    }

    /// The belt that a motor drives, in the order of the machine's belts.
    pub(super) fn belt_of(&self, motor: usize) -> usize {
        let number = self.machine.motors().get(motor).copied();
        let has_it = |belt: &Belt| belt.stops.iter().any(|stop| stop.motor().is_some() && stop.motor() == number);
        self.machine.belts().iter().position(has_it).unwrap_or_default()
    }
}
