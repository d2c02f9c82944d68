//! The CoreH-bot's equations as its paper has them, as a check of the mechanism's rows: four motors on one closed belt,
//! coupled in two pairs.
//!
//! Let x point to the right, y to the back, and counter-clockwise be positive seen from above. With belt travel
//! `r * theta` in steps, the paper's kinematics (its equation 8 with the coupling of equation 12) read
//!
//! ```text
//! n1 = c - x + y      n4 = c - x - y      n8 = c + x - y      n11 = c + x + y
//! ```
//!
//! `c` is the circulation: all four motors turn alike, the belt circulates and the head stands still. A belt cannot
//! follow the fourth combination, the residual `n1 - n4 + n8 - n11`: it must stay 0 at every instant, or the motors
//! strain the belt against each other. The four rows are orthogonal and of equal length, so the inverse is the
//! transpose over four.
//!
//! With c held at 0 the motors move in two exact pairs, `n1 = -n8` and `n4 = -n11`. There v = x - y drives 8 (forward)
//! and 1 (backward), and u = x + y drives 11 (forward) and 4 (backward). In CoreXY's words A is 11 and 4, B is 8 and 1.

/// Belt travel of motors 1, 4, 8 and 11, in steps or any other unit of length.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BeltSteps {
    /// Motor 1.
    pub n1: i64,
    /// Motor 4.
    pub n4: i64,
    /// Motor 8.
    pub n8: i64,
    /// Motor 11.
    pub n11: i64,
}

/// Position of the tool and circulation of the belt, in the unit of [`BeltSteps`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ToolSteps {
    /// To the right.
    pub x: i64,
    /// To the back.
    pub y: i64,
    /// Belt circulation, counter-clockwise.
    pub c: i64,
}

/// The turn of each motor for the tool to be there.
#[must_use]
pub const fn inverse(tool: ToolSteps) -> BeltSteps {
    let ToolSteps { x, y, c } = tool;
    BeltSteps { n1: c - x + y, n4: c - x - y, n8: c + x - y, n11: c + x + y }
}

/// Four times the tool's position, given the turns of the motors. It is exact for any integers, also for steps that no
/// position of the tool can explain (their [`residual`] is not 0).
#[must_use]
pub const fn forward(belt: BeltSteps) -> ToolSteps {
    let BeltSteps { n1, n4, n8, n11 } = belt;
    ToolSteps { x: -n1 - n4 + n8 + n11, y: n1 - n4 - n8 + n11, c: n1 + n4 + n8 + n11 }
}

/// The strain that the motors put into the belt; 0 in a sound machine.
#[must_use]
pub const fn residual(belt: BeltSteps) -> i64 {
    belt.n1 - belt.n4 + belt.n8 - belt.n11
}
