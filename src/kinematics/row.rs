//! A row: what one motor does for the axes.

/// Steps of a motor for one step of x, y, z and e: -1, 0 or 1 for each, times a whole number of the motor. This number
/// exceeds 1 where motors with pulleys of different sizes share axes.
pub type Row = [i8; 4];

/// Largest whole number of a row: pulleys of 60 and 16 teeth are 4 to 15.
pub const MOST_MULTIPLE: i8 = 16;

/// Directions of a row and their opposites: three for each axis, without the row of zeros, and half of the rest.
const DIRECTIONS: i16 = (3 * 3 * 3 * 3 - 1) / 2;

/// The greatest [`row_number`].
pub const MOST_NUMBER: i16 = DIRECTIONS * MOST_MULTIPLE as i16;

/// The whole number of a row; 0 for a motor that is not fitted.
#[must_use]
pub fn multiple(row: Row) -> i8 {
    row.into_iter().map(i8::saturating_abs).max().unwrap_or_default()
}

/// A row without its whole number: the motor's direction for each axis.
#[must_use]
pub const fn direction([x, y, z, e]: Row) -> Row {
    [x.signum(), y.signum(), z.signum(), e.signum()]
}

/// The number of a row, from -[`MOST_NUMBER`] to [`MOST_NUMBER`]; `None` if the row is illegal. Records keep it.
///
/// The directions are digits in balanced ternary, which gives each row and its opposite one of the first 40 numbers.
/// Rows times two have the next 40, and so on. So every number is one row, and 0 is a motor that is not fitted.
#[must_use]
pub fn row_number(row: Row) -> Option<i16> {
    let multiple = multiple(row);
    let directions = direction(row);
    let is_whole =
        row.into_iter().zip(directions).all(|(times, one)| i16::from(times) == i16::from(one) * i16::from(multiple));
    let ternary = directions.into_iter().fold(0, |number, one| 3 * number + i16::from(one));
    let before = ternary.signum() * DIRECTIONS * (i16::from(multiple) - 1);
    (is_whole && multiple <= MOST_MULTIPLE).then_some(ternary + before)
}

/// The row of a [`row_number`]; `None` if it is none.
#[must_use]
pub fn row_of(number: i16) -> Option<Row> {
    let place = number.checked_abs().filter(|place| *place <= MOST_NUMBER)?;
    let (before, place) = ((place - 1).div_euclid(DIRECTIONS), (place - 1).rem_euclid(DIRECTIONS));
    let mut ternary = number.signum() * (place + 1);
    let multiple = i8::try_from(before + 1).ok()?;
    let mut row = [0; 4];
    for times in row.iter_mut().rev() {
        // The last digit in balanced ternary: -1, 0 or 1.
        let one = (ternary + 1).rem_euclid(3) - 1;
        ternary = (ternary - one) / 3;
        *times = multiple * i8::try_from(one).ok()?;
    }
    Some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_a_legal_row_and_every_legal_row_has_a_number() {
        let mut legal = 0;
        for number in -MOST_NUMBER..=MOST_NUMBER {
            let row = row_of(number).unwrap();
            assert_eq!(row_number(row), Some(number), "{row:?}");
            assert_eq!(row_number(row.map(|times| -times)), Some(-number), "{row:?}");
            legal += 1;
        }
        // 80 directions times each whole number, and the row of zeros.
        assert_eq!((legal, MOST_NUMBER), (80 * 16 + 1, 640));
        assert_eq!(row_number([0; 4]), Some(0));
    }

    #[test]
    fn other_numbers_and_rows_are_refused() {
        for number in [i16::MIN, -MOST_NUMBER - 1, MOST_NUMBER + 1, i16::MAX] {
            assert_eq!(row_of(number), None, "{number}");
        }
        let illegal = [[1, 2, 0, 0], [2, -1, 0, 0], [17, 0, 0, 0], [17, -17, 0, 0], [-128, 0, 0, 0], [-128, 127, 0, 0]];
        for row in illegal {
            assert_eq!(row_number(row), None, "{row:?}");
        }
    }
}
