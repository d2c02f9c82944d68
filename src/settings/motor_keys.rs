//! Keys of settings that each motor has. In them `#0` stands for the name of the first motor.

use crate::motors::MOTORS;

/// A key of `N` bytes for each motor.
pub(super) type MotorKeys<const N: usize> = [[u8; N]; MOTORS];

/// The keys of all motors: the first one's, with the digit at its end counted up.
pub(super) const fn motor_keys<const N: usize>(first: [u8; N]) -> MotorKeys<N> {
    let mut keys = [first; MOTORS];
    let (mut number, mut left): (u8, &mut [[u8; N]]) = (0, &mut keys);
    while let [key, others @ ..] = left {
        if let [.., digit] = key.as_mut_slice() {
            *digit += number;
        }
        (number, left) = (number + 1, others);
    }
    keys
}

/// These keys as texts.
pub(super) const fn texts<const N: usize>(keys: &'static MotorKeys<N>) -> [&'static str; MOTORS] {
    let mut texts = [""; MOTORS];
    let (mut keys, mut left): (&[[u8; N]], &mut [&str]) = (keys, &mut texts);
    while let ([key, other_keys @ ..], [text, other_texts @ ..]) = (keys, left) {
        if let Ok(key) = core::str::from_utf8(key) {
            *text = key;
        }
        (keys, left) = (other_keys, other_texts);
    }
    texts
}
