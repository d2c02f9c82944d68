//! Parameters are found from measurements.

use super::{complaint, file, json, near, twin};
use serde_json::Value;
use std::path::Path;

#[test]
fn belts_and_motors_are_found_from_frequencies() {
    // The model's own numbers must follow from the model's own ringing, given to a hundredth of a hertz.
    let rung = [[235.0, 235.0], [60.0, 50.0]].map(|[x, y]| {
        let modes = json(&format!("modes --model rotors --at {x},{y}"));
        let hz = |i: usize| modes["frequencies_Hz"][i].as_f64().unwrap();
        format!("--measured {x},{y},{:.2},{:.2}", hz(1), hz(0))
    });
    let found = json(&format!("fit {}", rung.join(" ")));
    assert!(near(&found["belt_EA_N"], 30_000.0, 0.01) && near(&found["holding_torque_Nm"], 0.4, 0.02), "{found}");
    assert!(near(&found["x"]["frequency_Hz"], 101.4, 1e-3) && near(&found["y"]["span_mm"], 862.2, 1e-9), "{found}");
    let one = json("fit --measured 235,235,101.4,57.6");
    assert!(one["x"].is_null() && one["belt_EA_N"].as_f64().unwrap() > 0.0, "{one}");
    // Where x and y are swapped, or a harmonic was read, no machine rings like that.
    for words in ["fit --measured 235,235,57.6,101.4", "fit --measured 235,235,101.4,57.6 --measured 60,50,215.6,61.9"]
    {
        let told = complaint(words);
        assert!(told.contains("no belt and motors ring like this") && told.contains("measure it again"), "{told}");
    }
    assert!(complaint("fit --measured 235,235,100,-").contains("two frequencies"));
    assert!(complaint("fit --measured 5,5,100,60").contains("outside"));
}

#[test]
fn what_an_owner_measured_becomes_a_file_of_parameters() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/twin/measured.toml");
    let found = json(&format!("fit {}", example.display()));
    for (key, value) in [("belt_EA_N", 30_000.0), ("preload_N", 40.0), ("holding_torque_Nm", 0.4)] {
        assert!(near(&found["params"][key], value, 0.003), "{found}");
    }
    assert_eq!(found["estimates"].as_array().unwrap().len(), 6);
    assert_eq!(found["measurements"].as_array().unwrap().len(), 9);
    // It prints a file of parameters.
    let printed = String::from_utf8(twin(&format!("fit {}", example.display())).stdout).unwrap();
    let params = file("fitted.toml", &printed);
    let modes = json(&format!("modes --model rotors --machine {}", params.display()));
    assert!(near(&modes["frequencies_Hz"][0], 57.6, 2e-3) && near(&modes["frequencies_Hz"][1], 101.4, 2e-3), "{modes}");
    // An unweighed belt makes the tension as uncertain as its weight.
    let text = std::fs::read_to_string(&example).unwrap();
    let unweighed = file("unweighed.toml", &text.replace("belt_kg_per_m", "# "));
    let uncertainty = |found: &Value| found["estimates"][1]["uncertainty"].as_f64().unwrap();
    assert_eq!(found["estimates"][1]["parameter"], "preload_N");
    let unweighed = json(&format!("fit {}", unweighed.display()));
    assert!((uncertainty(&found) - 0.0445).abs() < 5e-4 && (uncertainty(&unweighed) - 0.1065).abs() < 5e-4, "{found}");
    assert_eq!(unweighed["not_told"][0]["parameter"], "belt_kg_per_m");
    // Numbers that are not sought go through.
    let other = file("wide.toml", "[twin]\nwidth_mm = 480\n");
    let kept = twin(&format!("fit {} --machine {}", example.display(), other.display()));
    assert!(String::from_utf8(kept.stdout).unwrap().contains("width_mm = 480"));
}

/// Reproducer: one pluck alone contradicts nothing, so a harmonic became four times the tension without a word.
#[test]
fn a_pluck_that_is_an_octave_off_is_named() {
    let example = std::fs::read_to_string("../examples/twin/measured.toml").unwrap();
    assert!(example.contains("frequency_Hz = 74.4"));
    let second = "[[pluck]]\nlength_mm = 380\nfrequency_Hz = 74.0\n";
    for (own, more, doubt) in [
        ("148.8", "", Some("an octave high: is it a harmonic?")),
        ("37.2", "", Some("an octave low: was half of the pitch read?")),
        ("74.4", "", None),
        ("90", second, None),
    ] {
        let text = example.replace("frequency_Hz = 74.4", &format!("frequency_Hz = {own}")) + more;
        let path = file("octave.toml", &text);
        let output = twin(&format!("fit {}", path.display()));
        let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        match doubt {
            Some(doubt) => assert!(said.contains(doubt) && said.contains("# pluck in line 9"), "{own}: {said}"),
            None => assert!(!said.contains("octave"), "{own}: {said}"),
        }
    }
}

#[test]
fn measurements_that_do_not_do_are_told_in_one_line() {
    let ring = "[[ring]]\nat = [195, 208.8]\nx_Hz = 101\n";
    let weights = "[[weight]]\nof = \"head\"\nmass_kg = 0.6\n[[weight]]\nof = \"bar\"\nmass_kg = 1.2\n";
    let bad = [
        (format!("{ring}{ring}"), "do not determine belt_EA_N and head_mass_kg"),
        ("belt_uncertainty_percent = 5\n".to_owned(), "line 1: belt_uncertainty_percent is one of belt_kg_per_m"),
        (String::new(), "nothing was measured"),
        (ring.replace("101", "0"), "line 3: x_Hz = 0 is outside 1 to 5000"),
        (ring.replace("x_Hz", "xHz"), "line 3: unknown field `xHz`"),
        (ring.replace("195", "1950"), "line 2: at = [1950, 208.8] is outside the reach"),
        ("[[ring]]\nat = [195, 208.8]\n".to_owned(), "line 2: expected x_Hz or y_Hz"),
        ("[[slip]]\nforce_N = 4\n".to_owned(), "line 1: missing field `lever_mm`"),
        ("[[pluck]]\nlength_mm = 380\nfrequency_Hz = 74\nbelt = 2\n".to_owned(), "line 4: belt = 2 is not one of"),
        ("[[skew]]\nat = [195, 208.8]\nmrad = 80\n".to_owned(), "line 3: mrad = 80 is outside -50 to 50"),
        ("[[skew]]\nat = [195, 208.8]\nmrad = 1\n".to_owned(), "line 3: a CoreH-bot has no belts that turn its bar"),
        ("[[weight]]\nof = \"gantry\"\nmass_kg = 2\n".to_owned(), "line 3: a CoreH-bot has no gantry"),
        ("[[weight]]\nof = \"bed\"\nmass_kg = 2\n".to_owned(), "line 3: a CoreH-bot has no bed"),
        ("[[resonance]]\nat = [195, 208.8]\nfile = \"no.json\"\n".to_owned(), "cannot open "),
        (
            format!("{ring}{}{weights}", ring.replace("101", "202")),
            "no machine measures like this: of ring x_Hz in line 6",
        ),
    ];
    for (text, word) in bad {
        let path = file("unfit.toml", &text);
        let told = complaint(&format!("fit {}", path.display()));
        assert!(told.contains("unfit.toml") && told.contains(word), "{told}");
    }
    assert_eq!(twin("fit").status.code(), Some(2));
}

/// A CoreXY with belts of its own: tables for each belt, a recorded resonance, skew, and what to measure next.
#[test]
fn a_machine_of_two_belts_is_fitted_from_all_kinds_of_measurements() {
    let machine =
        file("unlike.toml", "[twin]\nbelt_EA_N = [36000, 27000]\npreload_N = [50, 40]\nhead_mass_kg = 0.45\n");
    let modes = json(&format!("modes --model rotors --yaw --routing corexy --machine {}", machine.display()));
    let of = |axis: &str| {
        let place = modes["of"].as_array().unwrap().iter().position(|of| of == axis).unwrap();
        modes["frequencies_Hz"][place].as_f64().unwrap()
    };
    let stiffness = json(&format!("stiffness --model rotors --yaw --routing corexy --machine {}", machine.display()));
    let [xx, xy, yy] = ["Kxx", "Kxy", "Kyy"].map(|k| stiffness[format!("{k}_N_per_mm")].as_f64().unwrap());
    let push = |[x, y]: [f64; 2]| [yy * x - xy * y, xx * y - xy * x].map(|moved| moved / (xx * yy - xy * xy));
    let [a, b] = [push([14.1421, -14.1421]), push([14.1421, 14.1421])];
    let [a, b] = [(a[0] - a[1]) * 0.5_f64.sqrt(), (b[0] + b[1]) * 0.5_f64.sqrt()];
    let mode = |hz: f64| {
        format!("{{\"frequency_Hz\": {hz}, \"frequency_error_Hz\": 0.1, \"damping_ratio\": 0.05, \"part\": 0.9}}")
    };
    let axis = |letter: &str, hz: f64| {
        format!("{{\"axis\": \"{letter}\", \"recordings\": [{{\"fit\": {{\"modes\": [{}]}}}}]}}", mode(hz))
    };
    let recorded = file("recorded.json", &format!("{{\"axes\": [{}, {}]}}", axis("X", of("x")), axis("Y", of("y"))));
    let text = format!(
        "frame = \"motor1\"\nbelt_kg_per_m = 0.0125\n[[weight]]\nof = \"head\"\nmass_kg = 0.45\n[[pluck]]\nbelt = 1\n\
        length_mm = 380\nfrequency_Hz = 83.2\n[[push]]\nat = [235, 235]\nforce_N = 20\na_mm = {a:.4}\nb_mm = {b:.4}\n\
        uncertainty_percent = 1\n[[resonance]]\nat = [235, 235]\nfile = \"{}\"\n[[shaper]]\nat = [235, 235]\nx_Hz = {:.1}\n\
        [[slip]]\nlever_mm = 100\nforce_N = 4\n",
        recorded.display(),
        of("x")
    );
    let measured = file("two-belts.toml", &text);
    let found = json(&format!("fit {} --routing corexy", measured.display()));
    for (belt, value) in [36_000.0, 27_000.0].into_iter().enumerate() {
        assert!(near(&found["params"]["belt_EA_N"][belt], value, 0.03), "{found}");
        assert!((found["estimates"][belt]["uncertainty"].as_f64().unwrap() < 0.05), "{found}");
    }
    assert!(found["estimates"][0]["from"][0].as_str().unwrap().starts_with("push"), "{found}");
    assert!(near(&found["params"]["head_mass_kg"], 0.45, 0.01), "{found}");
    assert!(found["further"][0]["improves"][0]["then"].as_f64().unwrap() < 0.6, "{found}");
    let printed = String::from_utf8(twin(&format!("fit {} --routing corexy", measured.display())).stdout).unwrap();
    for word in ["belt_EA_N = [", "belt 1, +- ", "resonance y_Hz in line", "What would help most now: "] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
    // The table can be read again.
    let fitted = file("two-fitted.toml", &printed);
    let again = json(&format!("stiffness --routing corexy --machine {}", fitted.display()));
    assert!(again["Kxy_N_per_mm"].as_f64().unwrap().abs() > 5.0, "{again}");
    // A head of 30 kg alone is not contradicted by anything, but it is told.
    let heavy = file("heavy.toml", "[[weight]]\nof = \"head\"\nmass_kg = 30\n");
    let printed = String::from_utf8(twin(&format!("fit {}", heavy.display())).stdout).unwrap();
    assert!(printed.contains("times from the nominal 0.6: are the units right?"), "{printed}");
}

/// Places are at half the height where belts lift the tool.
#[test]
fn every_example_machine_is_fitted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines");
    let text = "[[weight]]\nof = \"head\"\nmass_kg = 0.6\n[[push]]\nat = [90, 90]\nforce_N = 20\nx_mm = 0.1\n";
    let measured = file("any.toml", text);
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let settings = path.display();
        let found = json(&format!("fit {} --machine {settings}", measured.display()));
        assert!(near(&found["params"]["head_mass_kg"], 0.6, 0.02), "{settings}: {found}");
        let modes = json(&format!("modes --model rotors --at 90,90 --gcode-frame --machine {settings}"));
        let of = |axis: &str| {
            let place = modes["of"].as_array().unwrap().iter().position(|of| of == axis).unwrap();
            modes["frequencies_Hz"][place].as_f64().unwrap()
        };
        let words = format!("fit --measured 90,90,{:.3},{:.3} --gcode-frame --machine {settings}", of("x"), of("y"));
        let found = json(&words);
        assert!(found["worst_difference"].as_f64().unwrap() < 0.01, "{settings}: {found}");
        count += 1;
    }
    assert!(count > 10, "{count}");
}

/// The table names a routing where the motors' rows say another, or where the command line does.
#[test]
fn the_table_names_the_routing_that_rows_do_not_give() {
    let printed = |words: &str| {
        let output = twin(&format!("fit {words}"));
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let head = file("one-head.toml", "[[weight]]\nof = \"head\"\nmass_kg = 0.6\n");
    let head = head.display();
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines");
    let [hbot, corexy] = ["hbot.toml", "corexy.toml"].map(|name| machines.join(name));
    let hbot = printed(&format!("{head} --machine {}", hbot.display()));
    assert!(hbot.starts_with("# Replaces the table [twin]") && hbot.contains("[twin]\nrouting = \"hbot\"\n"), "{hbot}");
    let corexy = printed(&format!("{head} --machine {}", corexy.display()));
    assert!(!corexy.contains("routing = "), "{corexy}");
    let named = printed(&format!("{head} --routing corexy"));
    assert!(named.contains("[twin]\nrouting = \"corexy\"\n"), "{named}");
}

/// A fixed inertia does not follow the bar's mass, and is printed; what no measurement changed is not.
#[test]
fn the_table_has_fixed_numbers_and_leaves_unchanged_ones_out() {
    let bar = "[[weight]]\nof = \"bar\"\nmass_kg = 2.4\n[[weight]]\nof = \"head\"\nmass_kg = 0.6\n";
    let fixed = file("fixed.toml", &format!("fixed = [\"bar_yaw_inertia_kg_m2\", \"preload_N\"]\n{bar}"));
    let output = twin(&format!("fit {}", fixed.display()));
    let printed = String::from_utf8(output.stdout).unwrap();
    // A slender bar of 1.2 kg and 470 mm: m L^2 / 12.
    assert!(printed.contains("bar_yaw_inertia_kg_m2 = 0.02209"), "{printed}");
    assert!(printed.contains("preload_N = 40  # fixed, taken as exact"), "{printed}");
    assert!(!printed.contains("belt_EA_N = "), "{printed}");
    let found = json(&format!("fit {}", fixed.display()));
    assert!(near(&found["params"]["bar_yaw_inertia_kg_m2"], 1.2 * 0.47 * 0.47 / 12.0, 1e-6), "{found}");
    // Units, and what nothing depends on.
    assert_eq!(found["estimates"][0]["unit"], "kg");
    let unasked = found["unasked"].as_array().unwrap();
    assert!(unasked.iter().any(|number| number["parameter"] == "belt_EA_N"), "{found}");
    // A number that is hardly determined names where it comes from, too.
    let ring = "[[ring]]\nat = [195, 208.8]\nx_Hz = 90\n[[weight]]\nof = \"head\"\nmass_kg = 0.6\n";
    let printed = String::from_utf8(twin(&format!("fit {}", file("slow.toml", ring).display())).stdout).unwrap();
    let torque = printed.lines().find(|line| line.starts_with("holding_torque_Nm")).unwrap();
    assert!(torque.contains("not told") && torque.contains("ring x_Hz in line 3"), "{printed}");
}

/// Of several recordings the entry names the one of its place.
#[test]
fn several_recordings_of_an_axis_need_a_name() {
    let recording = |name: &str, hz: f64| {
        format!("{{\"file\": \"{name}\", \"fit\": {{\"modes\": [{{\"frequency_Hz\": {hz}, \"part\": 0.9}}]}}}}")
    };
    let both = [recording("x1.csv", 101.0), recording("x2.csv", 107.0)].join(", ");
    let recorded = file("twice.json", &format!("{{\"axes\": [{{\"axis\": \"X\", \"recordings\": [{both}]}}]}}"));
    let measured = |name: &str| {
        let text = format!(
            "[[weight]]\nof = \"head\"\nmass_kg = 0.6\n[[resonance]]\nat = [195, 208.8]\nfile = \"{}\"\n{name}",
            recorded.display()
        );
        format!("fit {}", file("twice.toml", &text).display())
    };
    let told = complaint(&measured(""));
    assert!(told.contains("line 6") && told.contains("several recordings of x") && told.contains("x1.csv, x2.csv"));
    assert!(complaint(&measured("recording = \"x3.csv\"\n")).contains("no mode of a recording x3.csv"));
    let found = json(&measured("recording = \"x2.csv\"\n"));
    assert_eq!(found["measurements"].as_array().unwrap().len(), 2);
    assert_eq!(found["measurements"][1]["measured"], 107.0);
}
