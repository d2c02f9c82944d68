//! An episode: a guard's observations between a begin and an end. None of them is left after the end.
//!
//! A guard keeps its observations in an [`Episode`], which drops them by itself. So the guard cannot read the state of
//! a past episode.

/// An episode with the key `K` (a target, for example) and a guard's observations `S`.
#[derive(Clone, Copy, Debug)]
pub struct Episode<K, S>(Option<(K, S)>);

impl<K: PartialEq + Copy, S> Episode<K, S> {
    /// None has begun.
    #[must_use]
    pub const fn none() -> Self {
        Self(None)
    }

    /// Follows the episode of `key`. A new key begins an episode with `begin`; without a key the episode ends.
    pub fn follow(&mut self, key: Option<K>, begin: impl FnOnce() -> S) -> Option<&mut S> {
        let Some(key) = key else {
            self.0 = None;
            return None;
        };
        if self.0.as_ref().is_none_or(|(before, _)| *before != key) {
            self.0 = Some((key, begin()));
        }
        self.0.as_mut().map(|(_, seen)| seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_an_episode_that_has_ended() {
        let mut episode = Episode::none();
        let mut count = |key: Option<u8>| {
            episode.follow(key, || 0).map(|seen| {
                *seen += 1;
                *seen
            })
        };
        assert_eq!([Some(7), Some(7), Some(7)].map(&mut count), [Some(1), Some(2), Some(3)]);
        assert_eq!([Some(8), Some(7)].map(&mut count), [Some(1); 2], "another key is another episode");
        assert_eq!([None, Some(7), Some(7)].map(&mut count), [None, Some(1), Some(2)], "so is the same after an end");
    }
}
