//! Raw files: whole, cut, spoilt, and of other firmwares.

use super::*;
use std::fmt::Write as _;

const HEADER: &str = "#time,accel_x,accel_y,accel_z\n";

/// Two seconds at 3200 Hz.
fn text(end: &str) -> String {
    let mut text = HEADER.replace('\n', end);
    for i in 0..6400 {
        let t = f64::from(i) / 3200.0;
        write!(text, "{t:.6},{:.6},{:.6},{:.6}{end}", (300.0 * t).sin() * 1000.0, (7.0 * t).cos(), 9806.65 + t)
            .unwrap();
    }
    text
}

fn flaw(text: &str) -> Flaw {
    read(text.as_bytes()).unwrap_err()
}

#[test]
fn newlines_of_windows_and_a_byte_order_mark_are_taken() {
    let plain = read(text("\n").as_bytes()).unwrap();
    assert!((plain.rate_hz / 3200.0 - 1.0).abs() < 1e-3 && plain.remarks.is_empty(), "{:?}", plain.remarks);
    assert_eq!(plain.axes.each_ref().map(Vec::len), [6400; 3]);
    assert_eq!(read(text("\r\n").as_bytes()), Ok(plain.clone()));
    assert_eq!(read(format!("\u{feff}{}", text("\n")).as_bytes()), Ok(plain));
}

#[test]
fn what_is_no_recording_is_named() {
    assert_eq!(flaw(""), Flaw::Empty);
    assert_eq!(flaw("\r\n\r\n"), Flaw::Empty);
    assert_eq!(flaw(HEADER), Flaw::NoSamples);
    assert_eq!(flaw("0.0,1,2,3\n"), Flaw::Header("0.0,1,2,3".to_owned()));
    assert_eq!(flaw(&format!("{HEADER}0.0,1,2\n")), Flaw::Columns(2, 3, 4));
    assert_eq!(flaw(&format!("{HEADER}0.0,1,2,3,4\n")), Flaw::Columns(2, 5, 4));
    assert_eq!(flaw(&format!("{HEADER}0.0;1;2;3\n")), Flaw::Number(2, "0.0;1;2;3".to_owned()));
    assert_eq!(flaw(&format!("{HEADER}0.0,1,nan,3\n")), Flaw::Number(2, "nan".to_owned()));
    assert_eq!(flaw(&format!("{HEADER}0.0,1,2,3\n0.0,1,2,3\n")), Flaw::Backwards(3, 0.0, 0.0));
    assert!(matches!(read(b"\x28\xb5\x2f\xfd\0"), Err(Flaw::NotText(_))));
    assert!(matches!(read(b"#time\0"), Err(Flaw::NotText(_))));
}

#[test]
fn samples_that_would_mislead_are_refused() {
    let whole = text("\n");
    let lines: Vec<&str> = whole.lines().collect();
    let short = lines[..1000].join("\n");
    assert!(matches!(flaw(&short), Flaw::Short(s) if (s - 0.312).abs() < 0.001));
    let gap = [&lines[..3000], &lines[3100..]].concat().join("\n");
    assert!(matches!(flaw(&gap), Flaw::Gap(3001, s) if (s - 0.0315).abs() < 0.001));
    let holes: Vec<&str> = lines.iter().enumerate().filter(|(i, _)| i % 100 > 2).map(|(_, line)| *line).collect();
    assert!(matches!(flaw(&[&[lines[0]][..], &holes].concat().join("\n")), Flaw::Lost(part) if part > 0.02));
    let few: Vec<&str> = lines.iter().enumerate().filter(|(i, _)| i % 1500 > 2).map(|(_, line)| *line).collect();
    assert_eq!(read([&[lines[0]][..], &few].concat().join("\n").as_bytes()).unwrap().remarks.len(), 1);
    let slow: Vec<&str> = lines[1..].iter().step_by(16).copied().collect();
    assert!(matches!(flaw(&[&[lines[0]][..], &slow].concat().join("\n")), Flaw::Rate(hz) if (hz - 200.0).abs() < 1.0));
    let milliseconds: String = (0..9000).map(|i| format!("{:.1},{i},0,0\n", f64::from(i) / 3.2)).collect();
    assert!(matches!(flaw(&format!("{HEADER}{milliseconds}")), Flaw::Rate(_)));
    let still: String = (0..9000).map(|i| format!("{:.6},0,0,9806\n", f64::from(i) / 3200.0)).collect();
    assert_eq!(flaw(&format!("{HEADER}{still}")), Flaw::Still);
}

#[test]
fn a_stuck_axis_and_the_end_of_the_range_are_remarked() {
    let stuck: String = (0..9000).map(|i| format!("{:.6},{},0,{}\n", f64::from(i) / 3200.0, i % 7, i % 5)).collect();
    let found = read(format!("{HEADER}{stuck}").as_bytes()).unwrap();
    assert!(found.remarks.len() == 1 && found.remarks[0].starts_with("y has the same"), "{:?}", found.remarks);
    let clip = |i: u32| (f64::from(i) / 9.0).sin().clamp(-0.9, 0.9) * 21_800.0;
    let clipped: String =
        (0..9000).map(|i| format!("{:.6},{},{},{}\n", f64::from(i) / 3200.0, clip(i), i % 3, i % 5)).collect();
    let found = read(format!("{HEADER}{clipped}").as_bytes()).unwrap();
    assert!(found.remarks.len() == 1 && found.remarks[0].starts_with("x reaches"), "{:?}", found.remarks);
}

#[test]
fn files_of_reprap_firmware_are_in_g_and_tell_their_rate() {
    let rows: String =
        (0..4000).map(|i| format!("{i},{:.3},0.0{},1.0{}\n", (f64::from(i) / 5.0).sin(), i % 3, i % 4)).collect();
    let found = read(format!("Sample,X,Y,Z\n{rows}Rate 1344, overflows 0\n").as_bytes()).unwrap();
    assert!((found.rate_hz / 1344.0 - 1.0).abs() < 1e-3 && found.axes[2][0] > 9000.0, "{}", found.rate_hz);
    assert_eq!(flaw(&format!("Sample,X,Y,Z\n{rows}")), Flaw::NoRate);
    assert_eq!(flaw(&format!("Sample,X,Y,Z\n{rows}Rate 1344, overflows 2\n")), Flaw::Overflows(2));
}

/// Files that were cut, spoilt and joined are answered, whatever is in them.
#[test]
fn no_bytes_break_the_reader() {
    let (whole, mut state) = (text("\n").into_bytes(), 0x9E37_79B9_7F4A_7C15_u64);
    let mut next = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    for _ in 0..300 {
        let from = next(whole.len());
        let mut bytes = whole[from..(from + 1 + next(3000)).min(whole.len())].to_vec();
        if next(2) == 0 {
            bytes.splice(..0, HEADER.bytes());
        }
        for _ in 0..next(4) {
            let place = next(bytes.len());
            bytes[place] = b"\0,-.e9n#\n\r \xff"[next(12)];
        }
        // Neither of them is long enough to be whole.
        assert!(read(&bytes).is_err());
    }
}
