//! Sampling: the points of a parameter space that a study uses.
//!
//! A point is a pure function of the design and its number, so points can be computed in any order and on any machine.
//! [`grid`] has every combination of levels. [`latin`] spreads a chosen number of points so that each parameter alone
//! is covered evenly (McKay, Beckman and Conover, Technometrics 21, 1979). [`corehbot_twin::random`] gives the same
//! numbers on every platform.

pub mod grid;
pub mod latin;

use latin::LatinHypercube;

/// Possible values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// At one of these values.
    Levels(Vec<f64>),
    /// Anywhere from the first to the last.
    Span([f64; 2]),
}

impl Axis {
    /// The value at a part of the axis, from 0 to below 1; each level takes an equal part.
    #[must_use]
    fn at(&self, part: f64) -> f64 {
        match self {
            Self::Levels(levels) => {
                let level = (part * levels.len() as f64) as usize;
                levels.get(level).or(levels.last()).copied().unwrap_or(f64::NAN)
            }
            Self::Span([from, to]) => from + (to - from) * part,
        }
    }
}

/// Points, by their numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Design {
    /// Every combination of these levels, the last parameter fastest.
    Grid(Vec<Vec<f64>>),
    /// A Latin hypercube.
    LatinHypercube(LatinHypercube),
}

impl Design {
    /// Number of its points, unless it overflows.
    #[must_use]
    pub fn points(&self) -> Option<usize> {
        match self {
            Self::Grid(axes) => grid::len(axes),
            Self::LatinHypercube(hypercube) => Some(hypercube.points()),
        }
    }

    /// The point of this number, counted from 0.
    #[must_use]
    pub fn point(&self, number: usize) -> Option<Vec<f64>> {
        match self {
            Self::Grid(axes) => grid::point(axes, number),
            Self::LatinHypercube(hypercube) => hypercube.point(number),
        }
    }
}

/// Evenly spaced values from one end to the other, both included; the ends are exact.
#[must_use]
pub fn levels([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1);
    let level = |i: usize| if i == last { to } else { from + (to - from) * i as f64 / last as f64 };
    (0..count).map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_even_and_end_where_they_should() {
        assert_eq!(levels([20.0, 60.0], 3), [20.0, 40.0, 60.0]);
        assert_eq!(levels([0.0, 0.7], 8).last(), Some(&0.7));
        assert_eq!(levels([5.0, 9.0], 1), [9.0]);
    }

    #[test]
    fn each_level_takes_an_equal_part_of_the_axis() {
        let axis = Axis::Levels(vec![1.0, 2.0, 4.0]);
        assert_eq!([0.0, 0.33, 0.34, 0.66, 0.67, 0.999].map(|part| axis.at(part)), [1.0, 1.0, 2.0, 2.0, 4.0, 4.0]);
    }
}
