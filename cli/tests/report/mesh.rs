//! A page and the JSON have the mesh that z followed, and its effect against the true bed.

use super::{page, scratch};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The prototype with a switch at the nozzle as its probe, by which it homes z.
fn probed() -> PathBuf {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/prototype.toml");
    let text = std::fs::read_to_string(machine).unwrap();
    let text = text.replacen("probe = \"\"", "probe = \"PROBE\"", 1);
    let (before, probe) = text.split_once("[probe]").unwrap();
    let probe = probe.replacen("kind = \"none\"", "kind = \"switch\"", 1);
    let probe = probe.replacen("z_home = false", "z_home = true", 1).replacen("samples = 2", "samples = 1", 1);
    let path = scratch("probed.toml");
    std::fs::write(&path, format!("{before}[probe]{probe}")).unwrap();
    path
}

/// Steps of z a mm, of the prototype.
const Z_STEPS: f64 = 800.0;

/// A bed that rises by a micrometre a mm along x.
const SLOPE: f64 = 0.001;

/// Ways to and fro along x on two layers, and their length in mm.
const WAYS: usize = 8;
const WAY: f64 = 280.0;

/// Measures the bed and prints on it.
fn two_layers(before: &str) -> String {
    let mut gcode = format!("G28\nG29\n{before}G92 E0\nG1 X60 Y200 F6000\n");
    for (layer, z) in [0.2, 0.4].iter().enumerate() {
        writeln!(gcode, "G1 Z{z} F600").unwrap();
        for way in 0..WAYS {
            let (x, e) = (if way % 2 == 0 { 60.0 + WAY } else { 60.0 }, 12 * (layer * WAYS + way + 1));
            writeln!(gcode, "G1 X{x} Y{} E{e} F6000", 200 + way).unwrap();
        }
    }
    gcode
}

fn mm(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_mesh_is_told_with_its_correction_and_its_error_against_the_bed() {
    let (machine, json) = (probed(), scratch("mesh.json"));
    let bed = format!("tilt.x={SLOPE}");
    let args = ["--machine", machine.to_str().unwrap(), "--bed", &bed, "--json", json.to_str().unwrap()];
    let page = page("mesh", &two_layers(""), &args);
    let mesh = &page.data["summary"]["mesh"];
    let told: Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(told["mesh"], *mesh);
    // The points, by the true bed: a plane that is 0 where z is 0.
    let [columns, rows] = ["columns", "rows"].map(|key| mesh[key].as_u64().unwrap() as usize);
    assert_eq!((columns, rows, mesh["fade_height_mm"].as_f64()), (5, 5, Some(10.0)));
    let [first, last] = [0, 1].map(|end| mm(&mesh["x_mm"][end]));
    let zero = (first + last) / 2.0;
    let heights = mesh["heights_mm"].as_array().unwrap();
    assert_eq!(heights.len(), rows);
    for row in heights {
        let row = row.as_array().unwrap();
        assert_eq!(row.len(), columns);
        for (column, height) in row.iter().enumerate() {
            let x = first + (last - first) * column as f64 / (columns - 1) as f64;
            assert!((mm(height) - SLOPE * (x - zero)).abs() < 0.003, "{x}: {height}");
        }
    }
    let rise = SLOPE * (last - first);
    assert!((mm(&mesh["range_mm"]) - rise).abs() < 0.004 && mm(&mesh["mean_mm"]).abs() < 0.003, "{mesh}");
    // z rose by the slope on each way, a little less as it fades, and on the way to the first one.
    let ways = SLOPE * WAY * (2 * WAYS) as f64 * 0.97;
    let steps = mm(&mesh["z_steps_added"]) / Z_STEPS;
    assert!((ways - 0.02..ways + rise + 0.1).contains(&steps), "{steps} mm, for {ways}");
    let most = SLOPE * (60.0 + WAY - zero) * 0.98;
    assert!((mm(&mesh["greatest_correction_mm"]) - most).abs() < 0.004, "{mesh}");
    assert_eq!(mesh["slowed_moves"], 0);
    // Without a mesh the first layer would have been off by the slope along the ways.
    let layer = &mesh["first_layer"];
    let middle = 60.0 + WAY / 2.0 - zero;
    let before = SLOPE * (WAY * WAY / 12.0 + middle * middle).sqrt();
    assert!((mm(&layer["z_mm"]) - 0.2).abs() < 0.002 && (mm(&layer["rms_before_mm"]) - before).abs() < 0.004, "{mesh}");
    assert!(mm(&layer["rms_after_mm"]) < 0.004 && mm(&layer["max_after_mm"]) < 0.007, "{mesh}");
    let error = &mesh["bed_error"];
    assert!((mm(&error["max_before_mm"]) - rise / 2.0).abs() < 0.003 && mm(&error["max_after_mm"]) < 0.003, "{mesh}");
    // On the page the bed is no layer.
    assert_eq!(page.data["heights"], serde_json::json!([0.2, 0.4]));
}

#[test]
fn moves_that_the_mesh_slows_are_counted() {
    let machine = probed();
    let args = ["--machine", machine.to_str().unwrap(), "--bed", "tilt.x=0.008"];
    // On a flat bed z would stand still in the ways; on this one it would need 0.8 mm/s at 100 mm/s. Two moves of z
    // are slower too, because the mesh fades on their way.
    let page = page("slowed", &two_layers("M203 Z0.5\n"), &args);
    assert_eq!(page.data["summary"]["mesh"]["slowed_moves"], 2 * WAYS + 2);
    assert!(mm(&page.data["summary"]["mesh"]["first_layer"]["rms_after_mm"]) < 0.05);
}

#[test]
fn a_print_without_a_mesh_has_none() {
    assert!(page("flat", "G1 X110 F6000\n", &[]).data["summary"].get("mesh").is_none());
    let machine = probed();
    let off = page("off", &two_layers("M420 S0\n"), &["--machine", machine.to_str().unwrap()]);
    // It was on for a moment after G29, without any motion.
    assert_eq!(off.data["summary"]["mesh"]["z_steps_added"], 0);
}
