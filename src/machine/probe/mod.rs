//! The probe: it finds the height of the bed at a place.
//!
//! ```text
//!   raise ▶ put out ▶ over the place ▶ rest ▶ down fast ▶ up ▶ down slowly ... ▶ height ▶ up ▶ take in
//! ```
//!
//! The Stepper reads the probe at every step event of a move that watches it, and no step follows the event at which it
//! has triggered. So a pulse counts that is longer than the time between two steps. A touch has a floor: where the
//! probe should have triggered, and a little more. If anything is not as it should be, the tool is raised, the probe
//! taken in, and the job ends ([`ProbeFailure`]).
//!
//! | file | for |
//! |---|---|
//! | [`touch`] | the height of the bed at a place |
//! | [`approach`] | one approach, and moves up |
//! | [`deploy`] | putting the probe out, and taking it in |
//! | [`repeatability`] | mean and deviation of touches |
//! | [`area`] | the points of a mesh |
//! | [`reach`] | the places that it reaches |
//! | [`error`] | why a touch has no result |
//!
//! | word | means |
//! |---|---|
//! | height | of the bed, relative to z = 0 |
//! | floor | z of the nozzle at which a touch is given up |
//! | out | ready to touch |
//!
//! [`ProbeFailure`]: crate::machine::state::job::ProbeFailure

mod approach;
pub(in crate::machine) mod area;
pub(in crate::machine) mod deploy;
mod error;
pub(in crate::machine) mod reach;
pub(in crate::machine) mod repeatability;
pub(in crate::machine) mod touch;
