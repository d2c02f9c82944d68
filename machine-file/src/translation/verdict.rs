//! Verdicts: what became of a key of another firmware.

/// What became of a key; the later ones ask more of the owner.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Kind {
    /// It needs no setting here.
    NotNeeded,
    /// It is in the machine file.
    Taken,
    /// Something near it is in the machine file.
    Approximated,
    /// This firmware has nothing for it so far.
    NotYet,
    /// The owner has to decide, or the file is no machine.
    Decide,
}

impl Kind {
    /// All of them, in the order of summaries.
    pub const ALL: [Self; 5] = [Self::Taken, Self::Approximated, Self::NotNeeded, Self::NotYet, Self::Decide];

    /// The word in reports.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::NotNeeded => "not needed",
            Self::Taken => "taken",
            Self::Approximated => "approximated",
            Self::NotYet => "not there yet",
            Self::Decide => "to decide",
        }
    }
}

/// A verdict and the words about it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Verdict {
    /// What became of it.
    pub kind: Kind,
    /// How, or why; may be empty.
    pub text: String,
}

impl Verdict {
    /// A verdict with its words.
    #[must_use]
    pub fn new(kind: Kind, text: impl Into<String>) -> Self {
        Self { kind, text: text.into() }
    }

    /// Both of two verdicts on a key: the graver one counts.
    pub(crate) fn and(self, other: Self) -> Self {
        if self.text.contains(&other.text) {
            return Self { kind: self.kind.max(other.kind), ..self };
        }
        let between = if self.text.is_empty() || other.text.is_empty() { "" } else { "; " };
        Self { kind: self.kind.max(other.kind), text: self.text + between + &other.text }
    }
}
