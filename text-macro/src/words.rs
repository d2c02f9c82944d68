//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.

/// Bytes of these texts.
#[cfg(test)]
pub const PLAIN: usize = 22778;

/// Bytes of the packed texts and of the words.
#[cfg(test)]
pub const PACKED: usize = 11951;

/// The words by their numbers, the frequent ones first.
#[rustfmt::skip]
pub const WORDS: [&str; 288] = [
    "echo:", "s ", ", ", ": ", "e ", "ed", "er", "in", "t ", "", "", " the ", "it", "or", " is ", "an", "a ", "re",
    " and ", " its ", "the ", " of ", "st", "es", "ed ", "no ", "; ", "not ", " mm", "end", " (", "heater",
    "motor ", " ignored: ", ", or ", "belt", " or ", " to ", "power", "motor", " by ", "hom", "mov", "probe",
    " has ", " has no ", "check", "machine", "sensor", "sensor ", "too ", "driver", "low", " mm/s", "switch",
    " again", " for ", " off", "all", "one", "s are ", "that", "the", " motors ", "align", "homing", "hot", "other",
    "plug", "set", "than ", "this ", " at ", " was ", " with ", "ettings ", "ignored", "mesh", "pause", "supply",
    "wire", " does not ", ". Check", "ach", "out", "set ", "them", "with", " lin", " one ", " turn", "are ",
    "cannot ", "con", "echo:line ignored: ", "ed by ", "ing ", "moves ", "off", "strain", "tion", " are ", " it ",
    " measur", "G29", "ard", "does not ", "of the ", "print ", "read", "reset", "steps", "warm", "(G28)", "(M915",
    "0000", "Belt: ", "cold", "configur", "differ", "echo:ignored: ", "first", "stays ", "the probe ", "which",
    " from ", " times ", "chang", "each ", "endstop", "load", "long", "number", "reading", "screw", "skip",
    "the same ", "this firmware ", " if it ", " ignored: there is no ", " mod", " up to ", ", then", "M303 ",
    "M306 ", "another ", "before ", "configured, ignored", "curren", "filamen", "firmwar", "give ", "jump",
    "microsteps ", "names", "plac", "takes ", "target", "their ", "tool ", "without ", " fail", " needs ",
    " steps ", "M422", "M500", "PID Autotune failed! ", "above ", "accelerometer", "axis ", "belt motors ", "board",
    "cable", "did not ", "echo:arc ignored: ", "measur", "not stored: ", "omet", "parked", "points", "robe ",
    "second ", "there is ", "time", "touch", "valid ", "value", "within ", " after ", " alone", " is out of range",
    " until", " would ", ". Check that ", "Driver ", "and its wire", "at most", "cancel", "connect", "damaged",
    "echo:Fade ", "echo:Mesh not stored: ", "echo:print held: ", "effect ", "electrical turn", "elf-test ",
    "failed, ", "heating ", "height ", "its model", "mechanism", "nothing ", "phase of ", "prompt_", "storage ",
    "the next ", "the tool", "then send M24", "trigger", " action:", " has no connector ",
    " is outside its legal range", " measure the supply", "(M915 aligns)", "(thermistor)", ", M303 E# U1 finds ",
    ", expected at Z", ",accel_", "Leveling ", "PID Autotune ", "cannot touch at X", "chamber", "command", "curacy",
    "draugh", "echo:Cold extrudes are ", "echo:STEPPER_BUZZ", "echo:Stored mesh", "echo:stored settings ", "firmly",
    "has skipped", "interrup", "left ou", "machine allows ", "see that ", "see that sensor and heater sit firmly",
    "something drag", "stands still", "temperature ", "unknown", " Invalid extruder", " has its own current, ",
    " ignored: a print is under way", " is not supported by this firmware", " mm between screw",
    "\" is not a name with = and a number", "(a roller, a pulley", "); see that all turn freely, then M915",
    ". Lower SWEEPING_ACCEL", "; if all is well, M303 E# U1 finds its model", "Linear Advance ",
    "M108 ends this wait", "a motor has skipped meanwhile", "a short circuit", "align the belt motors first (M915)",
    "check how the sensor sits", "check its UART wire", "check which plug is wh", "echo:BLTouch HS mode ",
    "echo:M106 ignored: there is no fan ", "echo:Power-loss recovery OFF", "echo:heating is refused, ",
    "echo:the print was ended: ", "homed. Home them", "hotter than it may ", "if a motor of a belt fails, ",
    "of at most 24 characters", "sensor or heater loose?", "stealthChop", "storage does not keep written data",
    "switched itself off: ", "texts call each other more than 3 deep", "than the firmware wrote",
    "the loads that the drivers measure do not ", "the probe did not trigger down to Z",
    "the sensor's kind (thermistor)", "thermal runaway, ", "while switched off",
];
