//! Angles without floating point: CORDIC (J. E. Volder, "The CORDIC Trigonometric Computing Technique", IRE
//! Transactions on Electronic Computers EC-8, 1959), which needs only shifts and additions.

/// A full turn.
pub(in crate::machine) const TURN: i64 = 1 << 40;

/// atan(2^-i) as parts of a [`TURN`].
const ARC_TANGENT: [i64; 38] = [
    137_438_953_472,
    81_134_951_838,
    42_869_480_287,
    21_761_217_566,
    10_922_836_750,
    5_466_743_129,
    2_734_038_620,
    1_367_102_738,
    683_561_799,
    341_782_203,
    170_891_265,
    85_445_653,
    42_722_829,
    21_361_415,
    10_680_707,
    5_340_354,
    2_670_177,
    1_335_088,
    667_544,
    333_772,
    166_886,
    83_443,
    41_722,
    20_861,
    10_430,
    5_215,
    2_608,
    1_304,
    652,
    326,
    163,
    81,
    41,
    20,
    10,
    5,
    3,
    1,
];

/// The product of cos(atan(2^-i)), scaled by 2^60: by this much a vector shrinks to stay as long as it was.
const GAIN: i64 = 700_114_967_507_363_328;

/// The direction of a vector, in `-TURN/2 ..= TURN/2`, counter-clockwise from +x; 0 for no vector.
#[inline(never)]
pub(in crate::machine) fn direction(x: i64, y: i64) -> i64 {
    let largest = x.unsigned_abs().max(y.unsigned_abs());
    if largest == 0 {
        return 0;
    }
    // 60 bits at most, so that the growth by 1.65 and a sum of two still fit.
    let shift = largest.leading_zeros() as i32 - 4;
    let scale = |v: i64| if shift >= 0 { v << shift } else { v >> -shift };
    let (mut x, mut y) = (scale(x), scale(y));
    let mut angle = 0;
    if x < 0 {
        angle = if y < 0 { -TURN / 2 } else { TURN / 2 };
        (x, y) = (-x, -y);
    }
    for (i, step) in ARC_TANGENT.iter().enumerate() {
        let (dx, dy) = (y >> i, x >> i);
        if y > 0 {
            (x, y, angle) = (x + dx, y - dy, angle + step);
        } else {
            (x, y, angle) = (x - dx, y + dy, angle - step);
        }
    }
    angle
}

/// Cosine and sine of an angle, scaled by 2^60.
pub(in crate::machine) fn cos_sin(angle: i64) -> (i64, i64) {
    let angle = (angle + TURN / 2).rem_euclid(TURN) - TURN / 2;
    // The rotations below reach a little more than a quarter turn in both directions.
    let (mut left, flip) = if angle > TURN / 4 {
        (angle - TURN / 2, true)
    } else if angle < -TURN / 4 {
        (angle + TURN / 2, true)
    } else {
        (angle, false)
    };
    let (mut x, mut y) = (GAIN, 0i64);
    for (i, step) in ARC_TANGENT.iter().enumerate() {
        let (dx, dy) = (y >> i, x >> i);
        if left >= 0 {
            (x, y, left) = (x - dx, y + dy, left - step);
        } else {
            (x, y, left) = (x + dx, y - dy, left + step);
        }
    }
    if flip { (-x, -y) } else { (x, y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    #[test]
    fn directions_and_components_are_right_to_a_billionth() {
        for i in 0..1000 {
            let exact = TAU * f64::from(i) / 1000.0;
            let angle = TURN * i64::from(i) / 1000;
            let (c, s) = cos_sin(angle);
            let (c, s) = (c as f64 / 2f64.powi(60), s as f64 / 2f64.powi(60));
            assert!((c - exact.cos()).abs() < 1e-10 && (s - exact.sin()).abs() < 1e-10, "{i}");
            let r = 1e3 * 2f64.powi(32);
            let back = direction((r * exact.cos()) as i64, (r * exact.sin()) as i64);
            let off = (back - angle + TURN / 2).rem_euclid(TURN) - TURN / 2;
            assert!(off.abs() < TURN / 1_000_000_000, "{i}: {off}");
        }
    }

    #[test]
    fn the_axes_are_their_own_directions() {
        assert_eq!(direction(0, 0), 0);
        assert!(direction(5, 0).abs() < 16);
        assert!((direction(0, 5) - TURN / 4).abs() < 16);
        assert!((direction(-5, 0).abs() - TURN / 2).abs() < 16);
        assert!((direction(0, -5) + TURN / 4).abs() < 16);
    }
}
