//! Files that are something else are refused with what they are, and with what is wanted.

use super::{complaint, file};
use std::path::Path;

#[test]
fn a_wrong_input_of_any_option_is_told_with_its_way() {
    let table = file("wrong.csv", "");
    let wrong = [
        (file("printer.cfg", "[printer]\nkinematics: corexy\n[stepper_x]\nstep_pin: PA0\n"), "Klipper's printer.cfg"),
        (file("other.gcode", "G28\nG1 X10 Y10 F6000\n"), "G-code"),
        (Path::new(env!("CARGO_TARGET_TMPDIR")).to_owned(), "a folder"),
    ];
    for (wrong, is) in &wrong {
        for (words, wanted) in [
            (format!("sweep {} -o {}", wrong.display(), table.display()), "a study"),
            (format!("yin --speed 1 --rig {}", wrong.display()), "a file of a rig"),
        ] {
            let told = complaint(&words);
            assert!(told.contains(&format!("this is {is}, not {wanted}")) && !told.contains("os error"), "{told}");
        }
    }
}
