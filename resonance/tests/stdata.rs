//! Files of Shake&Tune: several recordings in one, packed by zstd.

use corehbot_resonance::label;
use corehbot_resonance::recording::Flaw;
use corehbot_resonance::run::run;
use corehbot_resonance::stdata::{Contents, HEAD, read};

/// Two runs of 2 s at 800 Hz with 50 Hz along x, of 1000 and of 500 mm/s^2; made by zstd itself (`zstd -3`).
const TWO_RUNS: &[u8] = include_bytes!("files/two_runs.stdata");

/// A frame of RFC 8878 with its content in raw blocks.
fn packed(content: &[u8]) -> Vec<u8> {
    // No sizes and no checksum; a window of 2 MiB.
    let mut frame = [HEAD, &[0, 0x58]].concat();
    let blocks: Vec<&[u8]> = content.chunks(100_000).collect();
    for (i, block) in blocks.iter().enumerate() {
        let header = u32::from(i + 1 == blocks.len()) | (block.len() as u32) << 3;
        frame.extend_from_slice(&header.to_le_bytes()[..3]);
        frame.extend_from_slice(block);
    }
    frame
}

#[test]
fn all_recordings_of_a_file_are_read_with_their_names() {
    let Contents { recordings: found, left_out } = read(TWO_RUNS).unwrap();
    assert_eq!((found.len(), left_out), (2, Vec::new()));
    for ((name, recording), (angle, amplitude)) in found.iter().zip([(0.0, 1000.0), (90.0, 500.0)]) {
        assert_eq!(label::run(name), Some((angle, 100.0)), "{name}");
        assert!((recording.rate_hz / 800.0 - 1.0).abs() < 1e-3 && recording.axes[0].len() == 1600, "{name}");
        // A sine of this amplitude.
        let vibration = run(name, [angle, 100.0], recording).unwrap();
        assert!((vibration.vibration_mm_s2 / (amplitude / f64::sqrt(2.0)) - 1.0).abs() < 0.02, "{vibration:?}");
        assert!((vibration.loudest_hz - 50.0).abs() < 2.0, "{vibration:?}");
    }
}

#[test]
fn a_file_that_is_cut_or_of_another_kind_is_refused_in_words() {
    let flaw = |bytes: &[u8]| read(bytes).unwrap_err();
    for end in [4, 5, 20, TWO_RUNS.len() / 2, TWO_RUNS.len() - 1] {
        let told = flaw(&TWO_RUNS[..end]).to_string();
        assert!(told.contains("broken"), "{end}: {told}");
    }
    assert_eq!(flaw(&packed(b"\n")), Flaw::Empty);
    assert!(flaw(&packed(b"\x80\x05\x95")).to_string().contains("only Python reads"));
    let line = flaw(&packed(b"{\"name\": \"axis_X\", \"samples\": [[0, 1, 2]]}\n"));
    assert!(matches!(line, Flaw::Json(1, _)), "{line}");
    // A flaw of the only recording is told with its name.
    let short =
        flaw(&packed(b"{\"name\": \"axis_X\", \"samples\": [[0, 1, 2, 3], [0.001, 1, 2, 3], [0.001, 1, 2, 3]]}"));
    assert_eq!(short, Flaw::In("axis_X".to_owned(), Box::new(Flaw::Backwards(3, 0.001, 0.001))));
    assert!(short.to_string().starts_with("axis_X: "), "{short}");
}

/// Two frames, one after the other, are one file, as of `cat`.
#[test]
fn frames_follow_each_other() {
    assert_eq!(read(&[TWO_RUNS, TWO_RUNS].concat()).unwrap().recordings.len(), 4);
}

#[test]
fn a_short_run_is_left_out_and_the_others_stay() {
    let short = packed(
        b"{\"name\": \"vib_an0_00sp300_00n1\", \"samples\": [[0, 1, 2, 3], [0.001, 2, 2, 3], [0.002, 1, 2, 3]]}\n",
    );
    // Lines of both frames follow each other.
    for file in [[&short[..], TWO_RUNS].concat(), [TWO_RUNS, &packed(b"\n"), &short].concat()] {
        let Contents { recordings, left_out } = read(&file).unwrap();
        assert_eq!(recordings, read(TWO_RUNS).unwrap().recordings);
        assert_eq!(left_out, [Flaw::In("vib_an0_00sp300_00n1".to_owned(), Box::new(Flaw::Short(0.002)))]);
    }
}
