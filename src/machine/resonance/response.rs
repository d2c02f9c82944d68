//! Response: power of the measured acceleration over power of the commanded one, by frequency.
//!
//! Welch's method (P. Welch, 1967): windows of [`WINDOW`] blocks that overlap by a half, Hann's window, each frequency
//! by G. Goertzel's recursion (1958). Hann's window is a sum of three neighbours there. The commanded power of the same
//! blocks is known, so the sweep's law, its harmonics and the means over blocks cancel in the quotient.

/// Blocks of a window.
const WINDOW: usize = 512;

/// Frequencies with a power: with blocks of 2.5 ms they are 0.78 Hz apart, up to 150 Hz.
pub(super) const FREQUENCIES: usize = 192;

/// A unit of a stored block in mm/s^2. The greatest is 13 g.
const UNIT: f32 = 4.0;

/// Cosine and sine of the angle between two frequencies: a turn over [`WINDOW`].
const STEP: [f32; 2] = [0.999_924_7, 0.012_271_538];

/// The powers of two signals.
pub(super) struct Response {
    /// Commanded and measured, the oldest at `next`.
    blocks: [[i16; WINDOW]; 2],
    next: usize,
    /// Blocks that must come before a window is complete.
    missing: usize,
    powers: [[f32; FREQUENCIES]; 2],
}

impl Response {
    /// Of nothing.
    pub const fn new() -> Self {
        Self { blocks: [[0; WINDOW]; 2], next: 0, missing: WINDOW, powers: [[0.0; FREQUENCIES]; 2] }
    }

    /// Takes a block: commanded and measured acceleration in mm/s^2.
    pub fn add(&mut self, block: [f32; 2]) {
        for (blocks, value) in self.blocks.iter_mut().zip(block) {
            if let Some(place) = blocks.get_mut(self.next) {
                *place = (value / UNIT) as i16;
            }
        }
        self.next = (self.next + 1) % WINDOW;
        self.missing -= 1;
        if self.missing == 0 {
            self.missing = WINDOW / 2;
            let (blocks, next) = (&self.blocks, self.next);
            for (blocks, powers) in blocks.iter().zip(&mut self.powers) {
                add_window(blocks, next, powers);
            }
        }
    }

    /// The response at a frequency, by its number; 0 where nothing was commanded.
    pub fn at(&self, number: usize) -> f32 {
        let [commanded, measured] = self.powers.each_ref().map(|powers| powers.get(number).copied().unwrap_or(0.0));
        if commanded > 0.0 { measured / commanded } else { 0.0 }
    }
}

/// Frequencies between two numbers, in Hz, at so many blocks a second.
pub(super) fn step_hz(blocks_a_second: f32) -> f32 {
    blocks_a_second / WINDOW as f32
}

/// Adds the powers of a window that begins at `first` of a ring.
#[inline(never)]
fn add_window(blocks: &[i16; WINDOW], first: usize, powers: &mut [f32; FREQUENCIES]) {
    let (new, old) = blocks.split_at(first.min(WINDOW));
    let [step_cosine, step_sine] = STEP;
    let (mut cosine, mut sine) = (1.0, 0.0);
    // The sums at the two frequencies before.
    let mut before = [[0.0; 2]; 2];
    for number in 0..=FREQUENCIES {
        let twice = cosine + cosine;
        let (mut last, mut last_but_one) = (0.0, 0.0);
        for block in old.iter().chain(new) {
            let sum = f32::from(*block) + twice * last - last_but_one;
            (last_but_one, last) = (last, sum);
        }
        let sum = [last * cosine - last_but_one, last * sine];
        // The power of the frequency between its neighbours.
        let [left, middle] = before;
        if let Some(power) = number.checked_sub(1).and_then(|number| powers.get_mut(number)) {
            let part = |i: usize| -> f32 {
                let of = |sum: [f32; 2]| sum.get(i).copied().unwrap_or(0.0);
                of(middle) - 0.5 * (of(left) + of(sum))
            };
            let (a, b) = (part(0), part(1));
            *power += a * a + b * b;
        }
        before = [middle, sum];
        (cosine, sine) = (cosine * step_cosine - sine * step_sine, sine * step_cosine + cosine * step_sine);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a tone, with a constant added to the measured one.
    fn response_of(hz: f32, gain: f32) -> Response {
        let mut response = Response::new();
        for i in 0..4 * WINDOW {
            let tone = (core::f32::consts::TAU * hz / 400.0 * i as f32).sin();
            response.add([3000.0 * tone, gain * 3000.0 * tone]);
        }
        response
    }

    #[test]
    fn a_tone_has_the_gain_of_its_amplitude() {
        for (hz, gain) in [(31.25, 1.0), (48.4, 3.0), (101.3, 0.25)] {
            let response = response_of(hz, gain);
            let number = (hz / step_hz(400.0)).round() as usize;
            let found = response.at(number);
            assert!((found / (gain * gain) - 1.0).abs() < 0.01, "{hz}: {found}");
        }
    }

    /// A tone at the middle of a frequency has a quarter of the power next to it and nothing farther away.
    #[test]
    fn the_window_is_hanns() {
        let response = response_of(50.0, 1.0);
        let [powers, _] = &response.powers;
        let top = powers[64];
        assert!((powers[63] / top - 0.25).abs() < 1e-3 && (powers[65] / top - 0.25).abs() < 1e-3);
        assert!(powers[60] < 1e-4 * top && powers[70] < 1e-4 * top && powers[150] < 1e-4 * top);
    }
}
