//! Grid: every combination of the levels of each parameter.

/// Number of combinations, unless it overflows.
#[must_use]
pub fn len(axes: &[Vec<f64>]) -> Option<usize> {
    axes.iter().try_fold(1_usize, |product, levels| product.checked_mul(levels.len()))
}

/// The combination of this number, counted from 0. As with the digits of a number, the last parameter changes fastest.
#[must_use]
pub fn point(axes: &[Vec<f64>], number: usize) -> Option<Vec<f64>> {
    let mut rest = number;
    let mut point = Vec::with_capacity(axes.len());
    for levels in axes.iter().rev() {
        point.push(*levels.get(rest.checked_rem(levels.len())?)?);
        rest /= levels.len();
    }
    point.reverse();
    (rest == 0).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_parameter_changes_fastest() {
        let axes = [vec![1.0, 2.0], vec![10.0, 20.0, 30.0]];
        let points: Vec<_> = (0..6).filter_map(|i| point(&axes, i)).collect();
        let expected = [[1.0, 10.0], [1.0, 20.0], [1.0, 30.0], [2.0, 10.0], [2.0, 20.0], [2.0, 30.0]];
        assert_eq!(points, expected);
        assert_eq!((len(&axes), point(&axes, 6)), (Some(6), None));
    }

    #[test]
    fn no_parameter_is_one_point_and_too_many_are_not_counted() {
        assert_eq!((len(&[]), point(&[], 0), point(&[], 1)), (Some(1), Some(vec![]), None));
        let huge = vec![vec![0.0; 1 << 16]; 4];
        assert_eq!(len(&huge), None);
    }
}
