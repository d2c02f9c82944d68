//! Lags of the first order, in periods of a control loop.

use super::Seconds;
use fixed::types::I0F32;

/// The part of a difference that a lag of the first order makes up for in one of `rate` periods a second. It is a half
/// if the lag is shorter than two periods. The product of such a part and a word has the word's size without a shift or
/// a check.
#[must_use]
pub const fn part_per_period(lag: Seconds, rate: u32) -> I0F32 {
    const ONE: u64 = 1 << I0F32::FRAC_NBITS;
    let product = lag.to_bits() as u64 * rate as u64;
    let part = (ONE << Seconds::FRAC_NBITS) / if product == 0 { 1 } else { product };
    if part < ONE / 2 { I0F32::from_bits(part as i32) } else { I0F32::MAX }
}

/// Periods, `rate` of them a second, in this many lags; cut off.
#[must_use]
pub const fn periods_in(lags: u32, lag: Seconds, rate: u32) -> u32 {
    // 32 bits are enough for half an hour at a rate of 100,000.
    ((lag.to_bits() as u64 * lags as u64 * rate as u64) >> Seconds::FRAC_NBITS) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lags_are_parts_and_numbers_of_periods() {
        let parts = [("2", 50), ("0.5", 50), ("0.02", 50), ("0.001", 50), ("0", 50), ("200", 1000)];
        for (lag, rate) in parts.map(|(lag, rate)| (Seconds::lit(lag), rate)) {
            let wanted = (1.0 / (lag.to_num::<f64>() * f64::from(rate))).min(0.5);
            assert!((part_per_period(lag, rate).to_num::<f64>() - wanted).abs() < 1e-9, "{lag}");
        }
        assert_eq!(periods_in(6, Seconds::lit("2.5"), 50), 750);
        assert_eq!(periods_in(5, Seconds::lit("0.019"), 50), 4);
        assert_eq!(periods_in(u32::from(u16::MAX), Seconds::MAX, 50), 838_847_999);
    }
}
