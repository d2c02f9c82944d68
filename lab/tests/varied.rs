//! A number of the machine is varied on the command line.

use super::{ask, complaint, file, json, near};
use serde_json::Value;

#[test]
fn a_number_is_varied() {
    let swept = json("sweep --vary belt_EA_N=20000:60000:3");
    let rows = swept["rows"].as_array().unwrap();
    assert!(rows.len() == 3 && near(&rows[2]["Kxx_N_per_mm"], 3.0 * rows[0]["Kxx_N_per_mm"].as_f64().unwrap(), 1e-9));
    let gcode = file("swept.gcode", "G1 X120 F9000\nG1 Y120\nM400\n");
    let words = format!("sweep {} --vary head_mass_kg=0.4:0.8:2 --assume-homed 100,100,0", gcode.display());
    let played = json(&words);
    let [light, heavy] = [0, 1].map(|i| played["rows"][i]["contour_max_mm"].as_f64().unwrap());
    assert!(light < heavy, "{played}");
    assert!(complaint("sweep --vary belt_EA=1:2:3").contains("belt_EA_N"));
    assert_eq!(ask("sweep --vary belt_EA_N=1:2").status.code(), Some(2));
    // The page of one number, of another machine too; a study names its machines in its file.
    let page = file("swept.html", "");
    json(&format!("sweep --vary belt_EA_N=20000:60000:3 --routing corexy --report {}", page.display()));
    let text = std::fs::read_to_string(&page).unwrap();
    let data = text.split_once("const D = ").unwrap().1.split_once(";\n").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    let values: Vec<_> = data["points"].as_array().unwrap().iter().map(|point| point["values"][0].clone()).collect();
    assert_eq!((&data["file"], &data["machines"][0]), (&Value::from("belt_EA_N"), &Value::from("CoreXY")), "{data}");
    assert_eq!(values, [20_000.0, 40_000.0, 60_000.0].map(Value::from));
    let study = file(
        "swept.toml",
        "compute = [\"stiffness\"]\nmethod = \"grid\"\n[vary]\nbelt_EA_N = { from = 1, to = 2, count = 2 }\n",
    );
    let words = format!("sweep {} --routing corexy --report {}", study.display(), page.display());
    assert!(complaint(&words).contains("needs an output"));
}

/// Reproducer: they told errors of 0 for a file that does not move.
#[test]
fn a_file_that_does_not_move_is_refused() {
    let still = file("still.gcode", "; nothing moves\nM115\n");
    for words in ["compare", "sweep --vary belt_EA_N=20000:56000:2"] {
        let told = complaint(&format!("{words} {}", still.display()));
        assert!(told.contains("still.gcode: no motor steps in it"), "{words}: {told}");
    }
}

/// Reproducer: a page's folder that does not exist was told after the computation. The file to compute is missing
/// too, so the first complaint shows the order.
#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_computation() {
    let page = "--report nofolder/r.html";
    for words in [
        format!("compare nothing.gcode {page}"),
        format!("sweep --vary belt_EA_N=20000:56000:2 nothing.gcode {page}"),
        "compensate nothing.gcode -o nofolder/c.gcode".to_owned(),
        "flow nothing.gcode --json nofolder/f.json".to_owned(),
        "yin --figure 5 --svg nofolder/y.svg".to_owned(),
        "parts --svg nofolder/p.svg".to_owned(),
    ] {
        let told = complaint(&words);
        assert!(told.contains("cannot create nofolder/") && !told.contains("nothing.gcode"), "{words}: {told}");
    }
}
