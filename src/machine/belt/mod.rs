//! The belt: functions of one closed belt other than moving the tool.
//!
//! ```text
//!            (0,D) 11 ------ 8 (W,D)        forward is counter-clockwise for each motor:
//!                   |  tool  |              with 1, 4, 8 and 11 alike the belt runs round, and the tool stands
//!            (0,0)  1 ------ 4 (W,0)
//! ```
//!
//! | word | means |
//! |---|---|
//! | circulation, C | how far the belt has run round, in mm of belt; the third coordinate of equation 8 of the paper |
//! | grouping | coordinates of the steps: the tool, the tool and the circulation, or a single motor |
//! | residual | the sum of motors that no motion of the tool and no circulation changes: their strain on the belt |
//! | trim | one motor is turned alone, which changes the residual |
//! | aligned | the residual has its wanted value: 0, or the preload |
//! | apex | the trim with the least load on the motors |
//! | skip | a rotor that settled an electrical turn of four full steps away from its field |
//! | phase | the residual of the drivers' positions in their sine tables |
//! | aside | the tool's displacement from the step counts, as the switches show it |
//!
//! While the belt circulates, circulation takes the place of z, which does not move. Planner, generator and step pins
//! are regrouped at rest, as if the machine were a CoreXYZ
//! ([`Mechanism::circulating`](crate::kinematics::Mechanism::circulating)), and back at rest.
//!
//! The commands are in `commands`: C of G0 and G1 in `circulate`, M915 in `belt`, G28 in `homing`.
//!
//! | file | content |
//! |---|---|
//! | `kinematics::residuals` | the residuals of a mechanism |
//! | [`circulate`] | the belt runs round |
//! | `main_loop::trim` | one motor is turned alone |
//! | [`load_curve`] | the least load, from the drivers' measurements |
//! | [`scan`] | these measurements, with a motor at several trims |
//! | [`align`], [`align_error`] | motors are aligned; why they could not be |
//! | `main_loop::phase` | motors are aligned as they get power, by their drivers' sine tables |
//! | [`diagnosis`] | which motor has skipped |
//! | `state::pulleys` | what a changed phase says of the pulleys |
//! | [`report`] | what hosts read of it; the belt's part of M122 |
//! | `main_loop::limp` | one motor has failed, and the others park the tool |

pub(in crate::machine) mod align;
pub(in crate::machine) mod align_error;
pub(in crate::machine) mod circulate;
pub(in crate::machine) mod diagnosis;
pub(in crate::machine) mod load_curve;
pub(in crate::machine) mod report;
mod scan;
