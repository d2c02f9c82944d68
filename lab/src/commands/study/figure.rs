//! Figures: the columns of each query, and the direction in which they are worse.

/// A column: its name with its unit, and whether more or less is worse.
#[derive(Clone, Copy)]
pub(super) struct Figure {
    /// Its name with its unit.
    pub name: &'static str,
    worse: Worse,
}

/// Which of two figures is the worse one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Worse {
    Lesser,
    Greater,
    /// The one farther from 0.
    Farther,
}

const fn lesser(name: &'static str) -> Figure {
    Figure { name, worse: Worse::Lesser }
}

const fn greater(name: &'static str) -> Figure {
    Figure { name, worse: Worse::Greater }
}

const fn farther(name: &'static str) -> Figure {
    Figure { name, worse: Worse::Farther }
}

pub(super) const STIFFNESS: &[Figure] =
    &[lesser("Kxx_N_per_mm"), lesser("Kyy_N_per_mm"), farther("Kxy_N_per_mm"), lesser("softest_N_per_mm")];
pub(super) const MODES: &[Figure] = &[lesser("mode_1_Hz"), lesser("mode_2_Hz")];
pub(super) const PUSH: &[Figure] = &[farther("push_dx_mm"), farther("push_dy_mm"), greater("push_torque_max_mNm")];
pub(super) const LIMITS: &[Figure] = &[
    lesser("x_torque_acceleration_mm_s2"),
    lesser("x_slack_acceleration_mm_s2"),
    lesser("x_ringing_acceleration_mm_s2"),
    lesser("x_speed_jump_mm_s"),
    lesser("x_slip_jump_mm_s"),
    lesser("y_torque_acceleration_mm_s2"),
    lesser("y_slack_acceleration_mm_s2"),
    lesser("y_ringing_acceleration_mm_s2"),
    lesser("y_speed_jump_mm_s"),
    lesser("y_slip_jump_mm_s"),
    greater("yaw_error_um_per_m_s2"),
];
pub(super) const RESONANCE: &[Figure] = &[
    lesser("x_lowest_Hz"),
    greater("x_highest_Hz"),
    greater("x_coupling"),
    lesser("x_damping_ratio"),
    greater("x_shaper_residual"),
    lesser("y_lowest_Hz"),
    greater("y_highest_Hz"),
    greater("y_coupling"),
    lesser("y_damping_ratio"),
    greater("y_shaper_residual"),
];
pub(super) const RUN: &[Figure] = &[
    greater("contour_max_mm"),
    greater("contour_rms_mm"),
    greater("torque_max_mNm"),
    lesser("torque_margin"),
    greater("slips"),
    lesser("tension_min_N"),
];

impl Figure {
    /// The worse one of two; NaN does not count as a figure.
    pub(super) fn worse(&self, a: f64, b: f64) -> f64 {
        match self.worse {
            Worse::Lesser => a.min(b),
            Worse::Greater => a.max(b),
            Worse::Farther if a.is_nan() || b.abs() > a.abs() => b,
            Worse::Farther => a,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_figure_yet_is_never_the_worse_one() {
        let of = |figure: Figure| [figure.worse(f64::NAN, -3.0), figure.worse(-3.0, 2.0), figure.worse(2.0, -3.0)];
        assert_eq!(of(lesser("stiffness")), [-3.0, -3.0, -3.0]);
        assert_eq!(of(greater("error")), [-3.0, 2.0, 2.0]);
        assert_eq!(of(farther("coupling")), [-3.0, -3.0, -3.0]);
    }

    #[test]
    fn no_two_columns_have_one_name() {
        let mut names: Vec<&str> =
            [STIFFNESS, MODES, PUSH, LIMITS, RESONANCE, RUN].concat().iter().map(|figure| figure.name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
