//! Units: keys and names of figures end with them.

/// The ends of names, and their units as text. Where several match, the longest is meant: `Nm_s` ends with `s`.
const ENDS: [(&str, &str); 22] = [
    ("kg", "kg"),
    ("N", "N"),
    ("s", "s"),
    ("A", "A"),
    ("V", "V"),
    ("Hz", "Hz"),
    ("mm", "mm"),
    ("um", "um"),
    ("mH", "mH"),
    ("ohm", "ohm"),
    ("percent", "%"),
    ("Nm", "N m"),
    ("mNm", "mN m"),
    ("Nm_s", "N m s"),
    ("kg_m2", "kg m2"),
    ("mm_s", "mm/s"),
    ("mm_s2", "mm/s2"),
    ("kg_per_m", "kg/m"),
    ("N_per_mm", "N/mm"),
    ("N_s_per_m", "N s/m"),
    ("Nm_per_rad", "N m/rad"),
    ("um_per_m_s2", "um per m/s2"),
];

/// A key or a figure's name in two: `belt_EA_N` is `belt_EA` in N. A name without a unit is a count or a ratio, and its
/// unit is empty.
#[must_use]
pub fn split_unit(name: &str) -> (&str, &'static str) {
    let ends = ENDS.iter().filter_map(|(end, unit)| Some((name.strip_suffix(end)?.strip_suffix('_')?, *unit)));
    ends.min_by_key(|(rest, _)| rest.len()).unwrap_or((name, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_end_is_the_unit() {
        assert_eq!(split_unit("belt_EA_N"), ("belt_EA", "N"));
        assert_eq!(split_unit("rotor_damping_Nm_s"), ("rotor_damping", "N m s"));
        assert_eq!(split_unit("x_ringing_acceleration_mm_s2"), ("x_ringing_acceleration", "mm/s2"));
        assert_eq!(split_unit("yaw_error_um_per_m_s2"), ("yaw_error", "um per m/s2"));
        assert_eq!(split_unit("pole_pairs"), ("pole_pairs", ""));
        assert_eq!(split_unit("slips"), ("slips", ""));
    }
}
