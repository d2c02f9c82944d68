//! Page: the drawings, and the numbers of the paper's text next to the model's.

use crate::queries::paper::Paper;
use std::fmt::Write as _;

const HEAD: &str = "# Figures of the CoreH-bot paper\n
Made by `corehbot-lab figures docs/research/corehbot-paper`. Do not edit: a test compares this folder with the command.\n
The drawings follow from the [routing tables](../twin.md#one-law), which also give every stiffness, mode and run of the [twin](../twin.md). The paper's own figures cannot be computed with. Radii and the widths of bar and head are drawn larger than they are, as in the paper.\n";

const DRAWINGS: [(&str, &str, &str); 8] = [
    (
        "Figure 5: the CoreH-bot",
        "fig-5-corehbot.svg",
        "The paper numbers pulleys along the belt. A segment has the numbers of its pulleys.",
    ),
    (
        "Figure 6: three routings",
        "fig-6-routings.svg",
        "H-bot and CoreXY have no pulleys on the head; here `e` is the distance of the belt's clamps.",
    ),
    (
        "Equation 8: pulleys of four sizes",
        "equation-8.svg",
        "The paper gives each motor a radius of its own and has no picture of it. `twin.motor_radius_mm` of a [machine file](../twin.md#the-machine) has the four radii.",
    ),
    ("Table 1: lengths", "table-1.svg", "No other routing gives all 28 lengths."),
    (
        "Workspaces",
        "workspaces.svg",
        "With a head of 80 mm each machine loses reach in x alone. The CoreH-bot keeps more than the others.",
    ),
    (
        "Figure 7: a simple belt",
        "fig-7-simple-belt.svg",
        "Condition F, the strongest assumption of the paper's section 3.",
    ),
    (
        "Figure 8: forces at rest",
        "fig-8-free-bodies.svg",
        "The belt pulls neither bar nor head while pulleys are aligned.",
    ),
    (
        "Figure 9: forces in motion",
        "fig-9-motions.svg",
        "Signs and torques follow from the routing for a force against the motion.",
    ),
];

pub(super) fn page(paper: &Paper) -> String {
    let mut text = HEAD.to_owned();
    for (title, file, note) in DRAWINGS {
        let _ = write!(text, "\n## {title}\n\n![{title}]({file})\n\n{note}\n");
    }
    text += "\n## Numbers of the text\n\nThe paper's number, or the value of its expression with its table 2, and the model's. Forces and torques are for dT = 1 N; couples are counter-clockwise. [Misprints](../twin.md#what-the-paper-printed) has the corrections of equations.\n\n";
    text += "| where | what | unit | paper | ours | why they differ |\n|---|---|---|---|---|---|\n";
    for s in &paper.statements {
        let [printed, ours] = [s.printed, s.ours].map(|value| s.text(value));
        let _ = writeln!(text, "| {} | {} | {} | {printed} | {ours} | {} |", s.place, s.what, s.unit, s.why);
    }
    text
}
