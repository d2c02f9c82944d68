//! Answers against closed forms, the papers, and the twin.

mod compare;
mod compensation;
mod corexyz;
mod frame;
mod misalignment;
