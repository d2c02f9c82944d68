//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.

/// Bytes of these texts.
#[cfg(test)]
pub const PLAIN: usize = 21115;

/// Bytes of the packed texts and of the words.
#[cfg(test)]
pub const PACKED: usize = 11168;

/// The words by their numbers, the frequent ones first.
#[rustfmt::skip]
pub const WORDS: [&str; 288] = [
    "echo:", "s ", ", ", "ed", ": ", "e ", "in", "er", "t ", "", "", " the ", "an", " is ", "it", "en", "a ", "or",
    " and ", "the ", "th", "re", " of ", "es", " its ", "no ", "not ", " mm", "; ", " (", " to ", " ignored: ",
    "motor ", ", or ", "motor", " or ", "probe", " has ", "heater", "mov", " by ", " motors ", "belt", "check",
    "driver", " for ", " mm/s", "too ", " again", "low", "power", "sensor", "stored", " has no ", " was ", " with ",
    "homing", "one", "out", "sensor ", "this ", " at ", "all", "par", "pause", "set ", "align", "are ", "con",
    "hom", "hot", "ing ", "machine", "measur", "other", "s are ", "that ", "wire", " lin", " mesh", " turn",
    ", then", "cannot ", "ettings ", "fail", "home", "off", "read", "strain", "switch", "tion", "tool", "with",
    " are ", " does not ", " it ", "M30", "does not ", "ignored", "los", "plug", "print ", "reset", "step",
    "supply", "ter ", "the probe ", "warm", " moves ", " off", " one ", " switch", "(G28)", "(M915", "0000",
    "Belt: ", "G29", "axes", "belt ", "configur", "differ", "echo:line ignored: ", "ed by ", "first", "hea", "own",
    "stays ", "ull", "which", " from ", " steps", " the same ", ". Check its ", "G34", "and ", "another ", "ard",
    "cold", "ect", "end ", "endstop", "get ", "heater ", "load", "machine ", "number", "of the ", "on ", "one ",
    "screw", "skip", "them", "this firmware ", "time", " abov", " if it ", " ignored: there is no ", " need",
    " send M24", " up to ", "chang", "connector", "curren", "did not ", "each ", "filamen", "firmwar", "give ",
    "jump", "long", "microsteps ", "names", "plac", "without ", " mod", ". Check", "M422", "PID Autotune failed! ",
    "accelerometer", "before ", "board", "echo:arc ignored: ", "echo:ignored: ", "offset ", "reach", "robe ",
    "their", "there is ", "touch", "trigger", "value", "within ", " after ", " alone", " has no reading",
    " is out of range", " points", " takes ", " until", " would ", ". Check that ", "Driver ", "and its wire",
    "at most", "cancel", "configured, ignored", "damaged", "echo:Mesh not stored: ", "echo:print held: ",
    "echo:sweep ignored: ", "electrical turn", "elf-test ", "heating ", "height ", "mechanism", "model", "of them",
    "phase of ", "prompt_", "storage ", "target ", "the next ", "unplug the heater", "while", " action:",
    " is outside its legal range", " itself off", "(M915 aligns)", ", M303 E# U1 finds ", ", expected at Z",
    ",accel_", "Leveling ", "PID Autotune ", "cannot touch at X", "curacy", "d extr", "echo:Cold extrudes are ",
    "echo:STEPPER_BUZZ ignored: ", "echo:Settings not stored: ", "echo:Stored mesh", "echo:stored settings ",
    "effect ", "has skipped", "interrup", "something drag", "stands still", "temperature ", "the machine allows ",
    "valid ", " Invalid extruder", " SELF_TEST", " has its own current, ", " mm between screw", " of SG_RESULT",
    "(a roller, a pulley", "(thermistor)", "); see that all turn freely, then M915", ". G29 measures ",
    ". Lower SWEEPING_ACCEL", ":0.00 /0.", "; if all is well, M303 E# U1 finds its model", "Linear Advance ",
    "M108 ends this wait", "M500 stores it", "M524 ends it", "a motor has skipped meanwhile",
    "a print is under way", "a short circuit", "align the belt motors first (M915)", "check how the sensor sit",
    "check its UART wire", "check which plug is where", "echo: Servo 0: ", "echo:Fade Height ",
    "echo:Invalid mesh. G29 measures one", "echo:Power-loss recovery OFF", "echo:Settings unchanged: ",
    "echo:heating is refused, ", "echo:the print was ended: ", "homed. Home them", "if a motor of a belt fails, ",
    "its power (M306 ", "needed before moves", "stealthChop", "storage does not keep written data",
    "than the firmware wrote", "the loads that the drivers measure do not ", "the sensor's kind (thermistor)",
];
