//! The stand-in leaves the same state as BTT's bootloader.

use super::*;
use crate::board::Emulated;
use crate::clock_rules::ClockRules;
use crate::eeprom::At24c32;
use crate::flash::FlashSectors;
use crate::wiring::OCTOPUS;
use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::path::Path;

/// Where this test's application writes its findings.
const NOTES: u32 = 0x2000_0000;

/// The application: reads the registers in its list, then PRIMASK and CONTROL, and notes them.
const APPLICATION: [u16; 18] = [
    0x4806, //         ldr r0, =list
    0x4907, //         ldr r1, =notes
    0xC804, // next:   ldmia r0!, {r2}
    0xB11A, //         cbz r2, last
    0x6813, //         ldr r3, [r2]
    0xC108, //         stmia r1!, {r3}
    0xE7FA, //         b next
    0xBF00, //         nop
    0xF3EF, 0x8210, // last: mrs r2, PRIMASK
    0xF3EF, 0x8314, // mrs r3, CONTROL
    0xC10C, //         stmia r1!, {r2, r3}
    0xE7FE, //         b .
    0xBF00, 0xBF00, 0xBF00, 0xBF00, // nop
];

/// The state left behind: the register, and its value after BTT's bootloader (see the table of steps).
const LEFT: [(&str, u32, u32); 20] = [
    // HSI, HSE, PLL and PLLSAI, each on and ready.
    ("RCC_CR", RCC_CR, 0x3303_0083),
    ("RCC_PLLCFGR", RCC_PLLCFGR, 0x2840_2D06),
    // SW and SWS 3 (PLL_R), PPRE1 by 4, PPRE2 by 2.
    ("RCC_CFGR", RCC_CFGR, 0x0000_940F),
    ("RCC_PLLSAICFGR", RCC_PLLSAICFGR, 0x0401_1806),
    // GPIOA, C, D, G, DMA2, and a reserved bit that is set after every reset.
    ("RCC_AHB1ENR", RCC_AHB1ENR, 0x0050_004D),
    // PWR and USART3.
    ("RCC_APB1ENR", RCC_APB1ENR, 0x1004_0000),
    // SDIO.
    ("RCC_APB2ENR", RCC_APB2ENR, 0x0000_0800),
    ("RCC_AHB1RSTR", RCC_AHB1RSTR, 0),
    ("RCC_APB1RSTR", RCC_APB1RSTR, 0),
    ("RCC_APB2RSTR", RCC_APB2RSTR, 0),
    // Scale 1, over-drive on and switched to, all of it ready.
    ("PWR_CR", PWR_CR, 0x0003_C000),
    ("PWR_CSR", PWR_CSR, 0x0003_4000),
    ("FLASH_ACR", FLASH_ACR, 5),
    ("SYST_CSR", SYST_CSR, 0),
    ("SYST_RVR", SYST_RVR, 22_000),
    // 39, 49, 59 and 69.
    ("NVIC_ISER1", NVIC_ISER1, 0x0802_0080),
    ("NVIC_ISER2", NVIC_ISER2, 0x0000_0020),
    ("SCB_VTOR", SCB_VTOR, RESET),
    ("SCB_AIRCR", SCB_AIRCR, 0xFA05_0300),
    ("SCB_CPACR", SCB_CPACR, 0x00F0_0000),
];

/// Runs the stand-in and the application.
struct Watch {
    rules: ClockRules,
    notes: Vec<u32>,
}

impl Driver<Emulated> for Watch {
    fn on_settled(&mut self, session: &mut Session<Emulated>, _host: &mut dyn Host, settled: Settled) {
        if let Settled::Access { access, .. } = settled
            && access.kind == AccessKind::Write
        {
            self.rules.written(session.board_mut(), &access);
        }
    }

    fn on_stop(&mut self, _: &mut Session<Emulated>, stop: Stop, host: &mut dyn Host) -> Option<VirtualNanos> {
        const LONG_ENOUGH: u64 = 5_000_000;
        if stop.at.0 < LONG_ENOUGH {
            return Some(VirtualNanos(LONG_ENOUGH));
        }
        let places = (0..LEFT.len() as u64 + 2).map(|n| u64::from(NOTES) + 4 * n);
        self.notes = places.map(|place| host.read(place, Width::W32).unwrap() as u32).collect();
        None
    }
}

/// The register values that an application finds after `loader`, and the rules broken before it starts.
fn hand_over(loader: Vec<u8>) -> (Vec<u32>, ClockRules) {
    let begin = OCTOPUS.application + 8;
    let mut application: Vec<u8> = [STACK, begin + 1].iter().flat_map(|word| word.to_le_bytes()).collect();
    application.extend(APPLICATION.iter().flat_map(|halfword| halfword.to_le_bytes()));
    let list = begin + 2 * APPLICATION.len() as u32;
    assert_eq!(list % 4, 0);
    application.truncate(application.len() - 8);
    application.extend([list, NOTES].iter().flat_map(|word| word.to_le_bytes()));
    application.extend(LEFT.iter().flat_map(|(_, address, _)| address.to_le_bytes()));
    application.extend([0; 8]);
    let image = |bytes, at: u32| Image::new(Path::new("part"), bytes, Some(at.into())).unwrap();
    let images = [image(loader, RESET), image(application, OCTOPUS.application)];
    let board = Emulated::new(&OCTOPUS, Vec::new(), At24c32::default(), FlashSectors::default()).unwrap();
    let session = Session::new(Box::new(board), 0, VirtualNanos(1)).unwrap();
    let watch = Watch { rules: ClockRules::new(OCTOPUS.hse), notes: Vec::new() };
    let finished = emulator::run(session, &Start::new(&images), watch).unwrap();
    (finished.driver.notes, finished.driver.rules)
}

#[test]
fn it_leaves_the_chip_as_btts_bootloader_does() {
    let (notes, rules) = hand_over(Bootloader::Btt.image(OCTOPUS.application));
    for ((name, _, value), note) in LEFT.iter().zip(&notes) {
        assert_eq!(note, value, "{name}: {note:#010x}, not {value:#010x}");
    }
    // Interrupts are let in, and the floating-point unit has been used.
    assert_eq!(notes[LEFT.len()..], [0, 4]);
    assert_eq!(rules.breaches, []);
}

/// The rules that a bootloader breaks with the steps `to` in place of the steps that begin with `from`.
fn broken_with(from: Step, to: &[Step]) -> String {
    let at = STEPS.iter().position(|step| format!("{step:?}") == format!("{from:?}")).unwrap();
    let steps: Vec<_> = STEPS[..at].iter().chain(to).chain(&STEPS[at + 1..]).copied().collect();
    let breaches = hand_over(image(OCTOPUS.application, &steps)).1.breaches;
    breaches.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// The rules are checked on the emulated chip, too, and not only in the table of registers.
#[test]
fn a_bootloader_that_breaks_a_rule_is_caught() {
    let last = Set(SYST_CSR, ALL, 0);
    let cases = [
        (last, vec![last, Set(PWR_CR, 1 << 17, 0)], "over-drive switched"),
        (last, vec![last, Set(RCC_APB1RSTR, 1 << 28, 1 << 28)], "PWR reset"),
        (last, vec![last, Set(PWR_CR, 3 << 14, 1 << 14)], "VOS changed"),
        (last, vec![last, Set(RCC_PLLCFGR, 3 << 28, 3 << 28)], "PLLCFGR changed"),
        (last, vec![last, Set(FLASH_ACR, 0xF, 4)], "4 wait states of flash, the clock needs 5"),
        (last, vec![last, Set(RCC_CFGR, 0x1C00, 0)], "PCLK1 at 180000000 Hz"),
        (Set(FLASH_ACR, 0xF, 5), vec![], "0 wait states of flash, the clock needs 5"),
        (
            Set(RCC_PLLCFGR, ALL, 6 | 180 << 6 | 1 << 22 | 8 << 24 | 2 << 28),
            vec![Set(RCC_PLLCFGR, ALL, 6 | 180 << 6 | 1 << 22)],
            "PLLR = 0",
        ),
        (Set(RCC_PLLSAICFGR, ALL, 6 | 96 << 6 | 1 << 16 | 4 << 24), vec![], "PLLM = 0"),
    ];
    for (from, to, said) in cases {
        let broken = broken_with(from, &to);
        assert!(broken.contains(said), "{said}: {broken}");
    }
}
