//! A range of legal values.

/// Least and greatest legal value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Range<T> {
    /// Least legal value.
    pub least: T,
    /// Greatest legal value.
    pub most: T,
}

impl<T: PartialOrd + Copy> Range<T> {
    /// Whether `value` is legal.
    #[must_use]
    pub fn holds(&self, value: T) -> bool {
        self.least <= value && value <= self.most
    }

    /// The legal value nearest to `value`.
    #[must_use]
    pub fn clamp(&self, value: T) -> T {
        if value < self.least {
            self.least
        } else if value > self.most {
            self.most
        } else {
            value
        }
    }
}
