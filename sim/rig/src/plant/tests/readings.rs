//! The converter's readings, and their source.

use super::*;

/// Celsius from a reading, by the laws as papers print them: Beta, or 1/T = a + b ln R + c (ln R)^3, fitted here to the
/// same table by Cramer's rule.
fn celsius(sensor: Sensor, reading: f64) -> f64 {
    let ohm = 4700.0 * reading / (65_536.0 - reading);
    let x = ohm.ln();
    let inverse = if sensor == Sensor::Bed {
        1.0 / 298.15 + (ohm / 100e3).ln() / 3950.0
    } else {
        let rows = [(20.0, 126.8e3), (150.0, 1360.0), (300.0, 80.65)].map(|(celsius, ohm): (f64, f64)| {
            let x = ohm.ln();
            [1.0, x, x * x * x, 1.0 / (celsius + 273.15)]
        });
        let determinant = |column: Option<usize>| {
            let m = rows.map(|row| {
                let mut three = [row[0], row[1], row[2]];
                if let Some(column) = column {
                    three[column] = row[3];
                }
                three
            });
            m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
        };
        let [a, b, c] = [0, 1, 2].map(|column| determinant(Some(column)) / determinant(None));
        a + b * x + c * x * x * x
    };
    1.0 / inverse - 273.15
}

/// A quiet plant with its two sensors at `celsius`.
fn quiet(celsius: f64, noise_lsb: f64) -> Plant {
    let mut c = PlantConstants::prototype();
    c.converter.noise_lsb = noise_lsb;
    let mut plant = Plant::new(&c);
    plant.hotend_sensor = Thermometer::at(celsius);
    plant.bed_sensor = Thermometer::at(celsius);
    plant
}

#[test]
fn sixteen_conversions_are_a_reading() {
    let (mut one, mut other) = (quiet(60.0, 0.8), quiet(60.0, 0.8));
    for sensor in [Sensor::Bed, Sensor::Hotend0] {
        let sum: u16 = (0..16).map(|_| one.convert(sensor).unwrap()).sum();
        assert_eq!(Some(sum), other.sample(sensor));
    }
    assert_eq!(one.convert(Sensor::Hotend1), None);
}

#[test]
fn a_thermistor_has_the_resistances_of_its_data_sheet() {
    let semitec = Thermistor::semitec_104gt2();
    // The three points of the fit, and between them Semitec's R25 = 100 kOhm and B25/85 = 4267 K: 9.10 kOhm at 85 C.
    for (celsius, ohm, within) in [
        (20.0, 126.8e3, 1e-9),
        (150.0, 1360.0, 1e-9),
        (300.0, 80.65, 1e-9),
        (25.0, 100e3, 0.005),
        (85.0, 100e3 * (4267.0 * (1.0 / 358.15 - 1.0 / 298.15_f64)).exp(), 0.02),
    ] {
        assert_near(semitec.ohm(celsius) / ohm, 1.0, within);
    }
    assert_near(Thermistor::NTC_100K_B3950.ohm(25.0), 100e3, 1e-9);
    // B25/50 is 3950 K.
    let slope = (Thermistor::NTC_100K_B3950.ohm(50.0) / 100e3).ln() / (1.0 / 323.15 - 1.0 / 298.15);
    assert_near(slope, 3950.0, 1e-6);
}

#[test]
fn a_reading_gives_its_temperature_back() {
    for at in [25.0, 215.0, 250.0] {
        for sensor in [Sensor::Hotend0, Sensor::Bed] {
            // Without noise half a step of 12 bits is in doubt: 0.2 C at 250 C.
            let reading = quiet(at, 0.0).sample(sensor).unwrap();
            assert_near(celsius(sensor, f64::from(reading)), at, 0.3);
            // Noise makes the mean better than that.
            let mut plant = quiet(at, 0.8);
            let sum: f64 = (0..100).map(|_| celsius(sensor, f64::from(plant.sample(sensor).unwrap()))).sum();
            assert_near(sum / 100.0, at, 0.05);
        }
    }
}

#[test]
fn a_hotter_sensor_reads_less() {
    for sensor in [Sensor::Hotend0, Sensor::Bed] {
        let mut last = u16::MAX;
        for at in (-40..=500).step_by(20) {
            let reading = quiet(f64::from(at), 0.0).sample(sensor).unwrap();
            assert!(reading < last, "{at} C reads {reading}, 20 C less {last}");
            last = reading;
        }
    }
}

#[test]
fn noise_is_as_wide_as_it_should_be_and_centred() {
    let mut plant = quiet(100.0, 2.0);
    let exact = 65_536.0
        * quiet(100.0, 0.0).hotend_sensor.share(
            &plant.constants.hotend.sensor,
            SensorFault::None,
            plant.constants.converter.pull_up_ohm,
        );
    let count = 20_000.0;
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..20_000 {
        let off = f64::from(plant.sample(Sensor::Hotend0).unwrap()) - exact;
        sum += off;
        squares += off * off;
    }
    // 16 conversions of 2 LSB and the rounding's 1/sqrt(12) each: 4 sqrt(4 + 1/12).
    assert_near(sum / count, 0.0, 0.3);
    assert_near((squares / count).sqrt(), 4.0 * (4.0 + 1.0 / 12.0_f64).sqrt(), 0.2);
}

#[test]
fn the_same_seed_gives_the_same_readings_and_another_one_others() {
    let readings = |seed, often| {
        let mut c = PlantConstants::prototype();
        c.converter.seed = seed;
        let mut plant = Plant::new(&c);
        let mut all = [0; 64];
        for (step, reading) in all.iter_mut().enumerate() {
            plant.step(&Drive { hotend: 1.0, ..Drive::IDLE }, 0.02);
            if often || step % 7 == 0 {
                let _ = plant.sample(Sensor::Bed);
            }
            *reading = plant.sample(Sensor::Hotend0).unwrap();
        }
        all
    };
    assert_eq!(readings(1, false), readings(1, false));
    assert_ne!(readings(1, false), readings(2, false));
    // The readings of one sensor do not affect another.
    assert_eq!(readings(1, false), readings(1, true));
}

#[test]
fn there_are_two_sensors() {
    let mut plant = prototype();
    for (sensor, _) in Sensor::ALL {
        let is_there = matches!(sensor, Sensor::Bed | Sensor::Hotend0);
        assert_eq!(plant.sample(sensor).is_some(), is_there);
    }
    // 100 kOhm under 4.7 kOhm at 25 C.
    assert_near(f64::from(plant.sample(Sensor::Bed).unwrap()), 62_594.0, 16.0);
    assert_near(f64::from(plant.sample(Sensor::Hotend0).unwrap()), 62_594.0, 32.0);
}

/// A guard, not a truth: it changes with the prototype's figures. It checks that every platform computes the same: a
/// Cortex-M4 (QEMU, mps2-an386) has printed these figures too.
#[test]
fn the_bits_are_the_same_everywhere() {
    let mut plant = prototype();
    let mut hash = 0_u64;
    for _ in 0..3000 {
        plant.step(&Drive { hotend: 0.9, bed: 0.7, part_fan: 0.2, flow_mm3_s: 2.0, ..Drive::IDLE }, 0.02);
        let readings = [plant.sample(Sensor::Hotend0), plant.sample(Sensor::Bed), plant.vref_sample()];
        for reading in readings {
            hash = hash.rotate_left(7) ^ u64::from(reading.unwrap());
        }
    }
    let bits = (plant.hotend_celsius().to_bits(), plant.bed_celsius().to_bits(), hash);
    assert_eq!(bits, (0x4066_7ba5_6420_60fd, 0x4041_e643_2694_986a, 0x205e_e559_73be_67ae), "{bits:#x?}");
}
