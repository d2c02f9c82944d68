//! A page draws the heat of the plant.

use super::{page, scratch};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The prototype with a hotend and a bed.
fn heated() -> PathBuf {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/prototype.toml");
    let text = std::fs::read_to_string(machine).unwrap();
    let (before, chamber) = text.split_once("[heaters.chamber]").unwrap();
    let text = before.replace("is_fitted = false", "is_fitted = true") + "[heaters.chamber]" + chamber;
    let path = scratch("heated.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn heat_is_drawn_as_the_plant_was_heated() {
    let gcode = "M140 S40\nM190 S40\nM109 S210\nG1 X150 E10 F600\nM106 S128\nG1 X100 E10 F600\nM104 S0\nM140 S0\nM107\nG1 X200 F300\n";
    let page = page("heat", gcode, &["--machine", heated().to_str().unwrap()]);
    let heat = &page.data["heat"];
    let (bin_s, end_s) = (heat["bin_s"].as_f64().unwrap(), heat["end_s"].as_f64().unwrap());
    let motion = numbers(&heat["motion"]);
    assert!((1024..=2048).contains(&motion.len()) && ((motion.len() as f64 - 0.5) * bin_s - end_s).abs() < bin_s);
    assert!(
        motion.is_sorted()
            && (motion.last().unwrap() - page.data["summary"]["motion_time_s"].as_f64().unwrap()).abs() < bin_s
    );
    let bin = |s: f64| ((s / bin_s) as usize).min(motion.len() - 1);
    let waits: Vec<_> = heat["waits"]
        .as_array()
        .unwrap()
        .iter()
        .map(|wait| {
            (wait["command"].as_str().unwrap(), [&wait["begin"], &wait["end"]].map(|s| bin(s.as_f64().unwrap())))
        })
        .collect();
    let [("M190 S40", bed_wait), ("M109 S210", hotend_wait)] = waits[..] else { panic!("{waits:?}") };
    // Nothing moves during a wait, and after it the tool does.
    assert_eq!(motion[hotend_wait[1] - 1], 0.0);
    assert!(motion[bin(end_s - 15.0)] > 1.0);
    let heaters = heat["heaters"].as_array().unwrap();
    assert_eq!(heaters.iter().map(|heater| heater["name"].as_str().unwrap()).collect::<Vec<_>>(), ["hotend", "bed"]);
    // Power, heat capacity and losses of the machine file, target, and the wait for it.
    for (heater, watt, joule_per_kelvin, watt_per_kelvin, target, wait) in
        [(&heaters[0], 40.0, 10.8, 0.075, 210.0, hotend_wait), (&heaters[1], 500.0, 1700.0, 3.5, 40.0, bed_wait)]
    {
        let [low, high, targets] = ["low", "high", "target"].map(|key| numbers(&heater[key]));
        let [mean, most] = ["mean", "high"].map(|key| numbers(&heater["duty"][key]));
        assert!([&low, &high, &targets, &mean, &most].iter().all(|list| list.len() == motion.len()));
        assert!(low.iter().zip(&high).all(|(low, high)| low <= high));
        assert!(mean.iter().zip(&most).all(|(mean, most)| (0.0..=100.0).contains(most) && *mean <= *most));
        assert!((low[0] - 25.0).abs() < 1.0, "{}", low[0]);
        assert!(targets[wait[0] + 1..wait[1]].iter().all(|t| *t == target) && targets[targets.len() - 1] == 0.0);
        assert!((low[wait[1]] - target).abs() < 2.0, "{} at the end of the wait", low[wait[1]]);
        // Heat that was put in is stored or lost.
        let until = wait[1];
        let joule: f64 = mean[..until].iter().map(|duty| duty / 100.0 * watt * bin_s).sum();
        let lost: f64 = low[..until].iter().map(|low| (low - 25.0) * watt_per_kelvin * bin_s).sum();
        let warmth = (low[until] - 25.0) * joule_per_kelvin;
        assert!((0.85..1.25).contains(&(joule / (warmth + lost))), "{joule} J for {warmth} and {lost}");
        assert!(most[most.len() - 1] == 0.0 && low[low.len() - 1] < target - 0.2, "it cools at the end");
    }
    let fans = heat["fans"].as_array().unwrap();
    let fan = numbers(&fans[0]["duty"]["mean"]);
    assert_eq!(fans[0]["name"], "fan 0");
    assert!(fan.iter().filter(|duty| (**duty - 50.2).abs() < 0.1).count() as f64 * bin_s > 3.0, "{fan:?}");
    assert_eq!((fan[bed_wait[0]], fan[fan.len() - 1]), (0.0, 0.0));
    assert!(page.bytes() < 400_000, "{}", page.bytes());
}

#[test]
fn a_machine_without_heaters_has_no_heat() {
    let page = page("cold", "M109 S200\nM106 S255\nG1 X110 F6000\n", &[]);
    assert!(page.data["heat"].is_null());
}
