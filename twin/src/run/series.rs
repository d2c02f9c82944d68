//! Series: results over time, in bins that grow with the trace, so that its size is bounded.

/// Maximum number of bins; beyond it two become one.
const MOST: usize = 2048;

/// Ticks of a bin at first: 5 ms.
const FIRST_TICKS: u64 = 50_000;

/// Extremes over a stretch of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bin {
    /// Error of the tool.
    pub error_mm: f64,
    /// Lowest and highest tension of each span; empty without a look.
    pub tensions_n: Vec<[f64; 2]>,
    /// Force at the belt of each motor.
    pub forces_n: Vec<f64>,
    /// Torque of all motors together, and 0.
    pub motors_torque_n_mm: [f64; 2],
    /// Displacement of a soft frame along x and y.
    pub frame_mm: [f64; 2],
}

impl Bin {
    /// Merges results of the same time.
    fn join(&mut self, other: &Self) {
        self.error_mm = self.error_mm.max(other.error_mm);
        let ([low, high], [least, greatest]) = (self.motors_torque_n_mm, other.motors_torque_n_mm);
        self.motors_torque_n_mm = [low.min(least), high.max(greatest)];
        for (moved, other) in self.frame_mm.iter_mut().zip(other.frame_mm) {
            *moved = moved.max(other);
        }
        if self.tensions_n.is_empty() {
            self.tensions_n.clone_from(&other.tensions_n);
            self.forces_n.clone_from(&other.forces_n);
            return;
        }
        for (range, [least, greatest]) in self.tensions_n.iter_mut().zip(&other.tensions_n) {
            *range = [range[0].min(*least), range[1].max(*greatest)];
        }
        for (force, other) in self.forces_n.iter_mut().zip(&other.forces_n) {
            *force = force.max(*other);
        }
    }
}

/// Bins in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Ticks of each.
    pub bin_ticks: u64,
    /// From 0 on.
    pub bins: Vec<Bin>,
}

impl Default for Series {
    fn default() -> Self {
        Self { bin_ticks: FIRST_TICKS, bins: Vec::new() }
    }
}

impl Series {
    /// Adds results at a time.
    pub fn add(&mut self, tick: u64, what: &Bin) {
        while tick / self.bin_ticks >= MOST as u64 {
            self.halve();
        }
        let index = (tick / self.bin_ticks) as usize;
        if self.bins.len() <= index {
            self.bins.resize(index + 1, Bin::default());
        }
        if let Some(bin) = self.bins.get_mut(index) {
            bin.join(what);
        }
    }

    fn halve(&mut self) {
        let joined = |pair: &[Bin]| {
            let mut bin = pair.first().cloned().unwrap_or_default();
            pair.iter().skip(1).for_each(|other| bin.join(other));
            bin
        };
        self.bins = self.bins.chunks(2).map(joined).collect();
        self.bin_ticks *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_is_kept_however_long_it_takes() {
        let mut series = Series::default();
        for tick in (0..1_000_000_000).step_by(100_000) {
            let error_mm = if tick == 700_000_000 { 2.0 } else { 0.1 };
            series.add(tick, &Bin { error_mm, tensions_n: vec![[30.0, 50.0]], forces_n: vec![1.0], ..Bin::default() });
        }
        assert!(series.bins.len() <= MOST);
        let worst = series.bins.iter().position(|bin| bin.error_mm > 1.0).unwrap_or_default();
        assert_eq!(worst as u64, 700_000_000 / series.bin_ticks);
        assert!(series.bins.iter().all(|bin| bin.tensions_n == [[30.0, 50.0]]));
    }
}
