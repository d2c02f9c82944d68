//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.

/// Bytes of these texts.
#[cfg(test)]
pub const PLAIN: usize = 21872;

/// Bytes of the packed texts and of the words.
#[cfg(test)]
pub const PACKED: usize = 11526;

/// The words by their numbers, the frequent ones first.
#[rustfmt::skip]
pub const WORDS: [&str; 288] = [
    "echo:", "s ", ", ", ": ", "ed", "e ", "in", "t ", "er", "", "", " the ", " is ", "or", "it", "an", "re", "a ",
    " and ", " of ", " its ", "st", "the ", "es", "no ", "ed ", "not ", " mm", "; ", " ignored: ", "heater",
    "motor ", ", or ", " to ", "belt", "end", " has ", " or ", "one", "probe", "switch", " by ", " for ", "check",
    "driver", "s are ", " mm/s", "the", " again", " has no ", "all", "are ", "low", "power", "sensor ", " motors ",
    " was ", "align", "homing", "sensor", "this ", "with ", " at ", " lin", "measur", "mesh", "motor", "other",
    "pause", "set ", "that ", " it ", " off", ". Check", "con", "home", "ing ", "off", "out", "than", "them",
    "wire", " does not ", " motor", " turn", "M30", "cannot ", "ed by ", "end ", "ettings ", "hom", "mov", "one ",
    "oth", "read", "strain", "ter ", "tion", "too ", "tool", " mov", "G29", "does not ", "ignored", "machine",
    "machine ", "plug", "print ", "reset", "set", "steps", "supply", "warm", "with", " is too ", "(G28)", "(M915",
    "0000", "Belt: ", "configur", "differ", "echo:ignored: ", "echo:line ignored: ", "first", "hea", "hot",
    "of the ", "on ", "screw", "stays ", "the probe ", "time", "uch", "which", " from", " ignored: there is no ",
    " moves ", " the same ", "another ", "chang", "cold", "each ", "endstop", "load", "long", "number", "skip",
    "this firmware ", " if it ", " need", " up to ", ", then", "befor", "configured, ignored", "connector",
    "curren", "filamen", "firmwar", "give ", "jump", "microsteps ", "names", "plac", "robe ", "without ", " fail",
    " mod", " steps ", "M422", "M500", "PID Autotune failed! ", "above ", "accelerometer", "belt motors ", "board",
    "did not ", "echo:arc ignored: ", "hotend", "reach", "their ", "touch", "value", "within ", " after ", " alone",
    " has no reading", " is out of range", " points", " takes ", " until", " would ", ". Check that ", "Driver ",
    "and its wire", "at most", "cancel", "damaged", "echo:Mesh not stored: ", "echo:print held: ", "effect ",
    "electrical turn", "elf-test ", "failed, ", "heating ", "height ", "mechanism", "model", "phase of ", "prompt_",
    "storage ", "target ", "the next ", "then send M24", "trigger", "unplug the heater", "while", " action:",
    " is outside its legal range", " itself off", "(M915 aligns)", ", M303 E# U1 finds ", ", expected at Z",
    ",accel_", "Leveling ", "PID Autotune ", "between", "cannot touch at X", "chamber", "command", "curacy",
    "d extr", "echo:Cold extrudes are ", "echo:STEPPER_BUZZ", "echo:Settings not stored: ", "echo:Stored mesh",
    "echo:stored settings ", "has skipped", "interrup", "left ou", "more than ", "something drag", "stands still",
    "temperature ", "the machine allows ", "unknown", "valid ", " Invalid extruder", " has its own current, ",
    " ignored: a print is under way", " is not supported by this firmware", " of SG_RESULT",
    "\" is not a name with = and a number", "(a roller, a pulley", "); see that all turn freely, then M915",
    ". Lower SWEEPING_ACCEL", ":0.00 /0.", "; if all is well, M303 E# U1 finds its model", "Linear Advance ",
    "M108 ends this wait", "M524 ends it", "a motor has skipped meanwhile", "a short circuit",
    "align the belt motors first (M915)", "and draugh", "check how the sensor sit", "check its UART wire",
    "check which plug is wh", "echo: Servo 0: ", "echo:BLTouch HS mode ", "echo:Fade Height ",
    "echo:M106 ignored: there is no fan ", "echo:Power-loss recovery OFF", "echo:heating is refused, ",
    "echo:line ignored: there is no axis ", "echo:the print was ended: ", "homed. Home them",
    "if a motor of a belt fails, ", "needed before moves", "of at most 24 characters", "set its power (M306 ",
    "stealthChop", "storage does not keep written data", "texts call each other more than 3 deep",
    "than the firmware wrote", "the loads that the drivers measure do not ", "the probe did not trigger down to Z",
    "the sensor's kind (thermistor)", "with the part fan",
];
