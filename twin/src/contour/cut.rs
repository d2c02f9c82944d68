//! Cut: a row of places as few lines, cut where it is furthest from its line until it is within the tolerance (Douglas
//! and Peucker, 1973).
//!
//! The caller defines the distance: a step off the line, or a time before or after it.

/// The places that end lines, in order, of a row that ends with place `last`. `furthest` returns the place between two
/// others that is furthest from the line between them, if it is too far.
pub fn ends(last: usize, furthest: impl Fn(usize, usize) -> Option<usize>) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut pending = vec![(0, last)];
    while let Some((begin, end)) = pending.pop() {
        match furthest(begin, end) {
            Some(between) => pending.extend([(between, end), (begin, between)]),
            None if end > begin => ends.push(end),
            None => {}
        }
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_cut_where_it_bends_and_nowhere_else() {
        let heights = [0_i32, 1, 2, 3, 2, 1, 0, 0, 0];
        let furthest = |begin: usize, end: usize| {
            let off = |i: usize| {
                let (run, rise) = ((end - begin) as i32, heights[end] - heights[begin]);
                (heights[i] * run - heights[begin] * run - rise * (i - begin) as i32).abs()
            };
            (begin + 1..end).max_by_key(|i| off(*i)).filter(|i| off(*i) > 0)
        };
        assert_eq!(ends(8, furthest), [3, 6, 8]);
        assert!(ends(0, |_, _| None).is_empty());
    }
}
