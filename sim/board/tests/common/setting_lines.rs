//! A line for each setting that a line sets; those of plain settings follow from their rows (`plain_lines`).

/// Lines that set a setting with rules of its own, by the end of its path. A letter in braces is the axis.
pub const LINES: [(&str, &str); 13] = [
    ("advance.time", "M900 K.1"),
    ("advance.window", "M572 W.05"),
    ("current_ma", "M906 {}700"),
    ("hybrid_threshold", "M913 {}50"),
    ("mesh.fade", "M420 Z5"),
    ("minimum_cruise_ratio", "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=.3"),
    ("damping", "M593 {} D.05"),
    ("frequency", "M593 {} F44"),
    ("kind", "M593 {} T1"),
    ("soft_endstops", "M211 S0"),
    ("stall_threshold", "M914 {}9"),
    ("stealth", "M569 S1 {}"),
    ("z_offset", "SET_GCODE_OFFSET Z=-.05"),
];
