//! A position as hosts read it: M114, M154, and at the end of some commands.

use crate::kinematics::Groups;
use crate::machine::numbers::Hundredths;
use crate::machine::state::commanded::Commanded;
use crate::machine::state::position::RealPosition;
use crate::motors::MOST_GROUPS;
use crate::units::Mm;
use core::fmt;

/// A position, and the counts of the motor groups that move the tool.
pub(in crate::machine) struct Position<'m> {
    at: [Mm; 4],
    counts: [i32; MOST_GROUPS],
    groups: &'m Groups,
    /// The circulation of the belt, if it can circulate.
    circulation: Option<Mm>,
}

/// The letters of axes, and of coordinates that are a sum of axes.
const LETTERS: ([char; 4], [char; MOST_GROUPS]) = (['X', 'Y', 'Z', 'E'], ['A', 'B', 'C', 'D', 'E']);

impl fmt::Display for Position<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z, e] = self.at.map(Hundredths::of);
        write!(f, "X:{x} Y:{y} Z:{z} E:{e}")?;
        if let Some(c) = self.circulation.map(Hundredths::of) {
            write!(f, " C:{c}")?;
        }
        put!(f, " Count")?;
        let (axes, sums) = LETTERS;
        let mut sums = sums.into_iter();
        for (group, count) in self.groups.iter().zip(self.counts).filter(|(group, _)| group.is_tool()) {
            let letter = match group.axis() {
                Some(axis) => axes.get(axis).copied(),
                None => sums.next(),
            };
            write!(f, " {}:{count}", letter.unwrap_or_default())?;
        }
        Ok(())
    }
}

impl<'m> Position<'m> {
    /// The named position of a machine at `position`, with the step counts of its motor groups.
    pub fn new(
        position: [Mm; 4],
        circulation: Option<Mm>,
        counts: [i32; MOST_GROUPS],
        commanded: &Commanded,
        real: &RealPosition<'m>,
    ) -> Self {
        let (at, counts) = (commanded.named(position), real.of_groups(counts));
        Self { at, counts, groups: real.groups(), circulation }
    }
}
