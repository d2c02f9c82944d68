//! Turns: whose turn it is next among the motor groups.

/// What a group does next. Of all that is due in one tick, changes come first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Next {
    /// Its way goes on otherwise.
    Change,
    /// A step.
    Step,
    /// Nothing: it rests.
    Nothing,
}

/// What some group does next, and when: the smallest of several comes first. Ticks from now times 32, [`Next`] times 8,
/// and the number of the group, so that one comparison tells everything.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Turn(u32);

/// All of a [`Turn`] but the time.
#[derive(Clone, Copy)]
pub(super) struct Rank(u32);

impl Rank {
    /// The rank of a group that does that next.
    pub const fn new(group: usize, next: Next) -> Self {
        Self((next as u32) << 3 | group as u32 & 7)
    }

    /// The same group when it does something else.
    pub const fn with(self, next: Next) -> Self {
        Self::new(self.0 as usize, next)
    }

    /// What it does next.
    pub const fn next(self) -> Next {
        match self.0 >> 3 & 3 {
            0 => Next::Change,
            1 => Next::Step,
            _ => Next::Nothing,
        }
    }
}

impl Turn {
    /// The last of all.
    pub const LAST: Self = Self(u32::MAX);

    /// The turn in `wait` ticks, which are less than 2^27.
    #[inline(always)]
    pub const fn new(wait: u32, rank: Rank) -> Self {
        Self(wait << 5 | rank.0)
    }

    /// Whether this is another group's turn to do the same in the same tick, or the same turn.
    pub const fn is_together(self, other: Self) -> bool {
        (self.0 ^ other.0) >> 3 == 0
    }

    /// The number of the group.
    #[inline(always)]
    pub const fn group(self) -> usize {
        (self.0 & 7) as usize
    }

    /// Ticks from now.
    #[inline(always)]
    pub const fn wait(self) -> u32 {
        self.0 >> 5
    }

    /// What the group does.
    #[inline(always)]
    pub const fn next(self) -> Next {
        Rank(self.0).next()
    }
}
