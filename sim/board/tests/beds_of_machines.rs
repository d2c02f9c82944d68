//! Beds of every mechanism: belts that hold z too, four coordinates for three axes, three screws. Each measures its
//! bed and follows it, through stops and homes.

use crate::common::life::Life;
use crate::common::on_bed::{over, with_probe};
use corehbot::settings::Settings;
use corehbot_machine_file as machine_file;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;
use std::path::Path;

/// A machine of the examples, with a probe.
fn machine(name: &str) -> Settings {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines").join(name).with_extension("toml");
    let mut s = with_probe(machine_file::parse(&std::fs::read_to_string(file).unwrap()).unwrap().settings);
    (s.mesh.columns, s.mesh.rows) = (4, 4);
    s
}

/// Every kind of mechanism among the examples.
const NAMES: [&str; 8] =
    ["corexy", "awd-corexy", "corexz", "corexyz", "corexyz-three", "core-unequal", "corehbot-three-screws", "dual-y"];

/// z of the nozzle over the bed at a place, less its height where z is 0.
fn over_bed(life: &mut Life<'_>, plant: &BedPlant, zero: [f64; 2]) -> f64 {
    let [x, y, z] = life.nozzle();
    z - (plant.height([x, y]) - plant.height(zero))
}

#[test]
fn every_mechanism_follows_the_bed_that_it_has_measured_through_stops_and_homes() {
    for name in NAMES {
        let s = machine(name);
        let bed = bed_plant::read("tilt.x=0.0005,bowl=0.1", &s).unwrap();
        let (plant, zero) = (BedPlant::new(&s, &bed), bed.surface.centre());
        over(&s, &bed, &mut Eeprom::blank(), |life| {
            life.say("G28");
            life.say("G29");
            assert_eq!(life.count("Bilinear Leveling Grid:"), 1, "{name}: {:#?}", life.heard);
            let [x, y] = zero;
            let mut counts = Vec::new();
            for round in 0..3 {
                for (dx, dy) in [(-60.0, -40.0), (40.0, 50.0), (0.0, 0.0)] {
                    life.say(&format!("G1 X{} Y{} Z0.2 F9000", x + dx, y + dy));
                    life.say("M400");
                    let off = over_bed(life, &plant, zero) - 0.2;
                    // A parabola is exact in the inner cells; its fade and the steps of probe and z are left.
                    assert!(off.abs() < 0.008, "{name} {round} {dx} {dy}: {off}");
                }
                counts.push(life.counts());
                if round == 0 {
                    life.put(0, &format!("G1 X{} Y{} F3000", x - 80.0, y + 80.0));
                    life.rest(400);
                    life.say("M410");
                    life.await_ok();
                } else {
                    life.say("G28");
                }
            }
            assert_eq!(counts, [counts[0]; 3], "{name}: the same place has the same steps");
        });
    }
}

#[test]
fn three_screws_are_levelled_as_a_plane() {
    let s = machine("corehbot-three-screws");
    let text = "screw=-25/0/0.4,screw=415/0/-0.25,screw=195/400/0.1";
    let bed = bed_plant::read(text, &s).unwrap();
    over(&s, &bed, &mut Eeprom::blank(), |life| {
        for (screw, (at, point)) in
            [("X-25 Y0", "X40 Y60"), ("X415 Y0", "X360 Y60"), ("X195 Y400", "X195 Y340")].into_iter().enumerate()
        {
            life.say(&format!("M422 W{} {at}", screw + 1));
            life.say(&format!("M422 S{} {point}", screw + 1));
        }
        life.say("G28");
        life.say("G34");
        assert_eq!(life.count("Target accuracy achieved."), 1, "{:#?}", life.heard);
        life.heard.clear();
        life.say("G29");
        let rows = life.heard.iter().filter(|line| line.starts_with(' '));
        let heights: Vec<f64> =
            rows.skip(1).flat_map(|row| row.split_whitespace().skip(1)).flat_map(str::parse).collect();
        assert_eq!(heights.len(), 16, "{:#?}", life.heard);
        assert!(heights.iter().all(|height| height.abs() < 0.005), "{heights:?}");
    });
}
