//! Drawings of answers, as SVG: most of them stand in docs/research.

pub mod corexyz;
pub mod figures;
pub mod frame;
pub mod freedom;
pub mod misalignment;
pub mod parts;
pub mod yin;
