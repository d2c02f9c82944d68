//! Rotor: which of its rest positions a rotor holds, and its load.
//!
//! A field has a rest position for its rotor in every electrical turn. The nearest one counts once the rotor has stayed
//! there; then another one is a skip. The load counts from then on too: at power-up the rotor may swing through its
//! whole field.

use crate::routing::Place;

/// A rotor has stayed after this many ticks: 20 ms, longer than a period of the slowest mode (57 Hz).
const STAYS: u64 = 200_000;

/// A rotor at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Glance {
    pub tick: u64,
    /// Electrical turns between its nearest rest position and its commanded one.
    pub turns: f64,
    /// Its torque share.
    pub share: f64,
    /// Whether the whole machine is at rest.
    pub is_at_rest: bool,
    pub tool: Place,
}

/// A motor's rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rotor {
    /// Its rest position, in electrical turns from the commanded one; none before it has one.
    turns: Option<f64>,
    /// Its rest position at the last look, and since when.
    seen: Option<(f64, u64)>,
    /// Time since when it is away from its rest position, and the tool's place then.
    left: Option<(u64, Place)>,
    greatest_share: f64,
    share: f64,
    /// Sum of the torque shares, and number of looks.
    shares: (f64, u32),
}

impl Rotor {
    /// Largest torque share since it held its rest position, of 1.
    #[must_use]
    pub const fn greatest_share(&self) -> f64 {
        self.greatest_share
    }

    /// Torque share at the last look, of 1.
    #[must_use]
    pub const fn share(&self) -> f64 {
        self.share
    }

    /// Mean torque share since the last call.
    pub(super) fn take_share(&mut self) -> f64 {
        let (sum, looks) = std::mem::take(&mut self.shares);
        if looks == 0 { self.share } else { sum / f64::from(looks) }
    }

    /// It got or lost power, so it has no rest position any more.
    pub(super) const fn forget(&mut self) {
        (self.turns, self.seen, self.left) = (None, None, None);
        (self.share, self.shares) = (0.0, (0.0, 0));
    }

    /// Looks at it. Once it has a new rest position, returns the time when it left the old one, the turns, and the
    /// tool's place.
    pub(super) fn look(&mut self, glance: &Glance) -> Option<(u64, i32, Place)> {
        let Glance { tick, turns, share, is_at_rest, tool } = *glance;
        self.share = share;
        self.shares = (self.shares.0 + share, self.shares.1 + 1);
        if self.turns.is_some() {
            self.greatest_share = self.greatest_share.max(share);
        }
        let since = self.seen.filter(|(seen, _)| *seen == turns).map_or(tick, |(_, since)| since);
        self.seen = Some((turns, since));
        if self.turns == Some(turns) {
            self.left = None;
            return None;
        }
        let (left, from) = *self.left.get_or_insert((tick, tool));
        if tick - since < STAYS && !is_at_rest {
            return None;
        }
        let held = self.turns.replace(turns);
        self.left = None;
        held.map(|held| (left, (turns - held) as i32, from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: Place = Place::flat(1.0, 2.0);

    fn look(rotor: &mut Rotor, ms: u64, turns: f64) -> Option<(u64, i32, Place)> {
        rotor.look(&Glance { tick: ms * 10_000, turns, share: 0.1, is_at_rest: false, tool: HERE })
    }

    #[test]
    fn a_skip_is_told_when_the_rotor_stays_and_dated_when_it_left() {
        let mut rotor = Rotor::default();
        // A fall into place at power-up is not a skip.
        assert!((0..40).all(|ms| look(&mut rotor, ms, 3.0).is_none()));
        // Neither is a swing out and back.
        assert!((40..50).all(|ms| look(&mut rotor, ms, 4.0).is_none()));
        assert!((50..80).all(|ms| look(&mut rotor, ms, 3.0).is_none()));
        // It runs away for 5 ms and then stays two turns back.
        assert_eq!(look(&mut rotor, 80, 2.0), None);
        assert!((85..105).all(|ms| look(&mut rotor, ms, 1.0).is_none()));
        assert_eq!(look(&mut rotor, 105, 1.0), Some((800_000, -2, HERE)));
        assert_eq!(look(&mut rotor, 106, 1.0), None);
    }

    #[test]
    fn the_mean_share_begins_anew_when_it_is_asked_for() {
        let mut rotor = Rotor::default();
        for share in [0.1, 0.3] {
            rotor.look(&Glance { tick: 0, turns: 0.0, share, is_at_rest: true, tool: HERE });
        }
        assert!((rotor.take_share() - 0.2).abs() < 1e-12 && (rotor.take_share() - 0.3).abs() < 1e-12);
        // The first look gave it its rest position.
        assert!((rotor.greatest_share() - 0.3).abs() < 1e-12);
    }
}
