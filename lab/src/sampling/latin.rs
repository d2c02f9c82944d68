//! Latin hypercube: n points with exactly one in every nth part of each parameter's axis.

use super::Axis;
use corehbot_twin::random::Random;

/// The points.
#[derive(Clone, Debug, PartialEq)]
pub struct LatinHypercube {
    points: usize,
    /// The values of each parameter, point after point.
    columns: Vec<Vec<f64>>,
}

impl LatinHypercube {
    /// This many points over these axes. Each axis draws from its own stream, so another axis does not change them.
    #[must_use]
    pub fn new(axes: &[Axis], points: usize, seed: u64) -> Self {
        let column = |(stream, axis): (u64, &Axis)| {
            let mut random = Random::new(seed, stream);
            let strata = random.permutation(points);
            let part = |stratum: usize| ((stratum as f64 + random.unit()) / points as f64).min(BELOW_ONE);
            strata.into_iter().map(part).map(|part| axis.at(part)).collect()
        };
        Self { points, columns: (0..).zip(axes).map(column).collect() }
    }

    /// Number of points.
    #[must_use]
    pub const fn points(&self) -> usize {
        self.points
    }

    /// The values of all parameters at this point, counted from 0.
    #[must_use]
    pub fn point(&self, number: usize) -> Option<Vec<f64>> {
        self.columns.iter().map(|column| column.get(number).copied()).collect()
    }
}

/// Largest number below 1: the last stratum ends before it, despite rounding.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn hypercube(points: usize, seed: u64) -> LatinHypercube {
        LatinHypercube::new(&[Axis::Span([0.0, 1.0]), Axis::Span([-40.0, 60.0]), Axis::Span([7.0, 3.0])], points, seed)
    }

    #[test]
    fn every_stratum_of_every_parameter_has_one_point() {
        for (points, seed) in [(1, 0), (2, 1), (7, 2), (100, 3), (1009, u64::MAX)] {
            let design = hypercube(points, seed);
            for (axis, [from, to]) in [[0.0, 1.0], [-40.0, 60.0], [7.0, 3.0]].into_iter().enumerate() {
                let mut strata: Vec<usize> = (0..points)
                    .map(|i| design.point(i).unwrap()[axis])
                    .map(|value| ((value - from) / (to - from) * points as f64).floor() as usize)
                    .collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..points).collect::<Vec<_>>(), "{points} points, axis {axis}");
            }
            assert_eq!(design.point(points), None);
        }
    }

    #[test]
    fn levels_come_equally_often() {
        let design = LatinHypercube::new(&[Axis::Levels(vec![1.0, 2.0, 3.0])], 12, 5);
        let times = |level: f64| (0..12).filter(|i| design.point(*i) == Some(vec![level])).count();
        assert_eq!([1.0, 2.0, 3.0].map(times), [4, 4, 4]);
    }

    #[test]
    fn a_seed_is_one_design_and_another_parameter_does_not_move_the_first() {
        assert_eq!(hypercube(50, 9), hypercube(50, 9));
        assert_ne!(hypercube(50, 9), hypercube(50, 10));
        let alone = LatinHypercube::new(&[Axis::Span([0.0, 1.0])], 50, 9);
        assert!((0..50).all(|i| alone.point(i).unwrap()[0] == hypercube(50, 9).point(i).unwrap()[0]));
    }

    /// Two parameters of one design are independent: for 1,009 points their correlation has a standard deviation of 1 /
    /// sqrt(1008) = 0.031.
    #[test]
    fn parameters_are_not_correlated() {
        let design = hypercube(1009, 4);
        let column = |axis: usize| design.columns[axis].iter().copied();
        let (x, y): (Vec<f64>, Vec<f64>) = (column(0).collect(), column(1).map(|v| (v + 40.0) / 100.0).collect());
        let covariance = x.iter().zip(&y).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum::<f64>() / 1009.0;
        assert!((12.0 * covariance).abs() < 4.0 * 0.031, "{covariance}");
    }
}
