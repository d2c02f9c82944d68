//! Drawings: those in the documents are what the commands make.

use super::{ask, complaint, file, json, near};
use std::fs;
use std::path::{Path, PathBuf};

/// Largest drawing in the documents, in bytes.
const LARGEST: u64 = 60_000;

fn documents() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/research")
}

/// Compares a folder of the documents with what a command made; `BLESS=1` takes it over.
fn same(made: &Path, kept: &Path) {
    let mut names: Vec<_> = fs::read_dir(made).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    if std::env::var_os("BLESS").is_some() {
        fs::create_dir_all(kept).unwrap();
        for name in &names {
            fs::copy(made.join(name), kept.join(name)).unwrap();
        }
    }
    let mut there: Vec<_> = fs::read_dir(kept).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    there.sort();
    assert_eq!(names, there);
    for name in names {
        let [made, kept] = [made, kept].map(|folder| fs::read_to_string(folder.join(&name)).unwrap());
        assert!(made == kept, "{} differs: make it with the command on its page, or BLESS=1", name.display());
        assert!(made.len() as u64 <= LARGEST, "{} has {} bytes", name.display(), made.len());
    }
}

#[test]
fn the_papers_figures_in_the_documents_are_the_commands() {
    let made = file("figures-begin", "").with_file_name("figures");
    let _ = fs::remove_dir_all(&made);
    let told = json(&format!("figures {}", made.display()));
    same(&made, &documents().join("corehbot-paper"));
    let rows = told["table_1"].as_array().unwrap();
    assert_eq!(rows.len(), 28);
    assert!(rows.iter().all(|row| near(&row["ours_mm"], row["printed_mm"].as_f64().unwrap(), 1e-9)), "{told}");
    // A folder that is a file, and none.
    let blocked = file("figures-blocked", "");
    assert!(complaint(&format!("figures {}", blocked.display())).contains("cannot create the folder"));
    assert_eq!(ask("figures").status.code(), Some(2));
    // The page of another hand stays, and one of the command is made again.
    let page = made.join("README.md");
    fs::write(&page, "# My printer\n").unwrap();
    let refused = complaint(&format!("figures {}", made.display()));
    assert!(refused.contains("README.md") && refused.contains("choose another folder"), "{refused}");
    assert_eq!(fs::read_to_string(&page).unwrap(), "# My printer\n");
    fs::write(&page, "# Figures of the CoreH-bot paper\n").unwrap();
    json(&format!("figures {}", made.display()));
    same(&made, &documents().join("corehbot-paper"));
}

/// Figures of docs/research/twin.md's table of misprints, which were computed elsewhere.
#[test]
fn each_number_of_the_paper_stands_next_to_one_computed_elsewhere() {
    let made = file("figures-numbers", "").with_file_name("numbers");
    let told = json(&format!("figures {}", made.display()));
    let statements = told["statements"].as_array().unwrap();
    let find = |what: &str| statements.iter().find(|s| s["what"].as_str() == Some(what)).unwrap();
    for (what, printed, ours) in [
        // Half of the sum and of the difference of 63.5 and 25.4 mm/s.
        ("speed of a CoreXY's tool along x, motors at 10 and 4 rad/s", 44.45, 44.45),
        ("speed of a CoreXY's tool along y, motors at 10 and 4 rad/s", 19.05, 19.05),
        // -2 - (30, 70, 50, 10) / 6.35.
        ("speed of motor 1, head at 10 and 20 mm/s, pulley 13 at 2 rad/s", -6.724_409, -6.724_409),
        ("speed of motor 4 in the same motion", -13.023_622, -13.023_622),
        ("speed of motor 8 in the same motion", -9.874_016, -9.874_016),
        ("speed of motor 11 in the same motion", -3.574_803, -3.574_803),
        ("unknowns", 62.0, 62.0),
        ("degrees of freedom", 3.0, 3.0),
        ("belt of a CoreH-bot, e = 2r", 3727.691, 3727.691),
        ("belt of a CoreH-bot, head of 80 mm", 3727.691, 3593.091),
        ("belt of an H-bot", 2784.095, 2784.095),
        ("each belt of a CoreXY", 1874.747, 1874.747),
        ("reach of a CoreH-bot in x, head of 80 mm", 457.3, 390.0),
        ("reach of H-bot and CoreXY in x, head of 80 mm", 444.6, 364.6),
        ("least W for 300 mm of reach", 300.0, 380.0),
        ("Fe / dT along x, H-bot", 2.0, 2.0),
        ("Fe / dT along y, CoreXY", 4.0, 4.0),
        // L_L / L_R of the closed form: 659.6 and 1009.6 mm.
        ("dT on the right over dT on the left, tool at x = 147.5", 1.0, 659.6 / 1009.6),
        ("torque on the bar along y at x = 147.5, bar of 1.2 kg", 350.0, 350.0 / 3.0),
        ("torque on the bar along x, H-bot, dT = 1 N", -522.4, -497.0),
        ("belts on the bar about pulley 1, along x, dT = 1 N", 940.0, 940.0),
        ("belts on the bar about pulley 1, along y, dT = 1 N", 940.0, 940.0),
        ("motors' torque on the frame along x, CoreXY", 25.4, 25.4),
        ("motors' torque on the frame along x, CoreH-bot", 25.4, 0.0),
    ] {
        let s = find(what);
        let agrees = near(&s["printed"], printed, 1e-6) && near(&s["ours"], ours, 1e-6);
        // A difference is explained, and nothing else is.
        assert!(agrees && ((printed - ours).abs() < 1e-3) == s["why"].as_str().unwrap().is_empty(), "{s}");
    }
}

/// Equation 8 by hand. A tooth is 2 mm of belt, so 10 mm turn a pulley of n teeth by 1800 / n degrees. A pulley that is
/// taken for one of 20 teeth moves n / 20 of the belt; x, y, circulation and equation 11 are sums over the four.
#[test]
fn four_pulleys_of_four_sizes_turn_as_computed_by_hand() {
    let made = file("figures-radii", "").with_file_name("radii");
    let radii = &json(&format!("figures {}", made.display()))["radii"];
    assert_eq!(radii["teeth"], serde_json::json!([20, 16, 24, 18]), "{radii}");
    let turns = [[-90.0, -112.5, 75.0, 100.0], [90.0, -112.5, -75.0, 100.0], [0.0, -225.0, 0.0, 200.0]];
    for (movement, turns) in radii["movements"].as_array().unwrap().iter().zip(turns) {
        for (motor, turn) in turns.into_iter().enumerate() {
            assert!((movement["turn_deg"][motor].as_f64().unwrap() - turn).abs() < 1e-9, "{movement}");
        }
    }
    // Belts for (100, 0): -100, -80, 120, 90 mm; for (0, 100): 100, -80, -120, 90 mm; and their sum.
    let corners =
        [([0.0, 0.0], 0.0, 0.0), ([97.5, -12.5], 7.5, 10.0), ([85.0, 85.0], 5.0, -20.0), ([-12.5, 97.5], -2.5, -30.0)];
    let told = radii["taken_for_equal"].as_array().unwrap();
    assert_eq!(told.len(), corners.len());
    for (corner, ([x, y], round, residual)) in told.iter().zip(corners) {
        let is = |value: &serde_json::Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-9;
        assert!(is(&corner["reached_mm"][0], x) && is(&corner["reached_mm"][1], y), "{corner}");
        assert!(is(&corner["circulation_mm"], round) && is(&corner["residual_mm"], residual), "{corner}");
    }
}

#[test]
fn the_picture_of_pulleys_off_their_places_is_the_commands() {
    let made = file("twin-misalignment.svg", "");
    let told = json(&format!("misalignment --at 150,300 --off 12=1,0 --off 6=0,0.5 --svg {}", made.display()));
    // 40 N by 1 mm to the right; and on the head 2 by 40 N by 0.5 mm, clockwise, which the paper counts for the bar
    // too.
    assert!(near(&told["paper"]["head_torque_Nm"], -0.04, 1e-9), "{told}");
    assert!(told["paper"]["bar_torque_Nm"].as_f64().unwrap().abs() < 1e-12, "{told}");
    assert!(near(&told["slanted"]["bar_torque_Nm"], 0.0433, 2e-3), "{told}");
    assert!(told["along_y"][40]["tension_change_N"]["L"].as_f64().unwrap() > 0.3, "{told}");
    let kept = documents().join("twin-misalignment.svg");
    if std::env::var_os("BLESS").is_some() {
        fs::copy(&made, &kept).unwrap();
    }
    let [made, kept] = [made, kept].map(|path| fs::read_to_string(path).unwrap());
    assert!(
        made == kept && made.len() as u64 <= LARGEST,
        "it differs: make it with the command on its page, or BLESS=1"
    );
    assert!(complaint("misalignment --off 99=1,0").contains("there is no pulley 99; the machine has 1, 2"));
    let much = complaint("misalignment --off 12=15,0 --off 6=1,0 --off 12=6,0");
    assert!(much.contains("pulley 12 is off by (21, 0) mm in all; the limit is 20"), "{much}");
    assert!(complaint("misalignment --routing corexyz --off 21=1,0").contains("belts in one plane"));
    let text = String::from_utf8(ask("misalignment").stdout).unwrap();
    assert!(text.contains("for 1 mm of a pulley") && !text.contains("by the paper"), "{text}");
}

/// Torques by virtual work: 0.6 kg at r are 3.81 mN m; and two masses on two springs, the tool's and the frame's.
#[test]
fn the_picture_of_the_frame_is_the_commands() {
    let made = file("frame.svg", "");
    let told = json(&format!("frame --svg {}", made.display()));
    let of = |machine: usize, key: &str| told["torques"][machine]["x"][key].as_f64().unwrap();
    assert!(of(0, "belts_mNm_per_m_s2").abs() < 1e-9 && of(0, "rotors_mNm_per_m_s2").abs() < 1e-9, "{told}");
    for machine in [1, 2] {
        assert!((of(machine, "belts_mNm_per_m_s2") - 3.81).abs() < 1e-6, "{told}");
        assert!((of(machine, "rotors_mNm_per_m_s2") - 1.7008).abs() < 1e-4, "{told}");
    }
    let frame = told["frames"].as_array().unwrap().iter().find(|f| f["frame_stiffness_N_per_mm"] == 400.0).unwrap();
    let mut expected = Vec::new();
    for (k, m, big) in [(287.563, 0.6, 11.2), (278.358, 1.8, 10.0)] {
        let (a, b, c) = (m * big, (k * (m + big) + 400.0 * m) * 1000.0, k * 400.0 * 1e6);
        let root = f64::sqrt(b * b - 4.0 * a * c);
        expected.extend([b - root, b + root].map(|s| (s / (2.0 * a)).sqrt() / std::f64::consts::TAU));
    }
    expected.sort_by(f64::total_cmp);
    for (i, hz) in expected.iter().enumerate() {
        assert!(near(&frame["frequencies_Hz"][i], *hz, 1e-5), "{frame} {expected:?}");
    }
    assert!(near(&told["rigid_Hz"][0], 62.587, 1e-4) && near(&told["rigid_Hz"][1], 110.182, 1e-4), "{told}");
    let kept = documents().join("frame.svg");
    if std::env::var_os("BLESS").is_some() {
        fs::copy(&made, &kept).unwrap();
    }
    let [made, kept] = [made, kept].map(|path| fs::read_to_string(path).unwrap());
    assert!(made == kept && made.len() as u64 <= LARGEST, "docs/research/frame.svg differs: BLESS=1");
}
