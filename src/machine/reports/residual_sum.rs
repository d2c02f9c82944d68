//! A residual as people read it: a sum of motors.

use crate::kinematics::Residual;
use crate::motors::Motor;
use crate::settings::Settings;
use core::fmt::{self, Display, Formatter};

/// A residual as a sum of motors: `m1 - m4 + m8 - m11`.
pub(in crate::machine) struct ResidualSum<'r>(pub &'r Residual, pub &'r Settings);

impl Display for ResidualSum<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut is_first = true;
        let Self(residual, s) = self;
        for (motor, times) in Motor::ALL.into_iter().zip(*residual).filter(|(_, times)| **times != 0) {
            let sign = match (is_first, *times < 0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            is_first = false;
            f.write_str(sign)?;
            if times.abs() > 1 {
                write!(f, "{} ", times.abs())?;
            }
            f.write_str(s.name_of(motor).as_str())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::kinematics::{Mechanism, Residuals};
    use crate::motors::per_motor;
    use std::string::ToString;

    #[test]
    fn a_residual_reads_as_a_sum_of_motors() {
        let s = Settings::prototype();
        let of = |closed| Residuals::new(&Mechanism::corehbot(), closed);
        assert_eq!(ResidualSum(of(true).iter().next().unwrap(), &s).to_string(), "m1 - m4 + m8 - m11");
        assert_eq!(ResidualSum(&per_motor(&[-1, 0, 2], 0), &s).to_string(), "-m1 + 2 m8");
    }
}
