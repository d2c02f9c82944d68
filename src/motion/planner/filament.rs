//! Filament ahead: the amount that the planned moves push within a given time, for the heater control.

use super::Planner;
use crate::units::{Steps, TICKS_PER_SECOND, part_of};

impl Planner<'_> {
    /// A position or length of filament in um.
    #[must_use]
    pub fn filament_um(&self, steps: Steps) -> i64 {
        let [.., e] = self.step_scale;
        e.mm(steps).wrapping_um()
    }

    /// Filament in um that passes the nozzle within `ticks` from now, and um/s at their end. The extruder stands `at`,
    /// and the moves that have left the look-ahead take this many ticks more.
    ///
    /// Moves that have left count as one move. Moves that wait count with their nominal times, so ramps are left out.
    /// After the last move nothing flows.
    #[must_use]
    pub fn filament_within(&self, ticks: u64, at: Steps, left_ticks: u64) -> [i64; 2] {
        let mut from = self.released_filament;
        let left = (self.filament_um(from.wrapping_sub(at)), left_ticks);
        let moves = (0..self.window.len()).map_while(|index| self.window.get(index)).map(|planned| {
            let [.., end] = planned.spec.end;
            let way = end.wrapping_sub(core::mem::replace(&mut from, end));
            (self.filament_um(way), u64::from(planned.nominal_ticks))
        });
        let open = self.open_filament().map(|(way, takes)| (self.filament_um(way), takes));
        flow(core::iter::once(left).chain(moves).chain(open), ticks)
    }
}

/// The sum over pieces of um and ticks until `ticks` are over, and um/s there.
fn flow(pieces: impl Iterator<Item = (i64, u64)>, ticks: u64) -> [i64; 2] {
    let (mut sum, mut missing) = (0, ticks);
    for (um, takes) in pieces {
        if takes >= missing && takes > 0 {
            return [sum + part_of(um, missing, takes), part_of(um, TICKS_PER_SECOND.into(), takes)];
        }
        (sum, missing) = (sum + um, missing - takes);
    }
    [sum, 0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_cut_at_the_end_of_the_time() {
        const SECOND: u64 = TICKS_PER_SECOND as u64;
        let flow = |pieces: &[(i64, u64)], ticks| flow(pieces.iter().copied(), ticks);
        assert_eq!(flow(&[(3000, 3 * SECOND)], SECOND), [1000, 1000]);
        assert_eq!(flow(&[(500, SECOND / 2), (0, SECOND / 4), (4000, SECOND)], SECOND), [1500, 4000]);
        assert_eq!(flow(&[(500, SECOND / 2)], SECOND), [500, 0]);
        assert_eq!(flow(&[(-800, SECOND / 10), (800, SECOND / 10)], SECOND), [0, 0]);
        assert_eq!(flow(&[(7, 0), (1, 0)], 0), [8, 0]);
    }
}
