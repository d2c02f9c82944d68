//! Tests of trace.

use super::*;
use corehbot::motors::prototype;

fn header() -> Header {
    (&Settings::prototype()).into()
}

fn trace(events: &[(u64, u8, u8)]) -> (String, Finished) {
    let mut bytes = Vec::new();
    let mut writer = TraceWriter::new(Some(&mut bytes), header());
    for &(tick, steps, forward) in events {
        writer.event(tick, MotorSet(steps), MotorSet(forward));
    }
    let finished = writer.finish().unwrap();
    (String::from_utf8(bytes).unwrap(), finished)
}

#[test]
fn rows_are_signed_steps_in_the_order_of_the_header() {
    let (text, finished) = trace(&[(0, 0x0F, 0x0C), (7, 0, 0x7F), (1_234_567_890_123, 0x70, 0x30)]);
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(
        lines,
        [
            "# corehbot-trace v1 tick_hz=10000000 kinematics=corehbot steps_per_mm=80/800/400",
            "tick,m1,m4,m8,m11,z1,z2,e0",
            "0,-1,-1,1,1,0,0,0",
            "1234567890123,0,0,0,0,1,1,-1",
        ]
    );
    assert!(text.ends_with("-1\n"));
    assert_eq!(finished.events, 2);
}

#[test]
fn ticks_of_any_length_are_written_in_decimal() {
    let powers = (0..20).map(|digits| 10u64.pow(digits));
    let around = powers.flat_map(|power| [power - 1, power, power + 1, power.saturating_mul(9)]);
    // To and fro, so that no row can rely on the row before.
    let ticks: Vec<_> = around.clone().chain(around.rev()).chain([u64::MAX, 5, 123_450_009, 123_460_000]).collect();
    let (text, _) = trace(&ticks.iter().map(|tick| (*tick, 1, 1)).collect::<Vec<_>>());
    let written: Vec<_> = text.lines().skip(2).map(|row| row.split(',').next().unwrap()).collect();
    assert_eq!(written, ticks.iter().map(u64::to_string).collect::<Vec<_>>());
}

#[test]
fn the_digest_is_that_of_the_file_whether_or_not_there_is_one() {
    let events: Vec<_> = (0..30_000).map(|i| (i * 37, 0x09, (i % 2 * 8) as u8)).collect();
    let (text, with_file) = trace(&events);
    assert_eq!(with_file.sha256, hex(&Sha256::digest(text.as_bytes())));
    let mut writer = TraceWriter::new(None::<Vec<u8>>, header());
    for &(tick, steps, forward) in &events {
        writer.event(tick, MotorSet(steps), MotorSet(forward));
    }
    assert_eq!(writer.finish().unwrap(), with_file);
}

#[test]
fn a_resolution_is_printed_with_all_its_digits() {
    assert_eq!(exact(StepsPerMm::from_num(80)), "80");
    assert_eq!(exact(StepsPerMm::from_num(0.5)), "0.5");
    assert_eq!(exact(StepsPerMm::from_bits(400 << 16 | 1)), "400.0000152587890625");
}

#[test]
fn a_full_disk_is_reported_at_the_end() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut writer = TraceWriter::new(Some(Full), header());
    writer.event(1, prototype::E, prototype::E);
    assert_eq!(writer.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
}

#[test]
fn columns_are_the_motors_of_the_machine_by_their_names() {
    let mut s = Settings::prototype();
    s.mechanism.rows = [[0; 4]; MOTORS];
    s.motor_names = [MotorName::NONE; MOTORS];
    let rows = [("x", [1, 0, 0, 0]), ("y", [0, 1, 0, 0]), ("z", [0, 0, 1, 0]), ("za", [0; 4]), ("e", [0, 0, 0, 1])];
    for (motor, (name, row)) in rows.into_iter().enumerate() {
        (s.motor_names[motor], s.mechanism.rows[motor]) = (MotorName::lit(name), row);
    }
    let mut bytes = Vec::new();
    let mut writer = TraceWriter::new(Some(&mut bytes), (&s).into());
    writer.event(5, MotorSet(0x15), MotorSet(0x11));
    writer.finish().unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert!(lines[0].contains("kinematics=x(1,0,0,0);y(0,1,0,0);z(0,0,1,0);e(0,0,0,1) "), "{text}");
    assert_eq!(lines[1..], ["tick,x,y,z,za,e", "5,1,0,-1,0,1"]);
}
