//! Whatever a host says and whatever breaks: no target above its limit, and no power without a target, after a stop or
//! without a sensor.

use crate::common::wild_gcode as body;
use body::heat_gcode;
use proptest::prelude::*;

/// Lines that heat, set values for heating, stop it or wait, some of them wrong; pauses and breakages.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let line = |text: &'static str| text.prop_map(|text| (text + "\n").into_bytes());
    prop_oneof![
        6 => line("M(104|109|140|190) ?[SR]-?[0-9]{1,3}(\\.[0-9]{0,2})?( T[0-9])?"),
        2 => line("M30[1346] (E-?[01] )?[PIDCAFRLSHU]-?[0-9]{0,4}(\\.[0-9]{1,3})?( [PIDCAFRLSHU][0-9]{1,5})?"),
        2 => line("M(81|105|106|107|108|112|116|122|302|410|500|501|502|503|600|710|999)( [PSUE][0-9]{0,9})?"),
        1 => line("SELF_TEST"),
        2 => line("G(1 [XYE]-?[0-9]{1,3} F6000|28|4 S1|92 E0)"),
        1 => line("[ -~]{0,40}"),
        1 => proptest::collection::vec(any::<u8>(), 0..20),
        4 => any::<u8>().prop_map(|pause| vec![0xFD, pause]),
        1 => any::<u8>().prop_map(|what| vec![0xFC, what]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn nothing_that_is_said_heats_what_must_not(pieces in proptest::collection::vec(piece(), 0..30)) {
        heat_gcode(&pieces.concat());
    }
}
