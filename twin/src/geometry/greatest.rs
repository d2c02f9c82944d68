//! Greatest: the greatest values of figures over the reach, also between the places of a grid.
//!
//! A grid finds the neighbourhood of each greatest value. From there a search looks along each axis, at half the grid's
//! distance, and goes on to any greater value. Where there is none it halves its step.

use super::Workspace;
use crate::routing::Place;

/// Steps of the search: a half of the grid's distance, down to an eighth.
const HALVINGS: i32 = 3;

/// A smaller part of a value is no gain. So the search ends soon where a figure hardly changes.
const GAIN: f64 = 1e-4;

/// The greatest value of each figure. `at` is first called for the places of [`Workspace::grid`], in their order.
///
/// # Errors
/// The first of `at`.
pub fn greatest<const N: usize, E>(
    reach: &Workspace,
    [columns, rows]: [usize; 2],
    mut at: impl FnMut(Place) -> Result<[f64; N], E>,
) -> Result<[f64; N], E> {
    let mut best = [(reach.centre(), f64::NEG_INFINITY); N];
    let mut look = |place: Place, best: &mut [(Place, f64); N]| {
        let found = at(place)?;
        for (best, value) in best.iter_mut().zip(found) {
            if value > best.1 + GAIN * best.1.abs() || best.1 == f64::NEG_INFINITY {
                *best = (place, value);
            }
        }
        Ok(())
    };
    for place in reach.grid(columns, rows) {
        look(place, &mut best)?;
    }
    let distance = |[low, high]: [f64; 2], count: usize| (high - low) / count.saturating_sub(1).max(1) as f64;
    let distances = [distance(reach.x, columns), distance(reach.y, rows), distance(reach.z, reach.heights().len())];
    for figure in 0..N {
        for halving in 1..=HALVINGS {
            let steps = distances.map(|distance| distance / f64::from(1 << halving));
            while let Some((from, greatest)) = best.get(figure).copied() {
                for place in around(reach, from, steps) {
                    look(place, &mut best)?;
                }
                if best.get(figure).is_none_or(|best| best.1 == greatest) {
                    break;
                }
            }
        }
    }
    Ok(best.map(|(_, value)| value))
}

/// The places one step from another along each axis, as far as the reach goes.
fn around(reach: &Workspace, from: Place, [dx, dy, dz]: [f64; 3]) -> Vec<Place> {
    let within = |v: f64, [low, high]: [f64; 2]| v.clamp(low, high);
    let place = |sign: f64, [x, y, z]: [f64; 3]| Place {
        x: within(from.x + sign * x, reach.x),
        y: within(from.y + sign * y, reach.y),
        z: within(from.z + sign * z, reach.z),
    };
    let along = [[dx, 0.0, 0.0], [0.0, dy, 0.0], [0.0, 0.0, dz]];
    let all = along.into_iter().flat_map(|step| [place(-1.0, step), place(1.0, step)]);
    all.filter(|place| *place != from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Workspace = Workspace { x: [0.0, 300.0], y: [-100.0, 200.0], z: [0.0, 400.0] };

    #[test]
    fn a_summit_between_the_places_of_a_grid_is_found() {
        for (x, y, z) in [(33.0, 71.0, 90.0), (299.0, -99.0, 333.0), (140.0, 50.0, 200.0)] {
            let hill = |p: Place| 1e5 - (p.x - x).powi(2) - 2.0 * (p.y - y).powi(2) - 0.5 * (p.z - z).powi(2);
            let mut looks = 0;
            let found = greatest(&REACH, [4, 4], |place| {
                looks += 1;
                Ok::<_, ()>([hill(place), -hill(place)])
            });
            let [top, lowest] = found.unwrap();
            // An eighth of 100, 100 and 200 mm: half of it is the furthest from the summit along each axis.
            assert!(top > 1e5 - 6.3_f64.powi(2) * 3.0 - 0.5 * 12.5_f64.powi(2) - 1e5 * GAIN, "{top}");
            let corners = [REACH.x, REACH.y, REACH.z];
            let far =
                |axis: usize, at: f64| corners[axis].map(|end| (end - at).powi(2)).into_iter().fold(0.0, f64::max);
            assert!((lowest + 1e5 - far(0, x) - 2.0 * far(1, y) - 0.5 * far(2, z)).abs() < 1e-6, "{lowest}");
            assert!(looks < 48 + 120, "{looks}");
        }
    }

    #[test]
    fn the_grid_comes_first_and_an_error_ends_it() {
        let mut places = Vec::new();
        let found = greatest(&REACH, [2, 3], |place| {
            places.push(place);
            if places.len() > 20 { Err(places.len()) } else { Ok([place.x]) }
        });
        assert_eq!(places[..18], REACH.grid(2, 3)[..]);
        assert!(found == Err(21) || found == Ok([300.0]));
    }
}
