//! Addresses of registers from the core's base, and their bits. All are in RM0390 rev 6, section 31.15, under the names
//! that they have here; the fields of a number are functions.

pub const GAHBCFG: u32 = 0x008;
pub const GUSBCFG: u32 = 0x00C;
pub const GRSTCTL: u32 = 0x010;
pub const GINTSTS: u32 = 0x014;
pub const GINTMSK: u32 = 0x018;
pub const GRXSTSP: u32 = 0x020;
pub const GRXFSIZ: u32 = 0x024;
pub const DCFG: u32 = 0x800;
pub const DCTL: u32 = 0x804;
pub const DIEPMSK: u32 = 0x810;
pub const DOEPMSK: u32 = 0x814;
pub const DAINT: u32 = 0x818;
pub const DAINTMSK: u32 = 0x81C;
pub const DIEPEMPMSK: u32 = 0x834;

/// The size of an endpoint's transmit FIFO.
pub const fn dieptxf(n: usize) -> u32 {
    if n == 0 { 0x028 } else { 0x100 + 4 * n as u32 }
}

/// Control, interrupts and transfer size of an IN endpoint.
pub const fn diepctl(n: usize) -> u32 {
    0x900 + 0x20 * n as u32
}
pub const fn diepint(n: usize) -> u32 {
    diepctl(n) + 0x08
}
pub const fn dieptsiz(n: usize) -> u32 {
    diepctl(n) + 0x10
}

/// The same of an OUT endpoint.
pub const fn doepctl(n: usize) -> u32 {
    0xB00 + 0x20 * n as u32
}
pub const fn doepint(n: usize) -> u32 {
    doepctl(n) + 0x08
}
pub const fn doeptsiz(n: usize) -> u32 {
    doepctl(n) + 0x10
}

/// The FIFO of an endpoint; all endpoints read from the one of endpoint 0.
pub const fn fifo(n: usize) -> u32 {
    0x1000 * (n as u32 + 1)
}

// GAHBCFG.
pub const GINT: u32 = 1;

// GUSBCFG.
pub const TRDT: u32 = 0xF << 10;

// GRSTCTL.
pub const TXFFLSH: u32 = 1 << 5;

// GINTSTS and GINTMSK.
pub const RXFLVL: u32 = 1 << 4;
pub const GONAKEFF: u32 = 1 << 7;
pub const ESUSP: u32 = 1 << 10;
pub const USBSUSP: u32 = 1 << 11;
pub const USBRST: u32 = 1 << 12;
pub const ENUMDNE: u32 = 1 << 13;
pub const IEPINT: u32 = 1 << 18;
pub const OEPINT: u32 = 1 << 19;
pub const WKUPINT: u32 = 1 << 31;

// DCFG.
pub const FULL_SPEED_INTERNAL: u32 = 3;
pub const DAD: u32 = 0x7F << 4;

// DCTL.
pub const SDIS: u32 = 1 << 1;
pub const SGONAK: u32 = 1 << 9;
pub const CGONAK: u32 = 1 << 10;

// DIEPCTL and DOEPCTL.
pub const USBAEP: u32 = 1 << 15;
pub const STALL: u32 = 1 << 21;
pub const CNAK: u32 = 1 << 26;
pub const SNAK: u32 = 1 << 27;
pub const SD0PID: u32 = 1 << 28;
pub const EPDIS: u32 = 1 << 30;
pub const EPENA: u32 = 1 << 31;

/// EPTYP.
pub const fn kind(kind: u32) -> u32 {
    kind << 18
}

/// TXFNUM: each IN endpoint has the FIFO of its own number.
pub const fn own_fifo(n: usize) -> u32 {
    (n as u32) << 22
}

// DIEPINT and DOEPINT.
pub const XFRC: u32 = 1;
pub const EPDISD: u32 = 1 << 1;
pub const STUP: u32 = 1 << 3;
pub const INEPNE: u32 = 1 << 6;

/// A transfer of one packet.
pub const fn one_packet(bytes: usize) -> u32 {
    1 << 19 | bytes as u32
}

/// STUPCNT: three SETUP packets in a row, which is its most.
pub const THREE_SETUPS: u32 = 3 << 29;

// PKTSTS of GRXSTSP.
pub const OUT_DATA: u32 = 2;
pub const OUT_DONE: u32 = 3;
pub const SETUP_DATA: u32 = 6;
