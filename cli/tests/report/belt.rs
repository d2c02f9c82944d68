//! A page draws the torque shares and the residual of the belt plant.

use super::page;

#[test]
fn shares_residual_and_skips_are_drawn_over_motion_time() {
    let accidents = "--plant belt --hit 120,120,180,14 --brake m11,5";
    let gcode = "G1 X150 Y150 F6000\nG4 P300\nG1 X100 Y150\n";
    let page = page("belt", gcode, &accidents.split(' ').collect::<Vec<_>>());
    let (belt, told) = (&page.data["belt"], &page.data["summary"]["belt"]);
    let numbers = |list: &serde_json::Value| -> Vec<f64> {
        list.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
    };
    let (bin_s, residual) = (belt["bin_s"].as_f64().unwrap(), numbers(&belt["residual_um"]));
    let print_time_s = page.data["summary"]["motion_time_s"].as_f64().unwrap();
    assert!((residual.len() as f64 * bin_s - print_time_s).abs() < 2.0 * bin_s);
    let skips = belt["skips"].as_array().unwrap();
    assert!(!skips.is_empty() && skips.len() == told["skips"].as_array().unwrap().len());
    let first = skips.iter().map(|skip| skip["time_s"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
    // Until then only ringing strains the belt; there motors reach the limit of their torque.
    assert!(residual[..(first / bin_s) as usize - 2].iter().all(|um| *um < 100.0), "{residual:?}");
    for (motor, told) in belt["motors"].as_array().unwrap().iter().zip(told["motors"].as_array().unwrap()) {
        let (name, share) = (motor["name"].as_str().unwrap(), numbers(&motor["share"]));
        assert_eq!(name, told["motor"]);
        assert!(share.len() == residual.len() && share.iter().all(|share| (0.0..=100.0).contains(share)));
        let has_skipped = skips.iter().any(|skip| skip["text"].as_str().unwrap().starts_with(&format!("{name} ")));
        let most = share.iter().copied().fold(0.0, f64::max);
        assert!(!has_skipped || most > 99.0, "{name}: {most}");
    }
    // The last bin is of a machine in motion, and rings.
    let last_mm = residual[residual.len() - 1] / 1000.0;
    assert!((last_mm - told["residual_mm"].as_f64().unwrap().abs()).abs() < 0.05, "{last_mm}");
    assert!(page.bytes() < 100_000, "{}", page.bytes());
}

#[test]
fn a_rigid_machine_has_none() {
    assert!(page("rigid", "G1 X110 F6000\n", &[]).data.get("belt").is_none());
}
