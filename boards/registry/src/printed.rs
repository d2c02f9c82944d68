//! The pins that a board prints and its table leaves out. With the table they are the board's full list, by which a
//! configuration of another firmware tells its board.

use corehbot_wiring::{Board, Pin, Port, Slot};

/// Printed connectors that the firmware does not drive.
#[derive(Clone, Copy, Debug)]
pub struct Printed {
    /// Heater outputs, with their names.
    pub heaters: &'static [(&'static str, Pin)],
    /// Inputs of temperature sensors, with their names.
    pub sensors: &'static [(&'static str, Pin)],
    /// Headers for displays, hosts, sensors and all else: anything may be plugged in there.
    pub headers: &'static [(Port, &'static [u8])],
    /// Names of other boards with these pins, in small letters, words apart by blanks.
    pub namesakes: &'static [&'static str],
}

/// The job of a pin in a configuration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Job {
    /// Steps of a motor.
    Step,
    /// The direction of a motor.
    Dir,
    /// The enable line of a driver.
    Enable,
    /// The UART of a driver.
    Uart,
    /// A heater.
    Heater,
    /// A temperature sensor.
    Sensor,
}

impl Printed {
    /// Nothing beyond the table but these headers.
    pub(crate) const fn headers(headers: &'static [(Port, &'static [u8])]) -> Self {
        Self { heaters: &[], sensors: &[], headers, namesakes: &[] }
    }

    /// Whether a board has a connector for a job on that pin.
    #[must_use]
    pub fn has(&self, board: &Board, job: Job, pin: Pin) -> bool {
        let of_socket = |pick: fn(&Slot) -> Option<Pin>| board.sockets.iter().any(|socket| pick(socket) == Some(pin));
        let named = |list: &[(&str, Pin)]| list.iter().any(|(_, known)| *known == pin);
        match job {
            Job::Step => of_socket(|socket| Some(socket.step)),
            Job::Dir => of_socket(|socket| Some(socket.dir)),
            Job::Enable => of_socket(|socket| Some(socket.enable)),
            Job::Uart => of_socket(|socket| socket.uart),
            // Owners switch beds and chambers by outputs of fans too.
            Job::Heater => board.loads.contains(&pin) || named(self.heaters),
            Job::Sensor => board.thermistors.iter().any(|sensor| sensor.pin == pin) || named(self.sensors),
        }
    }

    /// Whether that pin is on a header, where anything may be.
    #[must_use]
    pub fn is_of_header(&self, pin: Pin) -> bool {
        self.headers.iter().any(|(port, numbers)| {
            *port == pin.port && numbers.iter().any(|number| usize::from(*number) == pin.number())
        })
    }
}
