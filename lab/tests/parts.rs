//! Reference parts: figures against closed forms, machines and files, what cannot be.

use super::{ask, complaint, file, json, near};
use serde_json::Value;

fn figure(told: &Value, index: usize, part: &str, key: &str) -> f64 {
    told["parts"][index][part][key].as_f64().unwrap()
}

/// On a circle the tool is flung out by a / w^2, a being v^2 / R: by 2 v^2 / (R w^2) the diameter is too large. From 50
/// to 200 mm/s on 40 mm that is 24.3 um along y (62.587 Hz) and 7.8 um along x (110.182 Hz). Chords and steps make the
/// same error at both speeds.
#[test]
fn a_disc_grows_with_the_square_of_the_speed() {
    let told = json("parts --routing corehbot --model reduced --speed 50,200");
    for (key, hz) in [("x_too_large_um", 110.182_f64), ("y_too_large_um", 62.587)] {
        let w = std::f64::consts::TAU * hz;
        let expected = 1000.0 * 2.0 * (200.0_f64.powi(2) - 50.0_f64.powi(2)) / (20.0 * w * w);
        let found = figure(&told, 1, "circle", key) - figure(&told, 0, "circle", key);
        assert!((found / expected - 1.0).abs() < 0.1, "{key}: {found}, expected {expected}");
    }
    for index in [0, 1] {
        // Slow sides are where they should be; after a corner the tool rings outwards and inwards.
        for key in ["x_too_large_um", "y_too_large_um"] {
            assert!(figure(&told, index, "square", key).abs() < 8.0, "{told}");
        }
    }
    // At a corner the tool is braked and goes on outwards, by more than the lag of a steady 3 m/s2 (6 um in x, 19 in
    // y). The bound is twice as much and a jump of 10 mm/s (28 um).
    for index in [0, 1] {
        assert!((6.0..70.0).contains(&figure(&told, index, "square", "corner_outside_um")), "{told}");
        assert!((0.0..70.0).contains(&figure(&told, index, "square", "side_outside_um")), "{told}");
        let worst = told["parts"][index]["worst_dimension_um"].as_f64().unwrap();
        assert!(worst.abs() >= figure(&told, index, "circle", "y_too_large_um").abs() && worst.abs() < 100.0, "{told}");
    }
    // 160 mm at 50 mm/s, and a little for the corners.
    assert!((3.2..3.6).contains(&figure(&told, 0, "square", "time_s")), "{told}");
    // Centripetal acceleration limits a hole of 6 mm to about 95 mm/s.
    assert!(figure(&told, 1, "holes", "time_s") > 9.0 * 18.85 / 110.0, "{told}");
}

#[test]
fn three_machines_are_compared_and_a_file_has_its_own() {
    let text = String::from_utf8(ask("parts --speed 300 --model reduced").stdout).unwrap();
    assert!(["CoreH-bot", "H-bot", "CoreXY", "too large is positive"].iter().all(|word| text.contains(word)), "{text}");
    let picture = file("parts.svg", "");
    let words = "parts --speed 100,300 --model reduced --machine ../examples/machines/corexy.toml";
    let told = json(&format!("{words} --svg {}", picture.display()));
    assert_eq!(told["parts"].as_array().unwrap().len(), 2);
    assert_eq!(told["parts"][0]["machine"], "corexy");
    assert!(near(&told["parts"][1]["speed_mm_s"], 300.0, 1e-9), "{told}");
    let picture = std::fs::read_to_string(picture).unwrap();
    assert!(picture.contains("CoreXY, the second") && !picture.contains("NaN"), "{picture}");
}

/// The drawing in the documents is the command's on its page.
#[test]
fn the_drawing_in_the_documents_is_the_commands() {
    let made = file("twin-parts.svg", "");
    json(&format!("parts --speed 50,100,150,200,250,300 --svg {}", made.display()));
    let kept = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/research/twin-parts.svg");
    if std::env::var_os("BLESS").is_some() {
        std::fs::copy(&made, &kept).unwrap();
    }
    let [made, kept] = [made, kept].map(|path| std::fs::read_to_string(path).unwrap());
    assert!(made == kept && made.len() < 60_000, "the drawing differs from docs/research/twin-parts.svg: BLESS=1");
}

#[test]
fn parts_that_do_not_fit_are_told() {
    assert!(complaint("parts --at 45,100").contains("tool reaches"));
    let small = file("small.toml", "[axes]\nx.length = 30\n");
    assert!(complaint(&format!("parts --machine {}", small.display())).contains("the parts need axes of 42 mm"));
    let told = complaint("parts --routing corexyz --speed 100");
    assert!(told.contains("CoreXYZ needs a machine file with its motors (--machine)"), "{told}");
    assert_eq!(ask("parts --speed 0").status.code(), Some(2));
    assert_eq!(ask("parts --routing nobot").status.code(), Some(2));
}
