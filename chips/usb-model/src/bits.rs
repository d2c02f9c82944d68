//! Addresses of registers from the core's base, and their bits (RM0390 rev 6, sections 31.15.2 and 31.15.4).
#![allow(missing_docs, reason = "the names are the manual's")]

pub const GOTGCTL: u32 = 0x000;
pub const GOTGINT: u32 = 0x004;
pub const GAHBCFG: u32 = 0x008;
pub const GUSBCFG: u32 = 0x00C;
pub const GRSTCTL: u32 = 0x010;
pub const GINTSTS: u32 = 0x014;
pub const GINTMSK: u32 = 0x018;
pub const GRXSTSR: u32 = 0x01C;
pub const GRXSTSP: u32 = 0x020;
pub const GRXFSIZ: u32 = 0x024;
pub const DIEPTXF0: u32 = 0x028;
pub const GCCFG: u32 = 0x038;
pub const CID: u32 = 0x03C;
pub const DIEPTXF1: u32 = 0x104;
pub const DCFG: u32 = 0x800;
pub const DCTL: u32 = 0x804;
pub const DSTS: u32 = 0x808;
pub const DIEPMSK: u32 = 0x810;
pub const DOEPMSK: u32 = 0x814;
pub const DAINT: u32 = 0x818;
pub const DAINTMSK: u32 = 0x81C;
pub const DIEPEMPMSK: u32 = 0x834;
pub const IN: u32 = 0x900;
pub const OUT: u32 = 0xB00;
pub const PCGCCTL: u32 = 0xE00;
pub const FIFO: u32 = 0x1000;
/// Registers of an endpoint, from its own first one.
pub const EPCTL: u32 = 0x00;
pub const EPINT: u32 = 0x08;
pub const EPTSIZ: u32 = 0x10;
pub const DTXFSTS: u32 = 0x18;

pub const GINT: u32 = 1;
pub const TXFELVL: u32 = 1 << 7;

pub const CSRST: u32 = 1;
pub const RXFFLSH: u32 = 1 << 4;
pub const TXFFLSH: u32 = 1 << 5;
pub const AHBIDL: u32 = 1 << 31;

pub const OTGINT: u32 = 1 << 2;
pub const SOF: u32 = 1 << 3;
pub const RXFLVL: u32 = 1 << 4;
pub const GINAKEFF: u32 = 1 << 6;
pub const GONAKEFF: u32 = 1 << 7;
pub const ESUSP: u32 = 1 << 10;
pub const USBSUSP: u32 = 1 << 11;
pub const USBRST: u32 = 1 << 12;
pub const ENUMDNE: u32 = 1 << 13;
pub const IEPINT: u32 = 1 << 18;
pub const OEPINT: u32 = 1 << 19;
pub const SRQINT: u32 = 1 << 30;
pub const WKUPINT: u32 = 1 << 31;
/// The bits of GINTSTS that writing ones clears.
pub const CLEARABLE: u32 = 0xF8B0_FC0A;
/// GINTSTS after a reset: both transmit FIFOs of the host mode are empty.
pub const QUIET: u32 = 0x0400_0020;

pub const SDIS: u32 = 1 << 1;
pub const SGINAK: u32 = 1 << 7;
pub const CGINAK: u32 = 1 << 8;
pub const SGONAK: u32 = 1 << 9;
pub const CGONAK: u32 = 1 << 10;

pub const USBAEP: u32 = 1 << 15;
pub const DPID: u32 = 1 << 16;
pub const NAKSTS: u32 = 1 << 17;
pub const STALL: u32 = 1 << 21;
pub const CNAK: u32 = 1 << 26;
pub const SNAK: u32 = 1 << 27;
pub const SD0PID: u32 = 1 << 28;
pub const SD1PID: u32 = 1 << 29;
pub const EPDIS: u32 = 1 << 30;
pub const EPENA: u32 = 1 << 31;
/// The bits of an endpoint's control register that are stored as written: MPSIZ, EPTYP, TXFNUM.
pub const STORED: u32 = 0x03CC_07FF;

pub const XFRC: u32 = 1;
pub const EPDISD: u32 = 1 << 1;
pub const STUP: u32 = 1 << 3;
pub const ITTXFE: u32 = 1 << 4;
pub const INEPNE: u32 = 1 << 6;
pub const B2BSTUP: u32 = 1 << 6;
pub const TXFE: u32 = 1 << 7;

/// TRDT for a bus clock from 32 MHz on (table of TRDT values for full speed).
pub const FULL_SPEED_TRDT: u32 = 6;
/// Words of FIFO memory (section 31.3).
pub const FIFO_WORDS: u32 = 320;
