//! Examples in the help of every command, by the words that call it.

/// The words of each command, and what to type for frequent wishes.
pub(crate) const EXAMPLES: [(&str, &[&str]); 14] = [
    ("", &["corehbot-lab yin --figure 4", "corehbot-lab compare print.gcode --report compare.html"]),
    ("push", &["corehbot-lab push --force 5,0"]),
    ("jump", &["corehbot-lab jump --speed 100,0"]),
    ("misalignment", &["corehbot-lab misalignment --off 12=1,0"]),
    ("compare", &["corehbot-lab compare print.gcode --report compare.html"]),
    ("frame", &["corehbot-lab frame"]),
    ("figures", &["corehbot-lab figures drawings"]),
    ("parts", &["corehbot-lab parts --speed 50,200"]),
    ("sweep", &["corehbot-lab sweep study.toml -o samples.csv", "corehbot-lab sweep --vary belt_EA_N=20000:60000:5"]),
    ("compensate", &["corehbot-lab compensate print.gcode -o led.gcode --machine my-machine.toml"]),
    ("flow", &["corehbot-lab flow print.gcode"]),
    ("yin", &["corehbot-lab yin --figure 4"]),
    ("zigzag", &["corehbot-lab zigzag --axis x"]),
    ("level", &["corehbot-lab level --routing corexyz-three"]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command;
    use corehbot_host::examples::faults;

    #[test]
    fn every_command_has_examples_that_it_takes() {
        assert_eq!(faults(&command(), &EXAMPLES), Vec::<String>::new());
    }
}
