//! `corehbot-lab yin`, `corehbot-lab zigzag` and `corehbot-lab level`: options, files, drawings and refusals.

use super::{ask, complaint, file, json, near};
use std::fs;
use std::path::Path;

/// Largest drawing in the documents, in bytes.
const LARGEST: usize = 60_000;

/// The drawing that these words make is the document's; `BLESS=1` takes it over.
fn drawn(words: &str, kept: &str) {
    let output = ask(words);
    let made = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && made.starts_with("<svg") && made.ends_with("</svg>\n"), "{words}: {made}");
    assert!(made.len() < LARGEST && !made.contains("NaN") && !made.contains("inf"), "{words}: {} bytes", made.len());
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/research").join(kept);
    if std::env::var_os("BLESS").is_some() {
        fs::write(&kept, &made).unwrap();
    }
    assert!(fs::read_to_string(&kept).unwrap() == made, "{} differs: BLESS=1", kept.display());
}

#[test]
fn drawings_in_the_documents_are_what_the_command_makes() {
    for number in [3, 4, 5] {
        drawn(&format!("yin --figure {number} --svg -"), &format!("yin-paper/figure-{number}.svg"));
    }
    drawn("yin --figure 4 --drive dc --svg -", "yin-paper/figure-4-dc.svg");
    drawn("zigzag --svg -", "corexyz-paper/zigzag.svg");
    drawn("zigzag --freedom -", "corexyz-paper/freedom.svg");
    drawn("level --svg -", "corexyz-paper/levelling.svg");
}

#[test]
fn yin_takes_drives_directions_and_rigs() {
    let stepper = json("yin --speed 0.079");
    assert!(near(&stepper["x_to_y_mm"], 0.7669, 2e-3) && stepper.get("largest_voltage_V").is_none(), "{stepper}");
    let filed = json("yin --speed 0.079 --drive stepper --rig ../examples/twin/yin.toml");
    assert!(near(&filed["y_to_x_mm"], stepper["y_to_x_mm"].as_f64().unwrap(), 1e-9), "{filed}");
    let other = json("yin --speed 0.079 --direction counter-clockwise");
    assert!(near(&other["y_to_x_mm"], 0.3063, 2e-3), "{other}");
    let dc = json("yin --speed 0.079 --drive dc");
    assert!(near(&dc["x_to_y_mm"], 0.8281, 1e-3) && near(&dc["largest_voltage_V"], 3.076, 2e-3), "{dc}");
    // A rig of one number, and its motor.
    let light = file("light.toml", "m_x_kg = 0.16\n[motor]\nK_1_N_m_per_V = 0.04\n");
    let [as_is, strong] =
        ["", "--drive dc --gain 50"].map(|w| json(&format!("yin --speed 0.079 --rig {} {w}", light.display())));
    assert!(as_is["x_to_y_mm"].as_f64() < stepper["x_to_y_mm"].as_f64() && strong["x_to_y_mm"].is_number());
    let space = json("yin --state-space");
    assert_eq!((space["A"].as_array().unwrap().len(), &space["inputs"][0]), (20, &serde_json::json!("phi1_rad")));
    assert_eq!(json("yin --state-space --drive dc --model 4dof")["states"].as_array().unwrap().len(), 8);
    let figure = json("yin --figure 5 --drive dc");
    assert_eq!(figure["claims"].as_array().unwrap().len(), 3, "{figure}");
}

#[test]
fn wrong_rigs_and_options_are_refused_in_one_line() {
    for (name, text, told) in [
        ("unknown.toml", "m_x = 1\n", "unknown field `m_x`"),
        ("motor.toml", "[motor]\nK1 = 1\n", "unknown field `K1`"),
        ("four.toml", "k_N_per_m = [1, 2, 3, 4]\n", "line 1"),
        ("negative.toml", "\nm_x_kg = -1\n", "illegal mass"),
        ("nan.toml", "B_p_N_m_s = nan\n", "illegal friction"),
        ("words.toml", "m_x_kg = \"heavy\"\n", "line 1"),
    ] {
        let rig = file(&format!("rig-{name}"), text);
        let complaint = complaint(&format!("yin --speed 0.05 --rig {}", rig.display()));
        assert!(complaint.contains(told), "{complaint}");
    }
    assert!(complaint("yin --speed 0.05 --rig nowhere.toml").contains("cannot open nowhere.toml"));
    assert!(complaint("yin --speed 0.05 --drive dc --gain 0").contains("a gain of 0 V/rad is outside"));
    assert!(complaint("yin --speed 0.05 --drive dc --gain nan").contains("a gain of NaN"));
    assert!(complaint("yin --speed 0.05 --gain 50").contains("it needs --drive dc"));
    assert!(complaint("yin --figure 4 --gain 50").contains("it needs --drive dc"));
    assert!(complaint("yin --state-space --friction 1000").contains("the factor of friction, 1000, is outside"));
    assert!(complaint("yin --figure 5 --friction 15").contains("figure 5 multiplies each factor by 0.5 to 2"));
    let stiff = file("rig-stiff.toml", "k_N_per_m = [1e300, 1e300, 1e300, 1e300, 1e300]\n");
    assert!(complaint(&format!("yin --speed 0.05 --rig {}", stiff.display())).contains("more than 5000000 time steps"));
    assert!(complaint("yin --figure 4 --friction -1").contains("the factor of friction"));
    assert!(complaint("zigzag --routing corexy --axis z").contains("the belts of a CoreXY do not move z"));
    assert!(complaint("zigzag --routing corexyz --order A,B,C").contains("name each motor once: A,B,C,D"));
    assert!(complaint("zigzag --order A,B").contains("--order needs --routing or --machine"));
    assert!(complaint("level --routing corexy").contains("lift no gantry"));
    assert!(complaint("level --at 1,1").contains("outside what the tool reaches"));
    for wrong in [
        "yin",
        "yin --figure 2",
        "yin --figure 3 --speed 1",
        "yin --speed 0.05 --svg x.svg",
        "yin --state-space --speed 0.05",
        "zigzag --steps 0",
        "zigzag --step -1",
        "zigzag --speed 0",
        "level --take-up 0",
        "level --spring nan",
    ] {
        assert_eq!(ask(wrong).status.code(), Some(2), "{wrong}");
    }
}

/// Carlyle's 0.01 mm, and the helix of three motors by hand.
#[test]
fn zigzags_of_all_machines_and_of_one() {
    let all = json("zigzag --step 0.02");
    let machines = all["machines"].as_array().unwrap();
    let asides: Vec<_> =
        machines.iter().map(|m| (m["machine"].as_str().unwrap(), m["aside_mm"].as_f64().unwrap())).collect();
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9;
    for ((name, aside), (expected, mm)) in asides.iter().zip([
        ("corexy", 0.01),
        ("corexyz-three", 0.02 * 0.5_f64.sqrt()),
        ("corexyz", 0.01),
        ("corehbot", 0.005),
    ]) {
        assert!(*name == expected && near(*aside, mm), "{asides:?}");
    }
    // Only two of them move z.
    assert_eq!(json("zigzag --axis z")["machines"].as_array().unwrap().len(), 2);
    let one = json("zigzag --machine ../examples/machines/corexyz-three.toml --axis z --order c,b,a --steps 2");
    assert_eq!(one["machines"][0]["order"], serde_json::json!(["+C", "+B", "+A"]));
    assert_eq!(one["machines"][0]["one_after_the_other_mm"].as_array().unwrap().len(), 7);
}

#[test]
fn levels_of_a_machine_file_and_with_springs() {
    let level = json("level");
    let case = |level: &serde_json::Value, name: &str| {
        level["cases"].as_array().unwrap().iter().find(|case| case["name"] == name).unwrap().clone()
    };
    let pair = "A shorter, C longer";
    let tilt = case(&level, pair)["gantry_mrad"][0].as_f64().unwrap();
    assert!(case(&level, pair)["bar_mrad"].as_f64().unwrap().abs() < 1e-9 && tilt > 0.0, "{level}");
    let soft = json("level --spring 1");
    assert!(near(&case(&soft, pair)["gantry_mrad"][0], 0.347 * tilt, 0.01), "{soft}");
    assert!(case(&soft, "along y") == case(&level, "along y") && soft["spring_N_per_mm"] == 1.0, "{soft}");
    assert_eq!(
        (&case(&level, pair)["goes_slack"], &level["spring_N_per_mm"]),
        (&false.into(), &serde_json::Value::Null)
    );
    let slack = json("level --take-up 30");
    assert!(case(&slack, pair)["goes_slack"] == true && case(&slack, "all shorter")["goes_slack"] == false, "{slack}");
    let rigid = file("rigid.toml", "[twin]\ngantry_tilt_stiffness_Nm_per_rad = 20000\n");
    let rigid = json(&format!("level --routing corexyz --machine {}", rigid.display()));
    assert!(case(&rigid, pair)["gantry_mrad"][0].as_f64().unwrap() < 0.5 * tilt, "{rigid}");
    assert_eq!(json("level --machine ../examples/machines/corexyz-three.toml")["machine"], "corexyz-three");
}
