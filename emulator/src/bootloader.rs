//! Stand-ins for bootloaders: each leaves the chip in the same state as the bootloader of BTT or Fysetc.
//!
//! The state after BTT's bootloader was read from its machine code, `DFU Update bootloader/bootload/F446/bootload.hex`
//! of github.com/bigtreetech/BIGTREETECH-OCTOPUS-V1.0. The addresses in `STEPS` are addresses of its instructions.
//! Registers and bits follow RM0390 rev 6 and PM0214 rev 10. The bootloader looks for a card (there is none here) and
//! sets up a USART for a Wi-Fi module. Then it resets the peripherals that it has used, and jumps. Interrupts stay
//! enabled, clocks stay on, and the processor runs at 180 MHz from the PLL's output R with over-drive.
//!
//! The real bootloader takes 1.38 s for that, in delay loops of 200 + 100 + 1000 + 10 + 100 ms. These loops count 22
//! instead of 22.5 ticks a microsecond (0x044c). The stand-in does not wait.

use std::iter;

/// The end of RAM, where the first stack is.
const STACK: u32 = 0x2002_0000;

/// Where the chip reads its first vector table.
pub const RESET: u32 = 0x0800_0000;

/// An action of the bootloader on one register.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Gives bits of the register at the address a value.
    Set(u32, u32, u32),
    /// Waits until bits of the register at the address have a value.
    Await(u32, u32, u32),
}

use Step::{Await, Set};

const ALL: u32 = u32::MAX;

const GPIOA_MODER: u32 = 0x4002_0000;
const PWR_CR: u32 = 0x4000_7000;
const PWR_CSR: u32 = 0x4000_7004;
const RCC_CR: u32 = 0x4002_3800;
const RCC_PLLCFGR: u32 = 0x4002_3804;
const RCC_CFGR: u32 = 0x4002_3808;
const RCC_AHB1RSTR: u32 = 0x4002_3810;
const RCC_APB1RSTR: u32 = 0x4002_3820;
const RCC_APB2RSTR: u32 = 0x4002_3824;
const RCC_AHB1ENR: u32 = 0x4002_3830;
const RCC_APB1ENR: u32 = 0x4002_3840;
const RCC_APB2ENR: u32 = 0x4002_3844;
const RCC_PLLSAICFGR: u32 = 0x4002_3888;
const RCC_DCKCFGR2: u32 = 0x4002_3894;
const FLASH_ACR: u32 = 0x4002_3C00;
const SYST_CSR: u32 = 0xE000_E010;
const SYST_RVR: u32 = 0xE000_E014;
const SYST_CVR: u32 = 0xE000_E018;
const NVIC_ISER1: u32 = 0xE000_E104;
const NVIC_ISER2: u32 = 0xE000_E108;
const SCB_VTOR: u32 = 0xE000_ED08;
const SCB_AIRCR: u32 = 0xE000_ED0C;
const SCB_CPACR: u32 = 0xE000_ED88;

/// The bootloader's actions, in its order.
const STEPS: &[Step] = &[
    // 0x3848: coprocessors on, VTOR its own.
    Set(SCB_CPACR, 0xF << 20, 0xF << 20),
    Set(SCB_VTOR, ALL, RESET),
    // 0x3788: PWR clocked, voltage scale 1.
    Set(RCC_APB1ENR, 1 << 28, 1 << 28),
    Set(PWR_CR, 3 << 14, 3 << 14),
    // 0x37c8: crystal, PLL with M, N, P, Q, R of 6, 180, 2, 8, 2.
    Set(RCC_CR, 1 << 16, 1 << 16),
    Await(RCC_CR, 1 << 17, 1 << 17),
    Set(RCC_PLLCFGR, ALL, 6 | 180 << 6 | 1 << 22 | 8 << 24 | 2 << 28),
    Set(RCC_CR, 1 << 24, 1 << 24),
    Await(RCC_CR, 1 << 25, 1 << 25),
    // 0x1104: over-drive.
    Set(PWR_CR, 1 << 16, 1 << 16),
    Await(PWR_CSR, 1 << 16, 1 << 16),
    Set(PWR_CR, 1 << 17, 1 << 17),
    Await(PWR_CSR, 1 << 17, 1 << 17),
    // 0x37f6: five wait states, without caches; PLL_R; APB1 by 4, APB2 by 2.
    Set(FLASH_ACR, 0xF, 5),
    Set(RCC_CFGR, 0xFC00, 0xFC00),
    Set(RCC_CFGR, 3, 3),
    Await(RCC_CFGR, 0xC, 0xC),
    Set(RCC_CFGR, 0x1C00, 0x1400),
    Set(RCC_CFGR, 0xE000, 0x8000),
    // 0x3816: 48 MHz from PLLSAI with M, N, P, Q of 6, 96, 4, 4.
    Set(RCC_PLLSAICFGR, ALL, 6 | 96 << 6 | 1 << 16 | 4 << 24),
    Set(RCC_CR, 1 << 28, 1 << 28),
    Await(RCC_CR, 1 << 29, 1 << 29),
    Set(RCC_DCKCFGR2, ALL, 1 << 27),
    // 0x5060: priorities of four bits.
    Set(SCB_AIRCR, ALL, 0x05FA_0300),
    // 0x2658: GPIOA, for an LED on PA13.
    Set(RCC_AHB1ENR, 1, 1),
    // 0x27b4: SDIO, GPIOC and D, DMA2; interrupts 49, 59 and 69.
    Set(RCC_APB2ENR, 1 << 11, 1 << 11),
    Set(RCC_AHB1ENR, 1 << 22 | 0xC, 1 << 22 | 0xC),
    Set(NVIC_ISER1, ALL, 1 << (49 - 32) | 1 << (59 - 32)),
    Set(NVIC_ISER2, ALL, 1 << (69 - 64)),
    // 0x04f4: GPIOD and G, and 0x38ac: USART3 with interrupt 39.
    Set(RCC_AHB1ENR, 0x48, 0x48),
    Set(NVIC_ISER1, ALL, 1 << (39 - 32)),
    Set(RCC_APB1ENR, 1 << 18, 1 << 18),
    // 0x0480: the last wait leaves SysTick stopped with the count of a millisecond.
    Set(SYST_RVR, ALL, 22_000),
    Set(SYST_CVR, ALL, 0),
    Set(SYST_CSR, ALL, 0),
    // 0x565c: GPIOA, C, D, G, SDIO, DMA2 and USART3 reset; their clocks stay on.
    Set(RCC_AHB1RSTR, 0x4D, 0x4D),
    Set(RCC_APB2RSTR, 1 << 11, 1 << 11),
    Set(RCC_AHB1RSTR, 1 << 22, 1 << 22),
    Set(RCC_APB1RSTR, 1 << 18, 1 << 18),
    Set(RCC_AHB1RSTR, 0x4D, 0),
    Set(RCC_APB2RSTR, 1 << 11, 0),
    Set(RCC_AHB1RSTR, 1 << 22, 0),
    Set(RCC_APB1RSTR, 1 << 18, 0),
];

/// Fysetc's bootloader, at the end of its run: 72 MHz from the crystal by M, N and P of 6, 72 and 2. There are two wait
/// states, voltage scale 3 and no over-drive. The data cache is on, and SysTick counts without an interrupt. VTOR is
/// the application's, and no interrupt was enabled. All of this was read from its machine code (it jumps at
/// 0x08001aac). Q, R, the divider of APB1 and SysTick's lap were not read: they are chosen for 48 MHz of USB, the
/// chip's limits and 1 ms.
const FYSETC: &[Step] = &[
    // Not read either: the stand-in's own code uses the floating-point unit.
    Set(SCB_CPACR, 0xF << 20, 0xF << 20),
    Set(RCC_APB1ENR, 1 << 28, 1 << 28),
    Set(PWR_CR, 3 << 14, 1 << 14),
    Set(PWR_CR, 3 << 16, 0),
    Set(RCC_CR, 1 << 16, 1 << 16),
    Await(RCC_CR, 1 << 17, 1 << 17),
    Set(RCC_PLLCFGR, ALL, 6 | 72 << 6 | 1 << 22 | 3 << 24 | 2 << 28),
    Set(RCC_CR, 1 << 24, 1 << 24),
    Await(RCC_CR, 1 << 25, 1 << 25),
    Set(FLASH_ACR, 0xF, 2),
    Set(RCC_CFGR, 0x1C00, 0x1000),
    Set(RCC_CFGR, 3, 2),
    Await(RCC_CFGR, 0xC, 8),
    Set(FLASH_ACR, 1 << 10, 1 << 10),
    Set(SYST_RVR, ALL, 71_999),
    Set(SYST_CVR, ALL, 0),
    Set(SYST_CSR, ALL, 5),
    Set(SCB_VTOR, ALL, 0x0800_8000),
];

/// Goes through rows of address, bits and value until an address is 0; the lowest bit of the address asks to wait for
/// the row. A value in a register of the floating-point unit makes CONTROL report such values, as BTT's bootloader does
/// with a baud rate that it computes. Then stack and entry are the application's.
const CODE: [u16; 26] = [
    0x480C, //         ldr r0, =rows
    0xC80E, // next:   ldmia r0!, {r1, r2, r3}
    0xB161, //         cbz r1, leave
    0x084C, //         lsrs r4, r1, #1
    0xD204, //         bcs wait
    0x680C, //         ldr r4, [r1]
    0x4394, //         bics r4, r2
    0x431C, //         orrs r4, r3
    0x600C, //         str r4, [r1]
    0xE7F6, //         b next
    0x3901, // wait:   subs r1, #1
    0x680C, // again:  ldr r4, [r1]
    0x4014, //         ands r4, r2
    0x429C, //         cmp r4, r3
    0xD1FB, //         bne again
    0xE7F0, //         b next
    0xEE00, 0x1A10, // leave: vmov s0, r1
    0x4804, //         ldr r0, =application
    0x6801, //         ldr r1, [r0]
    0xF381, 0x8808, // msr msp, r1
    0x6841, //         ldr r1, [r0, #4]
    0x4708, //         bx r1
    0xBF00, 0xBF00, // nop; nop
];

/// How the chip is left.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Bootloader {
    /// As BTT's leaves it.
    #[default]
    Btt,
    /// As Fysetc's leaves it.
    Fysetc,
    /// Worse than any known bootloader: SysTick is about to interrupt, priorities have no bits that count, and SWDIO is
    /// an output.
    Careless,
}

/// Further actions of [`Bootloader::Careless`].
const CARELESS: &[Step] = &[
    // All bits of a priority are its subpriority (ARM DDI 0403E, B3.2.6), so nothing interrupts a handler.
    Set(SCB_AIRCR, ALL, 0x05FA_0700),
    // 28 us, in which start-up has not initialised its memory yet.
    Set(SYST_RVR, ALL, 5000),
    Set(SYST_CVR, ALL, 0),
    Set(SYST_CSR, ALL, 7),
    // PA13, as the light that BTT's has there while it runs.
    Set(GPIOA_MODER, 3 << 26, 1 << 26),
];

impl Bootloader {
    /// The stand-in before an application at this address, as it lies in flash from [`RESET`] on.
    #[must_use]
    pub fn image(self, application: u32) -> Vec<u8> {
        match self {
            Self::Btt => image(application, STEPS),
            Self::Fysetc => image(application, FYSETC),
            Self::Careless => image(application, &[STEPS, CARELESS].concat()),
        }
    }
}

fn image(application: u32, steps: &[Step]) -> Vec<u8> {
    /// Stack and entry come first, and the two literals after the code.
    const BEGIN: u32 = RESET + 8;
    let rows = BEGIN + 2 * CODE.len() as u32 + 8;
    let mut bytes = Vec::new();
    bytes.extend([STACK, BEGIN + 1].iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend(CODE.iter().flat_map(|halfword| halfword.to_le_bytes()));
    let rows = [rows, application].into_iter().chain(steps.iter().flat_map(|step| match *step {
        Set(address, bits, value) => [address, bits, value],
        Await(address, bits, value) => [address + 1, bits, value],
    }));
    bytes.extend(rows.chain(iter::once(0)).flat_map(u32::to_le_bytes));
    bytes.extend([0; 8]);
    bytes
}

#[cfg(test)]
#[path = "bootloader_tests.rs"]
mod tests;
