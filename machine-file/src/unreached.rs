//! Places of a machine that its probe or its nozzle does not reach: commands refuse to touch there.

use corehbot::settings::{HomedAxis, Settings, WholePlace, ranges};
use corehbot::units::Mm;

/// The places, each with the key that would change it; those of screws only if the file `has_screws`. Without a probe
/// only the switch of z has a place.
pub(super) fn places(s: &Settings, has_screws: bool) -> Vec<(String, String)> {
    let mut found = Vec::new();
    if let Some([x, y]) = s.unreached_z_home() {
        let [reach_x, reach_y] = [HomedAxis::X, HomedAxis::Y].map(|axis| s.reach(axis));
        let key = if reach_x.holds(x) { "safe_z_home.y" } else { "safe_z_home.x" };
        let text = format!(
            "safe_z_home is at X{x} Y{y}, but the nozzle reaches from X{} Y{} to X{} Y{}",
            reach_x.least, reach_y.least, reach_x.most, reach_y.most
        );
        found.push((key.to_owned(), text));
    }
    if !s.probe.is_fitted() {
        return found;
    }
    let [reach_x, reach_y] = s.probe_reach(Mm::ZERO);
    let mut hold = |keys: [String; 2], who: &str, at: [Mm; 2]| {
        let out = keys.into_iter().zip(at).zip([reach_x, reach_y]).find(|((_, at), reach)| !reach.holds(*at));
        if let Some(((key, _), _)) = out {
            let [x, y] = at;
            let text = format!(
                "{who} touches at X{x} Y{y}, but the probe reaches from X{} Y{} to X{} Y{}: over the bed, with the nozzle \
                 inside its axes",
                reach_x.least, reach_y.least, reach_x.most, reach_y.most
            );
            found.push((key, text));
        }
    };
    // Otherwise it is the zero of a mesh alone, and no place of the file.
    if s.probe.homes_z || s.probe.home.iter().any(Option::is_some) {
        hold(["x", "y"].map(|axis| format!("probe.home.{axis}")), "probe.home", s.probe_home());
    }
    let motors = s.screw_motors();
    let screws = s.screws.iter().take(motors.len()).zip(1..);
    if motors.len() < 2 || !has_screws {
        return found;
    }
    for (screw, number) in screws.clone().filter(|(screw, _)| screw.point.is_known()) {
        let WholePlace { x, y } = screw.point;
        let keys = ["x", "y"].map(|axis| format!("screws.{number}.point_{axis}"));
        hold(keys, &format!("screws.{number}"), [x, y].map(|at| Mm::const_from_int(at.into())));
    }
    // A machine that says no screws does not use them.
    let parts = |number: usize| {
        let screw = s.screws[number - 1];
        [("x", screw.place.x), ("y", screw.place.y), ("point_x", screw.point.x), ("point_y", screw.point.y)]
    };
    let is_said = |number: usize| parts(number).iter().any(|(_, at)| *at != ranges::NOWHERE);
    if (1..=motors.len()).any(is_said) {
        for number in 1..=motors.len() {
            for (key, _) in parts(number).iter().filter(|(_, at)| *at == ranges::NOWHERE) {
                let key = format!("screws.{number}.{key}");
                let text = format!("{key} is missing: the machine has {} screws of z", motors.len());
                found.push((key, text));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::problems;

    /// What is wrong with a machine of two or three screws and a probe.
    fn said(text: &str) -> Vec<String> {
        let probe = "[endstops]\nprobe = \"PROBE\"\n[probe]\nkind = \"switch\"\n";
        let (machine, found) = problems(&format!("{probe}{text}"));
        assert!(machine.is_some(), "{found:?}");
        let errors = found.into_iter().filter(|problem| problem.is_error);
        errors.map(|problem| problem.text).collect()
    }

    const THREE: &str = "[mechanism]\nm1 = [1, 0, 0]\nm4 = [0, 1, 0]\nz1 = [0, 0, 1]\nz2 = [0, 0, 1]\nm8 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n";

    fn screw(number: usize, point: [i32; 2]) -> String {
        let [x, y] = point;
        format!("[screws.{number}]\nx = {number}00\ny = -20\npoint_x = {x}\npoint_y = {y}\n")
    }

    #[test]
    fn places_that_the_probe_reaches_are_in_order_also_at_the_edge_of_the_bed() {
        assert_eq!(said(""), [""; 0]);
        assert_eq!(said("[probe.home]\nx = 0\ny = 417.6\n"), [""; 0]);
        let three: String = [screw(1, [0, 0]), screw(2, [390, 5]), screw(3, [195, 417])].concat();
        assert_eq!(said(&format!("{THREE}{three}")), [""; 0]);
        // One that says no screws uses none of the prototype's, and one screw needs no place.
        assert_eq!(said(THREE), [""; 0]);
        assert_eq!(
            said(
                "[axes.x]\nlength = 300\n[mechanism]\nm1 = [1, 0, 0]\nm4 = [0, 1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n"
            ),
            [""; 0]
        );
    }

    #[test]
    fn a_place_where_the_nozzle_would_leave_its_axes_is_an_error() {
        let offset = "[probe.offset]\ny = 25\nx = -40\n";
        let home = said(&format!("{offset}[probe.home]\nx = 0\ny = 24\n"));
        let reach = "but the probe reaches from X0 Y25 to X350 Y417.6: over the bed, with the nozzle inside its axes";
        assert_eq!(home, [format!("probe.home touches at X0 Y24, {reach}")]);
        let three: String = [screw(1, [30, 5]), screw(2, [150, 245]), screw(3, [351, 30])].concat();
        let screws = said(&format!("{offset}{THREE}{three}"));
        assert_eq!(
            screws,
            [format!("screws.1 touches at X30 Y5, {reach}"), format!("screws.3 touches at X351 Y30, {reach}")]
        );
        // The middle of the bed may be out of reach too.
        let narrow = said("z_home = true\n[bed]\nleft = 300\nwidth = 90\n[probe.offset]\nx = -50\n");
        assert_eq!(narrow.len(), 1, "{narrow:?}");
        let unused = said("[bed]\nleft = 300\nwidth = 90\n[probe.offset]\nx = -50\n");
        assert_eq!(unused, [""; 0], "nor does the file name the screws");
    }

    #[test]
    fn a_screw_that_is_said_in_part_is_an_error() {
        let two: String = [screw(1, [30, 30]), screw(2, [150, 245])].concat();
        let missing = said(&format!("{THREE}{two}[screws.3]\nx = 300\n"));
        let keys = ["y", "point_x", "point_y"];
        let text = |key: &&str| format!("screws.3.{key} is missing: the machine has 3 screws of z");
        assert_eq!(missing, keys.iter().map(text).collect::<Vec<_>>());
    }

    #[test]
    fn a_switch_that_homes_z_where_the_nozzle_cannot_be_is_an_error() {
        let said = |text: &str| {
            let (machine, found) = problems(text);
            assert!(machine.is_some(), "{found:?}");
            found.into_iter().filter(|problem| problem.is_error).map(|problem| problem.text).collect::<Vec<_>>()
        };
        assert_eq!(said("[safe_z_home]\nx = 0\ny = 417.6\n"), [""; 0]);
        let far = said("[safe_z_home]\nx = 10\ny = 418\n");
        assert_eq!(far, ["safe_z_home is at X10 Y418, but the nozzle reaches from X0 Y0 to X390 Y417.6"]);
    }

    #[test]
    fn nothing_touches_without_a_probe() {
        let (_, found) = problems("[probe.home]\nx = -500\n");
        assert!(found.is_empty(), "{found:?}");
    }
}
