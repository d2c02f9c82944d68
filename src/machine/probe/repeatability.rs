//! The repeatability of a probe: mean and standard deviation of its touches at a place (M48).

use crate::units::{Mm, whole_root};

/// A millimetre in nm.
const NM: i128 = 1_000_000;

/// Mean and spread of touches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Spread {
    pub mean_nm: i64,
    pub least: Mm,
    pub most: Mm,
    /// Standard deviation.
    pub sigma_nm: u64,
}

/// Heights, each relative to the first, in nm: sums of 50 squares of some mm fit 64 bits.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct Repeatability {
    first: Mm,
    count: i64,
    sum: i64,
    squares: i64,
    least: Mm,
    most: Mm,
}

impl Repeatability {
    /// Takes in a height.
    pub fn add(&mut self, height: Mm) {
        if self.count == 0 {
            (self.first, self.least, self.most) = (height, height, height);
        }
        let away = nm(height.saturating_sub(self.first));
        self.count += 1;
        self.sum += away;
        self.squares = self.squares.saturating_add(away.saturating_mul(away));
        (self.least, self.most) = (self.least.min(height), self.most.max(height));
    }

    /// Their mean and spread. The standard deviation is of these touches themselves, as in Marlin: it divides by their
    /// number.
    pub fn spread(&self) -> Spread {
        let count = self.count.max(1);
        let variance = count.saturating_mul(self.squares).saturating_sub(self.sum.saturating_mul(self.sum)).max(0);
        let sigma = whole_root(variance.cast_unsigned()) / count.cast_unsigned();
        Spread { mean_nm: nm(self.first) + self.sum / count, least: self.least, most: self.most, sigma_nm: sigma }
    }
}

fn nm(length: Mm) -> i64 {
    ((i128::from(length.to_bits()) * NM + (1 << 31)) >> 32) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(heights: &[&str]) -> Spread {
        let mut touches = Repeatability::default();
        heights.iter().for_each(|height| touches.add(Mm::from_num(height.parse::<f64>().unwrap())));
        touches.spread()
    }

    #[test]
    fn the_deviation_of_marlins_example_divides_by_the_number_of_touches() {
        let Spread { mean_nm, sigma_nm, least, most } = of(&["0.010", "0.009", "0.011", "0.012"]);
        assert_eq!((mean_nm, sigma_nm), (10_500, 1118));
        assert!(Mm::from_num(0.003).saturating_sub(most - least).saturating_abs() < Mm::from_num(1e-6));
    }

    #[test]
    fn the_deviation_of_klippers_example_is_that_of_its_documentation() {
        let heights = [
            "2.519448", "2.519448", "2.506948", "2.506948", "2.506948", "2.519448", "2.519448", "2.506948", "2.506948",
            "2.519448",
        ];
        let Spread { mean_nm, sigma_nm, .. } = of(&heights);
        assert_eq!((mean_nm, sigma_nm), (2_513_198, 6250));
    }

    #[test]
    fn one_touch_deviates_by_nothing() {
        let Spread { mean_nm, sigma_nm, .. } = of(&["-1.25"]);
        assert_eq!((mean_nm, sigma_nm), (-1_250_000, 0));
    }
}
