//! Tests of input.

use super::*;

fn opened(bytes: &[u8]) -> Result<Survey> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.gcode");
    std::fs::write(&path, bytes).unwrap();
    GcodeFile::open(&path, Plate::default())?.survey(|_| Ok(()))
}

#[test]
fn a_comment_may_have_any_length_and_a_command_may_not() {
    let mut text = b"G28\nG1 X5 ;".to_vec();
    text.resize(5 << 20, b'x');
    text.extend(b"\nG1 X6\n");
    assert_eq!(opened(&text).unwrap(), Survey { lines: 3, commands: 3 });
    let error = opened(&vec![b'G'; 3 << 20]).unwrap_err();
    assert!(format!("{error:#}").contains("line 1 is longer"), "{error:#}");
}

#[test]
fn what_is_no_text_is_refused_with_the_way_out() {
    let utf16 = |bytes: fn(u16) -> [u8; 2]| "G28\nG1 X5\n".encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let marked: Vec<u8> = [vec![0xFF, 0xFE], utf16(u16::to_le_bytes)].concat();
    let cases: [(&[u8], &str); 11] = [
        (b"GCDE\x01\0\0\0", "its end is missing"),
        (b"PK\x03\x04\x14\0", "no whole ZIP archive"),
        (b"\x1f\x8b\x08\0", "its end is missing"),
        (b"[printer]\nkinematics: none\n", "corehbot config from"),
        (&marked, "iconv -f UTF-16"),
        (&utf16(u16::to_le_bytes), "iconv -f UTF-16"),
        (&utf16(u16::to_be_bytes), "iconv -f UTF-16"),
        (b"solid cube\n", "slice it"),
        (b"G28\n\0\x01\x02\x03\n", "binary data"),
        (b"\0\0\0\0\0\0", "binary data"),
        (b"%PDF-1.7\n", "PDF"),
    ];
    for (bytes, way_out) in cases {
        let error = format!("{:#}", opened(bytes).unwrap_err());
        assert!(error.contains(way_out) && !error.contains('\n'), "{error}");
    }
    assert_eq!(opened(b"G28 \r\nG1 X5\r\r\n").unwrap(), Survey { lines: 2, commands: 2 });
    assert_eq!(opened(b";old\rG28\rG1 X5\rG1 X6\r").unwrap(), Survey { lines: 4, commands: 3 });
    let late = [b"; text\n".repeat(200), b"G1 X\0\n".to_vec()].concat();
    assert!(format!("{:#}", opened(&late).unwrap_err()).contains("line 201"));
    assert_eq!(opened(b"").unwrap(), Survey::default());
}
