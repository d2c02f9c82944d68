//! The belt: what one closed belt can do besides moving the tool.
//!
//! ```text
//!            (0,D) 11 ------ 8 (W,D)        forward is counter-clockwise for each motor:
//!                   |  tool  |              with 1, 4, 8 and 11 alike the belt runs round, and the tool stands
//!            (0,0)  1 ------ 4 (W,0)
//! ```
//!
//! | word | means |
//! |---|---|
//! | circulation, C | how far the belt has run round, in mm of belt; the third degree of freedom of equation 8 of the paper |
//! | grouping | for which coordinates motors step together: for the tool alone, for the tool and the circulation, or a single motor |
//! | residual | the sum of motors that no motion of the tool and no circulation changes: what they strain the belt by (`kinematics::residuals`) |
//! | trim | one motor is turned alone, which changes the residual |
//! | aligned | the residual is what it should be: 0, or the preload |
//! | apex | the trim with which motors bear least |
//! | skip | a rotor that settled an electrical turn of four full steps beside its field |
//! | phase | the sum of a residual over the places of the drivers in their sine tables |
//! | aside | how far the tool is from where the steps say, as its switches tell |
//!
//! While the belt runs round, its circulation has the place of z, which stands: the planner, the generator and the step pins are
//! regrouped at rest ([`Mechanism::circulating`](crate::kinematics::Mechanism::circulating)), as if the machine were a CoreXYZ, and back at rest.
//!
//! What lines ask for stands in `commands`: C of G0 and G1 in `circulate`, M915 in `belt`, G28 in `homing`.
//!
//! | file | what |
//! |---|---|
//! | [`circulate`] | the belt runs round |
//! | `main_loop::trim` | one motor is turned alone |
//! | [`load_curve`] | where motors bear least, from what their drivers measure |
//! | [`align`] | motors are aligned |
//! | `main_loop::phase` | motors are aligned as they get power, by their drivers' sine tables |
//! | [`diagnosis`] | which motor has skipped |
//! | [`report`] | what M122 says of it |
//! | `main_loop::limp` | one motor has failed, and the others park the tool |

pub(in crate::machine) mod align;
pub(in crate::machine) mod circulate;
pub(in crate::machine) mod diagnosis;
mod load_curve;
pub(in crate::machine) mod report;
