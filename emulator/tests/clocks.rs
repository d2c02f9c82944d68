//! The image takes the clocks over from a bootloader by the rules, and reports if there are no clocks.

use crate::common::{Bench, MS, firmware, print_on};
use corehbot_emulator::bootloader::Bootloader;
use corehbot_emulator::clock_rules::Rule;
use corehbot_emulator::clock_tree::Defect;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;

/// `bx lr; nop`
const RETURN: [u16; 2] = [0x4770, 0xBF00];

/// Bits of RCC_APB1ENR and APB2ENR (RM0390 rev 6, sections 6.3.13 and 6.3.14).
const USART3: u64 = 1 << 18;
const SDIO: u64 = 1 << 11;

/// Says `M105` to an image with the function `name`, if given, replaced by one that does nothing.
fn talk_without(name: Option<&str>) -> Seen {
    let mut firmware: Firmware = firmware();
    if let Some(name) = name {
        let place = firmware.symbol(name).unwrap();
        firmware.patch(place, &RETURN).unwrap();
    }
    print_on(&firmware, "M105\n", &Bench { may_break_rules: true, whole: 20_000 * MS, ..Bench::default() })
}

#[test]
fn the_bootloaders_clocks_are_left_and_180_mhz_come_from_the_crystal() {
    let seen = talk_without(None);
    assert_eq!((seen.end, seen.resets.len(), seen.core_hz), (End::Done, 0, 180_000_000));
    assert_eq!(seen.breaches, []);
    let [_, apb1, apb2] = seen.clocked;
    assert_eq!((apb1 & USART3, apb2 & SDIO), (0, 0), "what the bootloader left on: {apb1:#010x}, {apb2:#010x}");
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
}

/// Shows that the previous test could fail.
#[test]
fn an_image_that_stays_on_the_bootloaders_pll_is_caught() {
    let seen = talk_without(Some("leave_plls"));
    let broken: Vec<_> = seen.breaches.iter().map(|breach| breach.rule).collect();
    println!("{broken:?}");
    assert!(
        [Rule::PowerReset, Rule::OverDrive, Rule::TooFast("HCLK", 180_000_000)]
            .iter()
            .all(|rule| broken.contains(rule)),
        "{broken:?}"
    );
}

/// Fysetc's leaves the data cache on, at 72 MHz of the PLL.
#[test]
fn the_image_starts_after_fysetcs_bootloader_by_the_rules() {
    let mut firmware = firmware();
    firmware.bootloader = Bootloader::Fysetc;
    let seen = print_on(&firmware, "M105\n", &Bench { whole: 2000 * MS, ..Bench::default() });
    assert_eq!((seen.end, seen.resets.len(), seen.core_hz), (End::Done, 0, 180_000_000), "{:?}", seen.line.said);
    assert_eq!(seen.breaches, []);
}

#[test]
fn an_interrupt_that_a_bootloader_left_is_lost() {
    let mut firmware = firmware();
    firmware.bootloader = Bootloader::Careless;
    let seen = print_on(&firmware, "M105\n", &Bench { whole: 2000 * MS, ..Bench::default() });
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0), "{:?}", seen.line.said);
    assert!(seen.line.said.iter().all(|line| !line.contains("the last reset")), "{:?}", seen.line.said);
}

/// The messages of an image with `defect`; it sends nothing else and gives nothing power.
fn said_with(defect: Defect) -> Vec<String> {
    let seen = print_on(&firmware(), "M105\n", &Bench { defect, whole: 900 * MS, ..Bench::default() });
    assert_eq!((seen.end, seen.resets.len(), seen.started), (End::Late, 0, None), "{:?}", seen.line.said);
    // The host's rate is met without the crystal, too.
    seen.check_baud(250_000).unwrap();
    assert!(seen.safety.dangers.is_empty() && seen.safety.switched.is_empty());
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    seen.line.said
}

#[test]
fn a_crystal_that_does_not_start_is_reported_again_and_again() {
    let said = said_with(Defect::Crystal);
    assert!(said.len() >= 2, "{said:?}");
    assert!(said.iter().all(|line| line == "Error:the crystal of 12 MHz does not start, this board cannot print"));
}

#[test]
fn a_pll_that_does_not_lock_is_reported_again_and_again() {
    let said = said_with(Defect::Pll);
    assert!(said.len() >= 2, "{said:?}");
    assert!(said.iter().all(|line| line == "Error:the PLL does not lock, this board cannot print"));
}

#[test]
fn a_supply_without_over_drive_is_reported_again_and_again() {
    let said = said_with(Defect::OverDrive);
    assert!(said.len() >= 2, "{said:?}");
    let told = "Error:the supply of the processor has no over-drive, this board cannot print";
    assert!(said.iter().all(|line| line == told), "{said:?}");
}
