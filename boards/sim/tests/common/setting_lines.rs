//! A line for each setting that a line sets.

/// Lines that set a setting. A letter in braces is the axis.
pub const LINES: [(&str, &str); 21] = [
    ("advance.time", "M900 K.1"),
    ("advance.window", "M572 W.05"),
    ("current_ma", "M906 {}700"),
    ("extruder_jerk", "M205 E3"),
    ("hybrid_threshold", "M913 {}50"),
    ("keepalive_s", "M113 S9"),
    ("max_acceleration", "M201 {}150"),
    ("max_speed", "M203 {}10"),
    ("min_feed", "M205 S1"),
    ("min_travel", "M205 T1"),
    ("minimum_cruise_ratio", "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=.3"),
    ("print_acceleration", "M204 P900"),
    ("retract_acceleration", "M204 R900"),
    ("damping", "M593 {} D.05"),
    ("frequency", "M593 {} F44"),
    ("kind", "M593 {} T1"),
    ("soft_endstops", "M211 S0"),
    ("stall_threshold", "M914 {}9"),
    ("stealth", "M569 S1 {}"),
    ("steps_per_mm", "M92 {}90"),
    ("travel_acceleration", "M204 T900"),
];
