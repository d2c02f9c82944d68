//! The commands: each reads its options, computes, and gives tables, JSON, drawings and pages.

pub(crate) mod compare;
pub(crate) mod compensate;
pub(crate) mod figures;
pub(crate) mod flow;
pub(crate) mod frame;
pub(crate) mod jump;
pub(crate) mod level;
pub(crate) mod misalignment;
pub(crate) mod parts;
pub(crate) mod push;
mod study;
pub(crate) mod sweep;
pub(crate) mod yin;
pub(crate) mod zigzag;
