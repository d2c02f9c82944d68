//! G0 to G3: moves. Room `gcode` reads their words, because most lines are moves; `moves` carries them out.

use super::Entry;

pub(in crate::machine) const ROWS: &[Entry] = &[
    Entry::g("Motion", &[0, 1])
        .does("X Y Z E F, C", "straight move; C runs a closed belt round, with X, Y and F alone")
        .examples(&[
            ("G0 X1 F6000", &[]),
            ("G1 X10 Y20 E.5 F1800", &[]),
            ("G1 F1800", &[]),
            ("G1 E-.8 F2100", &[]),
            ("G1 X110 F0", &["echo:F0 is out of range, stays 3000"]),
            ("G1 X110 F-5", &["echo:F-5 is out of range, stays 3000"]),
            ("G1 X110 F999999", &["echo:F999999 is out of range, set to 180000"]),
            ("G1 X99999999999", &["echo:target out of reach, moved to the edge of the reachable space"]),
            ("G1 Xabc", &["echo:line ignored: X needs a number"]),
            ("G1 X1,5", &["echo:line ignored: \"X1,5\" is not a letter with a number"]),
            ("G1 X1.2.3", &["echo:line ignored: \"X1.2.3\" is not a letter with a number"]),
            ("G1 X10\x01", &["echo:line ignored: \"X10?\" is not a letter with a number"]),
            ("G1 X--5", &["echo:line ignored: \"X--5\" is not a letter with a number"]),
            ("G1 U5", &["echo:line ignored: there is no axis U"]),
            ("G1 C5 Z1", &["echo:line ignored: C goes with X, Y and F alone"]),
            ("G1 X1 C5 F1200", &[]),
        ]),
    Entry::g("Motion", &[2, 3])
        .does(
            "X Y Z E F I J K R P",
            "arc or helix, clockwise or counter-clockwise; centre (I J K) or radius (R); P turns",
        )
        .examples(&[
            ("G2 X110 I5", &[]),
            ("G2 X1", &["echo:arc ignored: *"]),
            ("G3 Z50.76 I.194 J1.201 P1  F30000", &[]),
        ]),
];
