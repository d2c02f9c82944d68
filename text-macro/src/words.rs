//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.

/// Bytes of these texts.
#[cfg(test)]
pub const PLAIN: usize = 20669;

/// Bytes of the packed texts and of the words.
#[cfg(test)]
pub const PACKED: usize = 11007;

/// The words by their numbers, the frequent ones first.
#[rustfmt::skip]
pub const WORDS: [&str; 288] = [
    "echo:", "s ", ", ", ": ", "ed", "e ", "in", "er", "t ", "", "", " the ", " is ", "it", "re", "an", "en", "or",
    "a ", "the ", " and ", " of ", " its ", " mm", "ed ", "no ", "not ", "; ", " (", " ignored: ", " to ", " Y",
    ", or ", "heater", "motor ", " has ", "probe", "stor", " by ", " or ", "belt", "check", "driver", " for ",
    " mm/s", "s are ", " again", "are ", "low", "one", "too ", " at ", " has no ", " motors ", " was ", "homing",
    "power", "this ", "all", "mesh", "out", "pause", "sensor", "sensor ", "the", " with ", ". Check", "align",
    "con", "hom", "ing ", "machine", "measur", "par", "set ", "than", "with", " lin", " turn", ", then", "ard",
    "cannot ", "fail", "home", "off", "strain", "that ", "tion", "tool", "M30", "does not ", "hot", "ignored",
    "motor", "mov", "plug", "print ", "read", "reset", "step", "supply", "ter ", " does not ",
    " ignored: there is no ", " it ", " le", " motor", " motor ", " one ", "(G28)", "(M915", "0000", "Belt: ",
    "G29", "belt ", "configur", "differ", "ed by ", "ettings ", "first", "los", "of the ", "other", "own", "switch",
    "ull", "which", "wire", " from", " mov", " off", " steps", " switch", " the same ", "G34", "ali", "and ",
    "another ", "chang", "echo:line ignored: ", "ect", "endstop", "hea", "load", "machine ", "motors ", "number",
    "on ", "one ", "pro", "reach", "screw", "skip", "the probe ", "them", "this firmware ", "warm", " abov", " mod",
    " moves ", " need", " send M24", " up to ", "before ", "connector", "curren", "echo:Settings ", "filamen",
    "firmware", "give ", "jump", "microsteps ", "moves", "names", "stays ", "without ", " ends ", "M422", "M500",
    "PID Autotune failed! ", "accelerometer", "echo:arc ignored: ", "echo:ignored: ", "long", "not stored: ",
    "offset ", "plac", "robe ", "their", "touch", "value", "within ", " after ", " alone", " has no reading",
    " if it ", " is out of range", " points", " takes ", " times ", " until", " what ", " would ", ". Check that ",
    "Driver ", "and its wire", "cancel", "configured, ignored", "damaged", "did not ", "echo:Mesh not stored: ",
    "echo:print held: ", "echo:sweep ignored: ", "electrical turn", "elf-test ", "heating ", "height ",
    "its wire, and ", "mechanism", "of them", "phase of ", "prompt_", "storage ", "target ", "the next ",
    " action:", " is outside its legal range", " itself off", "(M915 aligns)", ", M303 E# U1 finds ",
    ", expected at Z", ",accel_", "Leveling ", "PID Autotune ", "cannot touch at X", "curacy", "d extr",
    "echo:Cold extrudes are ", "echo:STEPPER_BUZZ", "echo:Stored mesh", "echo:stored settings ", "effect ",
    "has skipped", "interrup", "its model", "something drag", "stands still", "temperature ", "the machine allows ",
    "the probe did not trigger ", "trigger", "unplug the heater", " Invalid extruder", " has its own current, ",
    " if it gets hotter", " mm between screw", " of SG_RESULT", "(a roller, a pulley",
    "); see that all turn freely, then M915", ", its switch is stuck", ". G29 measures ", ". Lower SWEEPING_ACCEL",
    ":0.00 /0.", "; no motor got power", "Linear Advance ", "M108 ends this wait", "a motor has skipped meanwhile",
    "a print is under way", "a short circuit", "align the belt motors first (M915)", "check how the sensor sit",
    "check its UART wire", "check which plug is where", "echo: Servo 0: ", "echo:Fade Height ",
    "echo:Invalid mesh. G29 measures one", "echo:Power-loss recovery OFF", "echo:heating is refused, ",
    "echo:the print was ended: ", "homed. Home them", "hotend is too cold", "if a motor of a belt fails, ",
    "its power (M306 ", "stealthChop", "storage does not keep written data", "than the firmware wrote",
    "the loads that the drivers measure do not ", "the sensor's kind (thermistor)",
];
