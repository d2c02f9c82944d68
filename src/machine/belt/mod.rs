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
//! | grouping | for which coordinates motors step together: for the tool alone, or for the tool and the circulation |
//!
//! While the belt runs round, its circulation has the place of z, which stands: the planner, the generator and the step pins are
//! regrouped at rest ([`Mechanism::circulating`](crate::kinematics::Mechanism::circulating)), as if the machine were a CoreXYZ, and back at rest.

mod circulate;
