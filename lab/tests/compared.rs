//! Machines of one size next to each other, and points of a paper's machine.

use super::{complaint, file, json, near};

#[test]
fn mechanisms_are_compared_on_an_area_and_on_a_file() {
    let plain = json("compare --grid 5x5");
    let machines = plain["machines"].as_array().unwrap();
    let deflections: Vec<f64> = machines.iter().map(|m| m["deflection_um"].as_f64().unwrap()).collect();
    assert!(deflections[0] < deflections[1] && deflections[0] < deflections[2], "{plain}");
    assert!(plain.get("runs").is_none());
    let gcode = file("side.gcode", "G1 X130 F12000\nG1 Y130\nM400\n");
    let page = gcode.with_file_name("compare.html");
    let words = format!("compare {} --grid 3x3 --assume-homed 100,100,0 --report {}", gcode.display(), page.display());
    let played = json(&words);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(
        page.contains("side.gcode") && page.contains("\"racking_y_um_per_m_s2\"") && !page.contains("/*PAGE*/"),
        "{page}"
    );
    let errors: Vec<f64> =
        played["runs"].as_array().unwrap().iter().map(|r| r["contour"]["max_mm"].as_f64().unwrap()).collect();
    assert!(errors.len() == 3 && errors.iter().all(|e| *e > 0.001 && *e < 0.2), "{errors:?}");
    let wide = file("wide.gcode", "G1 X385 F12000\nM400\n");
    assert!(complaint(&format!("compare {}", wide.display())).contains("H-bot: the path takes"));
}

#[test]
fn the_torque_on_a_soft_frame_is_told() {
    let soft = file("soft.toml", "[twin]\nframe_stiffness_N_per_mm = [400, 900]\n");
    let compared = json(&format!("compare --grid 2x2 --machine {}", soft.display()));
    let [core, hbot, corexy] = [0, 1, 2].map(|i| compared["machines"][i]["frame_torque_x"].clone());
    assert!(core["belts_mNm_per_m_s2"].as_f64().unwrap().abs() < 1e-9, "{core}");
    assert!(near(&core["printed_mNm_per_m_s2"], 3.81, 1e-6), "{core}");
    assert!(
        near(&hbot["belts_mNm_per_m_s2"], 3.81, 1e-6) && near(&corexy["rotors_mNm_per_m_s2"], 1.7008, 1e-4),
        "{corexy}"
    );
    assert!(compared["machines"][0]["frame_modes_Hz"].is_array(), "{compared}");
}

#[test]
fn points_are_answered_with_units_in_the_keys() {
    let yin = json("yin --speed 0.079 --model 4dof");
    assert!(near(&yin["x_to_y_mm"], 0.7690, 5e-3) && near(&yin["y_to_x_mm"], 0.1962, 5e-3), "{yin}");
    assert!(complaint("yin --speed 7").contains("speed"));
    assert!(complaint("yin --speed 0.02 --friction -1").contains("the factor of friction, -1, is outside"));
    let push = json("push --force 5,-5 --routing corexy --at 147.5,339.4");
    assert!(push["dx_mm"].as_f64().unwrap() > 0.0 && push["residual_mm"].is_null(), "{push}");
}
