//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.

/// Bytes of these texts.
#[cfg(test)]
pub const PLAIN: usize = 22349;

/// Bytes of the packed texts and of the words.
#[cfg(test)]
pub const PACKED: usize = 11785;

/// The words by their numbers, the frequent ones first.
#[rustfmt::skip]
pub const WORDS: [&str; 288] = [
    "echo:", ", ", ": ", "s ", "e ", "in", "ed", "t ", "er", "", "", "or", " the ", "re", " is ", "an", "a ",
    " and ", "the ", "it", "st", " its ", " of ", "no ", "not ", "ed ", "; ", " mm", "es ", " ignored: ", "heater",
    "its ", ", or ", "end", "motor ", "belt", " to ", " or ", " by ", "mov", " has ", " has no ", "power", "probe",
    "sensor", "switch", "too ", "driver", "sensor ", " mm/s", "check", "set ", "the", " again", " for ", "all",
    "one ", "out", "that ", "with ", " motors ", "align", "homing", "one", "this ", " at ", " it ", " was ", "low",
    "measur", "mesh", "motor", "other", "pause", "s are ", "wire", " does not ", " motor", ". Check", "hea", "home",
    "on ", "supply", "them", " are ", " off", " turn", "cannot ", "con", "echo:line ignored: ", "ed by ", "end ",
    "ettings ", "hom", "of the ", "plug", "tool", "G29", "ard", "are ", "does not ", "ignored", "machine",
    "machine ", "off", "print ", "reset", "steps", "strain", "ter ", "than ", "warm", "with", " from ", "(G28)",
    "(M915", "0000", "Belt: ", "cold", "configur", "differ", "echo:ignored: ", "first", "screw", "stays ",
    "the probe ", "which", " moves ", " the same ", "another ", "chang", "each ", "endstop", "load", "long",
    "number", "reading", "skip", "this firmware ", " if it ", " ignored: there is no ", " need", " up to ",
    ", then", "axes", "befor", "configured, ignored", "curren", "filamen", "firmwar", "give ", "jump",
    "microsteps ", "names", "plac", "robe ", "ting ", "without ", " fail", " steps ", "M306 ", "M422", "M500",
    "PID Autotune failed! ", "above ", "accelerometer", "ation", "axis ", "belt motors ", "board", "cable",
    "did not ", "echo:arc ignored: ", "hotend", "lower ", "offset ", "parked", "points", "reach", "second ",
    "their ", "there is ", "thing ", "touch", "valid ", "value", "within ", " after ", " alone", " is out of range",
    " times ", " until", " would ", ". Check that ", "Driver ", "and its wire", "at most", "cancel", "connect",
    "damaged", "echo:Fade ", "echo:Mesh not stored: ", "echo:print held: ", "effect ", "electrical turn",
    "elf-test ", "er than", "failed, ", "height ", "mechanism", "model", "phase of ", "prompt_", "storage ",
    "target ", "the next ", "then send M24", "trigger", "unplug the heater", "while", " action:",
    " has no connector ", " is outside its legal range", " itself off", "(M915 aligns)", "(thermistor)",
    ", M303 E# U1 finds ", ", expected at Z", ",accel_", ": check the motor ", "Leveling ", "PID Autotune ",
    "between", "cannot touch at X", "chamber", "command", "curacy", "draugh", "echo:Cold extrudes are ",
    "echo:STEPPER_BUZZ", "echo:Settings not stored: ", "echo:Stored mesh", "echo:stored settings ", "firmly",
    "has skipped", "interrup", "machine allows ", "something drag", "stands still", "temperature ", "unknown",
    " Invalid extruder", " has its own current, ", " ignored: a print is under way",
    " is not supported by this firmware", " of SG_RESULT", "\" is not a name with = and a number",
    "(a roller, a pulley", "); see that all turn freely, then M915", ". Lower SWEEPING_ACCEL",
    ": a mm of strain takes ", "; if all is well, M303 E# U1 finds its model", "Linear Advance ",
    "M108 ends this wait", "a motor has skipped meanwhile", "a short circuit", "align the belt motors first (M915)",
    "check how the sensor sits", "check its UART wire", "check which plug is wh", "echo:BLTouch HS mode ",
    "echo:M106 ignored: there is no fan ", "echo:Power-loss recovery OFF", "echo:heating is refused, ",
    "echo:the print was ended: ", "homed. Home them", "hotter than it may ", "if a motor of a belt fails, ",
    "needed before moves", "of at most 24 characters", "stealthChop", "storage does not keep written data",
    "texts call each other more than 3 deep", "than the firmware wrote",
    "the loads that the drivers measure do not ", "the probe did not trigger down to Z",
    "the sensor's kind (thermistor)", "thermal runaway, ",
];
