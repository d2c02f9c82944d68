//! Examples in the help of every command, by the words that call it.

/// The words of each command, and what to type for frequent wishes.
pub(crate) const EXAMPLES: [(&str, &[&str]); 26] = [
    ("", &["corehbot run print.gcode --report print.html", "corehbot config from printer.cfg -o my-machine.toml"]),
    (
        "run",
        &[
            "corehbot run print.gcode --machine my-machine.toml --report print.html",
            "corehbot run project.3mf --plate 2",
        ],
    ),
    ("serve", &["corehbot serve --pty /tmp/printer --machine my-machine.toml"]),
    ("bringup", &["corehbot bringup /dev/ttyACM0 --machine my-machine.toml"]),
    ("image", &["corehbot image --board octopus --machine my-machine.toml -o firmware.bin"]),
    ("config", &["corehbot config new --board octopus --kinematics corexy --heaters -o my-machine.toml"]),
    ("config schema", &["corehbot config schema > machine.schema.json"]),
    ("config new", &["corehbot config new --board octopus --kinematics corexy --heaters -o my-machine.toml"]),
    (
        "config from",
        &[
            "corehbot config from printer.cfg --board octopus -o my-machine.toml",
            "corehbot config from m503.txt --board octopus --kinematics corexy -o my-machine.toml",
        ],
    ),
    ("config check", &["corehbot config check my-machine.toml"]),
    ("config send", &["corehbot config send my-machine.toml /dev/ttyACM0"]),
    ("config get", &["corehbot config get /dev/ttyACM0 > board.toml"]),
    ("twin", &["corehbot twin modes --model rotors --machine my-machine.toml"]),
    ("twin geometry", &["corehbot twin geometry --at 235,235"]),
    ("twin stiffness", &["corehbot twin stiffness --at 150,180 --machine my-machine.toml"]),
    ("twin modes", &["corehbot twin modes --model rotors --routing corexy"]),
    ("twin slip", &["corehbot twin slip --motor 1"]),
    ("twin shaper", &["corehbot twin shaper --kind mzv --frequency 66 --ring 62.6"]),
    ("twin tension", &["corehbot twin tension --machine my-machine.toml"]),
    ("twin resonance", &["corehbot twin resonance --report resonance.html"]),
    ("twin ripple", &["corehbot twin ripple --speeds 40-120 --at 100,100"]),
    ("twin limits", &["corehbot twin limits --machine my-machine.toml"]),
    ("twin fit", &["corehbot twin fit measured.toml"]),
    ("twin run", &["corehbot twin run print.gcode --model rotors --report run.html"]),
    ("resonance", &["corehbot resonance raw_data_x.csv raw_data_y.csv --report resonance.html"]),
    ("resonance sweep", &["corehbot resonance sweep --axis x --at 150,150 -o sweep-x.gcode"]),
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
