//! G-code against independent models: long-hand decimal arithmetic, and its own printed form.

use crate::support::bodies;
use crate::support::print::{Printed, reduced};
use corehbot::gcode::{Command, MoveCommand, Number};
use corehbot::machine::{codes, names, parse};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Decimal text as the nearest multiple of 2^-32. The written digits are doubled: bit after bit of the fraction falls
/// out on the left, as in long multiplication by hand.
fn by_hand(is_negative: bool, integer: &str, fraction: &str) -> i64 {
    const LIMIT: i128 = 1_000_000_000 << 32;
    let mut digits: Vec<u8> = fraction.bytes().map(|digit| digit - b'0').collect();
    let mut double = || {
        let mut carry = 0;
        for digit in digits.iter_mut().rev() {
            let sum = 2 * *digit + carry;
            *digit = sum % 10;
            carry = sum / 10;
        }
        i128::from(carry)
    };
    let integer = integer.bytes().fold(0, |sum, digit| (sum * 10 + i128::from(digit - b'0')).min(LIMIT));
    let bits = (0..32).fold(integer, |bits, _| bits * 2 + double());
    let bits = (bits + double()).min(LIMIT);
    i64::try_from(if is_negative { -bits } else { bits }).unwrap()
}

fn read(text: &str) -> Number {
    let (number, rest) = Number::read(text.as_bytes()).unwrap();
    assert!(rest.is_empty(), "{text} left {rest:?}");
    number
}

/// The command of a line in its canonical form.
fn printed(line: &str) -> String {
    Printed(parse(line.as_bytes()), line.as_bytes()).to_string()
}

/// The number of a G1 line's X word.
fn x_of(line: &str) -> Option<Number> {
    match parse(line.as_bytes()) {
        Command::Move(MoveCommand::Line { to, .. }) => to.x,
        other => panic!("{line} became {other:?}"),
    }
}

#[test]
fn the_canonical_form() {
    for (line, canonical) in [
        ("g1x.5y-12.300e-.04f1800", "G1 X0.5 Y-12.3 E-0.04 F1800"),
        ("G3 Z.76 I.194 J1.201 P1  F30000", "G3 Z0.76 I0.194 J1.201 F30000"),
        ("M84 S0", "M84 S0"),
        ("M205 J.02 X8", "M205 J.02 X8"),
        ("M118 E1 \u{a0}h\u{fc}", "M118 E1   h??"),
        ("say \u{fc}", "say ??"),
    ] {
        assert_eq!(printed(line), canonical);
    }
}

struct Reduced(&'static str);

impl std::fmt::Display for Reduced {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        reduced(f, self.0.as_bytes())
    }
}

/// The form of commands that have none of their own.
#[test]
fn a_line_of_numbers_is_reduced_to_the_last_word_of_each_letter() {
    for (line, expected) in [
        ("m73 p5r 12 P6 ; x", "M73 R12 P6"),
        ("M207S1 (F3) F-.5 \"Z9\" z+2", "M207 S1 F-.5 Z+2"),
        ("M204 M1 P1", "M204 M1 P1"),
    ] {
        assert_eq!(Reduced(line).to_string(), expected);
    }
    for line in ["M207 S1 S2 F1800 Z.2", "M73 R5 P1 P2", "M302 P1 S170 S171"] {
        assert_eq!(parse(Reduced(line).to_string().as_bytes()), parse(line.as_bytes()), "{line}");
    }
}

/// Something like a number: as slicers write it, with too many digits, or broken.
fn number_text() -> impl Strategy<Value = String> {
    prop_oneof!["[+-]?[0-9]{0,3}\\.?[0-9]{0,5}", "[+-]?[0-9]{1,12}\\.[0-9]{0,45}", "[0-9.+-]{0,8}",]
}

/// Beginnings of a line: codes with words, and others like codes. Those that are known are added to them.
#[rustfmt::skip]
const CODES: &[&str] = &[
    "g1", "G01", "M569 S1 X Y", "M906 X800 Z900", "M913 X100.5", "M914 Y70", "M915 D R", "T3", "T300", "M862.3",
    "M593 X F60 D0.1 T2", "M593 F0", "M572 S0.05 W0.04", "M572 W0", "M900 K1e-05",
    "SET_VELOCITY_LIMIT ACCEL=500 ACCEL_TO_DECEL=250", "SET_VELOCITY_LIMIT VELOCITY=",
    "SET_PRESSURE_ADVANCE ADVANCE=0.05", "M593 P\"mzv\"", "M302 S170", "MACHINE_PUT AT=24 HEX=00ff",
    "STEPPER_BUZZ STEPPER=m1 FREE=m8",
    "TEST_RESONANCES AXIS=1,-1 FREQ_START=20 FREQ_END=80.5 ACCEL_PER_HZ=3e1 OUTPUT=raw_data",
    "M303 E-1 S60 U1", "M190 R60", "M306 E-1 A0.08 F0.1", "M306 T", "M710 R", "M221 T1", "M84 E1", "M301 E1",
    "M572 D1", "M900 S1 L2", "M906 I1 T2", "M140 P1 H2 I3", "M104 I1", "M116 P1",
    "SET_PRESSURE_ADVANCE EXTRUDER=extruder1", "M118 A1", "M118 E1", "EXCLUDE_OBJECT_DEFINE NAME=x",
    "EXCLUDE_OBJECT_START NAME=x", "if {1 > 2}", "elif true", "while true", "abort \"x\"", "EXCLUDE_OBJECT NAME=x",
    "print_end", "M1234567", "(x) G1", "M28 a.gco",
];

/// Beginnings of a line: every known code, and others like them.
fn beginnings() -> Vec<String> {
    let codes = codes().map(|(letter, number)| format!("{letter}{number}"));
    codes.chain(names().map(str::to_owned)).chain(CODES.iter().map(|code| (*code).to_owned())).collect()
}

/// A line that is probably a command.
fn line() -> impl Strategy<Value = String> {
    let word = ("[XYZEFSPRTIJKBCDGMxyzesN]", "[ \t]?", number_text(), "[ ]{0,2}")
        .prop_map(|(letter, gap, number, after)| letter + &gap + &number + &after);
    let extra = prop_oneof![
        8 => Just(String::new()),
        1 => "\"[ -~]{0,9}\"?",
        1 => "[;(][ -~]{0,9}",
        1 => "[ -~]{0,9}",
    ];
    (proptest::sample::select(beginnings()), "[ ]?", proptest::collection::vec((word, extra), 0..6)).prop_map(
        |(code, gap, words)| {
            let words: String = words.into_iter().map(|(word, extra)| word + &extra).collect();
            code + &gap + &words
        },
    )
}

/// Reproducer: rubbish that stands alone, with a letter in it.
#[test]
fn rubbish_hides_the_letters_in_it() {
    bodies::gcode(b"M114 I -..5-  )r.zS4 y-3(~:YR+3 Y -+- ");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn numbers_are_correctly_rounded(
        is_negative: bool,
        integer in "0{0,3}[0-9]{1,12}",
        fraction in prop_oneof!["[0-9]{0,9}", "[0-9]{8,50}", "0{8,12}[0-9]{20,30}"],
    ) {
        let text = format!("{}{integer}.{fraction}", if is_negative { "-" } else { "" });
        prop_assert_eq!(read(&text).value().to_bits(), by_hand(is_negative, &integer, &fraction));
    }

    #[test]
    fn numbers_next_to_a_tie_go_the_right_way(step in 0u64..1 << 32, nudge in 0i8..3) {
        // (2 step + 1) / 2^33 has 33 decimals: (2 step + 1) * 5^33 / 10^33, written out.
        let mut digits = [0u8; 33];
        for bit in format!("{:033b}", 2 * step + 1).bytes() {
            // Halving the remaining bits is doubling the present ones: digits = digits * 2 + bit, in units of 5^33.
            let mut carry = 0;
            for digit in digits.iter_mut().rev() {
                let sum = 2 * *digit + carry;
                *digit = sum % 10;
                carry = sum / 10;
            }
            if bit == b'1' {
                let mut carry = 0;
                for (digit, add) in digits.iter_mut().rev().zip(FIVE_TO_33.bytes().rev().chain(std::iter::repeat(b'0'))) {
                    let sum = *digit + (add - b'0') + carry;
                    *digit = sum % 10;
                    carry = sum / 10;
                }
            }
        }
        let mut text: String = digits.iter().map(|digit| char::from(b'0' + digit)).collect();
        match nudge {
            // Just below: one unit less in the last place, and nines after it.
            0 => {
                let last = text.pop().unwrap();
                prop_assert_eq!(last, '5');
                text += "4999999999";
            }
            1 => {}
            _ => text += "0000000001",
        }
        let expected = step as i64 + i64::from(nudge > 0);
        prop_assert_eq!(read(&format!("0.{text}")).value().to_bits(), expected);
        prop_assert_eq!(by_hand(false, "0", &text), expected);
    }

    #[test]
    fn a_printed_number_reads_back_to_the_bit(bits: i64) {
        let number = Number::saturating(fixed::types::I32F32::from_bits(bits));
        prop_assert_eq!(read(&number.to_string()), number);
    }

    #[test]
    fn a_number_is_printed_no_longer_than_it_was_written(integer in 0u32..1_000_000_000, decimals in 0u32..100_000) {
        let text = format!("{integer}.{decimals:05}");
        let shortest = text.trim_end_matches('0').trim_end_matches('.');
        prop_assert_eq!(read(&text).to_string(), shortest);
    }

    #[test]
    fn no_line_panics_or_changes_by_printing(line in line()) {
        bodies::gcode(line.as_bytes());
    }

    #[test]
    fn no_bytes_panic_or_change_by_printing(line in proptest::collection::vec(any::<u8>(), 0..80)) {
        bodies::gcode(&line);
    }

    #[test]
    fn near_misses_do_not_panic(line in "[GMT][0-9.]{1,4}[ XYZEFSPR0-9.+*;()\"\\\\\t_-]{0,40}") {
        bodies::gcode(line.as_bytes());
    }

    #[test]
    fn spacing_and_case_do_not_matter(
        words in proptest::collection::vec(("[XYZEF]", "-?[0-9]{1,4}(\\.[0-9]{1,4})?"), 0..6),
        gap in "[ \t]{0,3}",
    ) {
        let plain: String = words.iter().map(|(letter, number)| format!(" {letter}{number}")).collect();
        let odd: String = words.iter().map(|(letter, number)| format!("{letter}{gap}{number}{gap}")).collect();
        let expected = printed(&format!("G1{plain}"));
        prop_assert_eq!(printed(&format!("G1{odd}")), expected.clone());
        prop_assert_eq!(printed(&format!("g1{odd};X99").to_lowercase()), expected);
    }
}

const FIVE_TO_33: &str = "116415321826934814453125";

#[test]
fn every_number_of_five_decimals_is_nearest() {
    for decimals in 0..100_000i128 {
        let nearest = ((decimals << 33) + 100_000) / 200_000;
        let bits = read(&format!("0.{decimals:05}")).value().to_bits();
        assert_eq!(i128::from(bits), nearest);
    }
}

#[test]
fn forms_that_slicers_and_people_write() {
    let ten = Some(Number::from(10));
    for line in ["G1X10", "G1 X 10", "G1  X  10", "g1 x10", "G1 X10.", "G1 X+10", "G1 X010", "G1\tX10", "G1 Y3X10"] {
        assert_eq!(x_of(line), ten, "{line}");
    }
    assert_eq!(x_of("G1 X.5"), Some(read("0.5")));
    assert_eq!(x_of("G1 X-.5"), Some(read("-0.5")));
    for line in ["G1", "G1 ;X10", "G1 (X10)", "G1 \"X10\"", "G1 Y5 (X10) ;X11"] {
        assert_eq!(x_of(line), None, "{line}");
    }
    assert_eq!(x_of("G1 X99999999999999999999"), Some(Number::from(1_000_000_000)));
    assert_eq!(x_of("G1 X-99999999999999999999"), Some(Number::from(-1_000_000_000)));
}

#[test]
fn a_word_that_is_none_makes_the_line_do_nothing() {
    for word in [
        "X", "X-", "X.", "Xnan", "Xinf", "Xabc", "X1,5", "X1.2.3", "X--5", "X=5", "X10\x01", "\x02X10", "X\"10\"",
        "X1*", "X\u{e4}", "X5 X", "X10 Y", "X 1,5", "U5", "G1 X5", "M5",
    ] {
        for line in [format!("G1 {word}"), format!("G0 Y5 {word} Z2"), format!("G1{word}F1800")] {
            if line.starts_with("G1\x02") {
                // That is not even a G1.
                assert!(matches!(parse(line.as_bytes()), Command::Unknown(_)));
                continue;
            }
            assert!(matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line:?}");
        }
    }
    for line in ["G1X1Y2 F3,", "G92 X1,5", "G28 X,", "M203 X1,5", "M204 P", "G4 P-1", "M84 S-1", "M593 F-5", "G92 C0"] {
        assert!(matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line:?}");
    }
}

#[test]
fn a_no_break_space_is_a_space_and_a_byte_order_mark_is_nothing() {
    assert_eq!(parse("\u{feff}G1\u{a0}X10\u{a0}Y\u{a0}20 ".as_bytes()), parse(b"G1 X10 Y20"));
}

#[test]
fn an_exponent_is_an_extruder_word() {
    let Command::Move(MoveCommand::Line { to, .. }) = parse(b"G1 X1E5") else { panic!() };
    assert_eq!((to.x, to.e), (Some(Number::from(1)), Some(Number::from(5))));
}

/// Codes that accept any text after them, by reason; the last two reasons are checked.
const ANY_TEXT: [&[&str]; 5] = [
    // They must act in any case.
    &["M81", "M108", "M110", "M112", "M410", "M524", "M999"],
    // A text for people, a name or a version follows.
    &[
        "M0", "M1", "M28", "M29", "M115", "M117", "M118", "M486", "M600", "M601", "M862", "M876", "M125", "M605",
        "M1002",
    ],
    // They take no words, so none can be misread.
    &["M24", "M25", "M75", "M77", "M105", "M114", "M119", "M122", "M500", "M501", "M502", "M503", "M504", "M602"],
    // They are answered and not carried out.
    &["M622", "M623"],
    // The machine has nothing to do for them (`silent`).
    &[
        "G12", "M2", "M20", "M21", "M74", "M76", "M80", "M142", "M150", "M202", "M217", "M240", "M300", "M355", "M403",
        "M425", "M530", "M532", "M870", "M907",
    ],
];

/// Every code of G0 to G999 and M0 to M999 that is a command.
fn known_codes() -> impl Iterator<Item = String> {
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..10_000).map(move |number| format!("{letter}{number}")));
    codes.filter(|code| !matches!(parse(code.as_bytes()), Command::Unknown(_)))
}

#[test]
fn every_known_code_and_name_is_thrown_at_the_parser() {
    let thrown = beginnings();
    let is_thrown = |code: &String| thrown.iter().any(|line| line.split([' ', '.']).next() == Some(code));
    let missing: Vec<_> = known_codes().chain(names().map(str::to_owned)).filter(|code| !is_thrown(code)).collect();
    assert!(missing.is_empty(), "{missing:?} in the table of src/machine/commands/table.rs");
}

/// Named commands report errors in their words by their own reader, as `ACCEL=fast`.
#[test]
fn a_name_that_goes_on_is_another_name() {
    for name in names() {
        for other in [format!("{name}5"), format!("{name}S"), format!("{name}_")] {
            assert!(names().any(|name| name == other) || parse(other.as_bytes()) == Command::Unknown(other.as_bytes()));
        }
    }
}

/// A line with a mistake does nothing, unless its command is listed here.
#[test]
fn a_code_without_a_row_in_the_grammar_takes_any_text_for_a_reason() {
    let is_obeyed = |code: &String| !matches!(parse(format!("{code} ?!").as_bytes()), Command::Malformed(_));
    let [.., answered, silent] = ANY_TEXT;
    for code in answered {
        let command = parse(code.as_bytes());
        assert_eq!(command, Command::Condition, "{code} does something: a grammar in its row");
    }
    for code in silent {
        assert_eq!(parse(code.as_bytes()), Command::Silent, "{code} does something: a grammar in its row");
    }
    let obeyed: BTreeSet<_> = known_codes().filter(is_obeyed).collect();
    let any_text: BTreeSet<_> = ANY_TEXT.concat().into_iter().map(str::to_owned).collect();
    let different: Vec<_> = obeyed.symmetric_difference(&any_text).collect();
    assert!(different.is_empty(), "{different:?}: a grammar in its row, or a place in ANY_TEXT");
}

/// Forms of a word that people and slicers write: lists, fractions, signs, texts, expressions of other firmwares.
const ODD_FORMS: [&str; 13] =
    ["0:1", "1:2:3", "0,1", "-3", "-0.5:+1", "0.03", "1.2.3", "--5", "\"a b\"", "=5", "=[1,2]", "{x}", "#1"];

/// *Reproducer*: `M900 K0.02 T0.03` and `M572 D0:1 S0.026` set no pressure advance, in presets that many people print
/// with. The document says which letters a command has; all others are ignored, whatever stands behind them.
#[test]
fn a_letter_that_the_reference_does_not_name_is_ignored_in_every_form() {
    let reference = include_str!("../docs/reference/gcode.md");
    let (mut codes, mut lines) = (0, 0);
    let all: BTreeSet<_> = known_codes().collect();
    for row in reference.lines().filter_map(|line| line.strip_prefix("| ")) {
        let cells: Vec<_> = row.split('|').map(str::trim).collect();
        for code in cells[0].split(", ").filter(|code| all.contains(*code)) {
            codes += 1;
            let alone = parse(code.as_bytes());
            // In "Accepted silently" the second cell is the reason, and no letter is named.
            let words = if cells.len() > 3 { cells[1] } else { "" };
            for letter in ('A'..='Z').filter(|letter| !words.contains(*letter)) {
                let is_same = |form: &str| parse(format!("{code} {letter}{form}").as_bytes()) == alone;
                // Refused or told by other rules: an axis that there is not, a part, a second command, a text.
                if !["", "0", "7"].into_iter().all(is_same) {
                    continue;
                }
                for form in ODD_FORMS {
                    assert!(is_same(form), "{code} {letter}{form}");
                    lines += 1;
                }
            }
        }
    }
    assert!(codes > 130 && lines > 35_000, "{codes} {lines}");
    // Next to words that count, on either side.
    for (line, same) in [
        ("M900 K0.02 T0.03", "M900 K0.02"),
        ("M900 T0.03 K0.02", "M900 K0.02"),
        ("M572 D0:1 S0.026", "M572 S0.026"),
        ("M572 S0.026 D1:0", "M572 S0.026"),
        ("M221 T0:1 S95", "M221 S95"),
        ("M92 X80 E420.5:430", "M92 X80 E420.5"),
        ("M906 E800:700 X900", "M906 E800 X900"),
        ("M104 Q0,1 S200", "M104 S200"),
        ("G28 X Q0:1 Y", "G28 X Y"),
        ("G1 X10 Q0:1Y20 F600", "G1 X10 Y20 F600"),
        ("G1 X10 Q\"a; b\" Y20", "G1 X10 Y20"),
        ("M204 P500 N--1 T700", "M204 P500 T700"),
        ("M205 X8 Q=1 E5", "M205 X8 E5"),
        ("G29 K1:2 P1 X10 Y10 W50 H50", "G29 P1 X10 Y10 W50 H50"),
    ] {
        assert_eq!(parse(line.as_bytes()), parse(same.as_bytes()), "{line}");
        assert!(!matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line}");
    }
    for line in [
        "SET_GCODE_OFFSET Z=0.1 MOVE_SPEED=fast",
        "Z_TILT_ADJUST RETRIES=3 HORIZONTAL_MOVE_Z=auto",
        "SET_PRESSURE_ADVANCE ADVANCE=0.03 NOTE=\"a b=c\"",
        "BED_MESH_CALIBRATE PROFILE=\"my bed\" ADAPTIVE=1",
    ] {
        assert!(matches!(parse(line.as_bytes()), Command::Table(_)), "{line}");
    }
    // A list of parts that are not there, a list where a single number is meant, and damaged bytes are refused.
    for line in
        ["M572 D1:2 S0.026", "M104 S200:100", "G1 X10:20 Y5", "M92 X80:80", "M104 S200 Q1\u{7}", "M900 T1 K0.02"]
    {
        assert!(matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line}");
    }
}
