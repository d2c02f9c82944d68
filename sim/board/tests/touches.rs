//! Touches of the bed: what bounds them, and what is left when one is refused or ended.

mod ended;
mod heat;
mod known;
mod machine;
mod reach;
mod refused;
