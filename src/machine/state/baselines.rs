//! The baselines of hotend and bed: what each takes and moves when it is healthy, as it was learned and stored.
//!
//! | event | then |
//! |---|---|
//! | the start reads a stored one, or a model comes that has one | the thermal context gets it |
//! | an hour of holds has shown one | it is stored when nothing moves, and then the thermal context gets it |
//! | M303 or M306 sets a model | it is forgotten, in the storage too |
//!
//! Each belongs to a model by its sum ([`baseline_subject`]): with another model it does not count.

use crate::connectors::Heater;
use crate::settings::ThermalSettings;
use crate::status::{Heat, WITH_FIGURES};
use crate::thermal::{Order, baseline_subject};

/// A stored baseline, or a forgotten one.
#[derive(Clone, Copy)]
struct Stored {
    subject: u32,
    /// Power and movement with 8 fractional bits; zeros are none.
    figures: [u16; 2],
    /// The thermal context does not have it yet.
    is_waiting: bool,
    /// The storage still has a forgotten one.
    is_to_erase: bool,
    /// What the storage would not take is not tried again.
    has_failed: bool,
}

/// The baselines.
pub(in crate::machine) struct Baselines([Stored; 2]);

impl Baselines {
    pub const fn new() -> Self {
        let none = Stored { subject: 0, figures: [0; 2], is_waiting: false, is_to_erase: false, has_failed: false };
        Self([none; 2])
    }

    /// One was read from the storage, or has just been written there.
    pub fn know(&mut self, heater: Heater, subject: u32, figures: [u16; 2]) {
        if let Some(stored) = self.0.get_mut(heater as usize) {
            let is_waiting = figures != [0; 2];
            *stored = Stored { subject, figures, is_waiting, is_to_erase: false, has_failed: false };
        }
    }

    /// A heater gets a model by M303 or M306: what it has shown counts no more.
    pub fn forget(&mut self, heater: Heater) {
        if let Some(stored) = self.0.get_mut(heater as usize) {
            // Also one of another model that the storage may have.
            *stored = Stored { subject: 0, figures: [0; 2], is_waiting: true, is_to_erase: true, has_failed: false };
        }
    }

    /// A heater has got other settings: its baseline is told again, if it is the one of that model.
    pub fn follow_settings(&mut self, heater: Heater) {
        if let Some(stored) = self.0.get_mut(heater as usize) {
            stored.is_waiting |= stored.figures != [0; 2];
        }
    }

    /// Whether any waits to be told.
    pub fn is_empty(&self) -> bool {
        !self.0.iter().any(|stored| stored.is_waiting)
    }

    /// The next order.
    pub fn next(&mut self, thermal: &ThermalSettings) -> Option<Order> {
        WITH_FIGURES.into_iter().zip(&mut self.0).find_map(|(heater, stored)| {
            let is_due = core::mem::take(&mut stored.is_waiting);
            let fits = stored.figures == [0; 2] || stored.subject == baseline_subject(thermal.heater(heater));
            (is_due && fits).then_some(Order::Baseline(heater, stored.figures))
        })
    }

    /// What is to be stored: the heater, its model's sum, and the figures; zeros erase.
    pub fn news(&self, heat: &Heat, thermal: &ThermalSettings) -> Option<(Heater, u32, [u16; 2])> {
        WITH_FIGURES.into_iter().zip(&self.0).find_map(|(heater, stored)| {
            let figures = heat.figures(heater);
            if stored.has_failed || stored.is_waiting {
                None
            } else if stored.is_to_erase {
                Some((heater, 0, [0; 2]))
            } else {
                figures.has_learned().then(|| (heater, baseline_subject(thermal.heater(heater)), figures.learned))
            }
        })
    }

    /// Whether one was forgotten, and is stored all the same.
    pub fn has_one_to_erase(&self) -> bool {
        self.0.iter().any(|stored| stored.is_to_erase)
    }

    /// The storage did not take it.
    pub fn give_up(&mut self, heater: Heater) {
        if let Some(stored) = self.0.get_mut(heater as usize) {
            stored.has_failed = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::{HeatFigures, Status};

    #[test]
    fn one_counts_for_its_model_alone() {
        let (status, mut thermal) = (Status::new(), ThermalSettings::prototype());
        let mut baselines = Baselines::new();
        assert!(baselines.is_empty() && baselines.news(status.heat(), &thermal).is_none());
        let figures = HeatFigures { learned: [250, 260], ..HeatFigures::NONE };
        status.heat().set_figures(Heater::Hotend, figures);
        let (heater, subject, learned) = baselines.news(status.heat(), &thermal).unwrap();
        assert_eq!((heater, learned), (Heater::Hotend, [250, 260]));
        baselines.know(heater, subject, learned);
        status.heat().set_figures(Heater::Hotend, HeatFigures::NONE);
        assert_eq!(baselines.next(&thermal), Some(Order::Baseline(Heater::Hotend, [250, 260])));
        assert!(baselines.next(&thermal).is_none() && baselines.news(status.heat(), &thermal).is_none());
        // Another model, and the old one again.
        let before = thermal;
        thermal.heaters.hotend.model.loss = thermal.heaters.hotend.model.loss.saturating_mul_int(2);
        baselines.follow_settings(Heater::Hotend);
        assert!(baselines.next(&thermal).is_none());
        baselines.follow_settings(Heater::Hotend);
        assert!(baselines.next(&before).is_some());
        // M306 forgets it, whatever it sets.
        baselines.forget(Heater::Hotend);
        assert_eq!(baselines.next(&before), Some(Order::Baseline(Heater::Hotend, [0; 2])));
        assert_eq!(baselines.news(status.heat(), &thermal), Some((Heater::Hotend, 0, [0; 2])));
        baselines.know(Heater::Hotend, 0, [0; 2]);
        assert!(baselines.is_empty() && baselines.news(status.heat(), &thermal).is_none());
    }

    #[test]
    fn what_the_storage_does_not_take_and_what_is_far_off_are_not_stored() {
        let (status, thermal) = (Status::new(), ThermalSettings::prototype());
        let mut baselines = Baselines::new();
        let learned = |learned| status.heat().set_figures(Heater::Bed, HeatFigures { learned, ..HeatFigures::NONE });
        learned([500, 256]);
        assert!(baselines.news(status.heat(), &thermal).is_none());
        learned([300, 256]);
        assert!(baselines.news(status.heat(), &thermal).is_some());
        baselines.give_up(Heater::Bed);
        assert!(baselines.news(status.heat(), &thermal).is_none());
    }
}
