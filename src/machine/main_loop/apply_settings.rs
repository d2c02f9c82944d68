//! Applies settings with effects beyond the next plan: the size of a step, the generator's functions, the settings of
//! drivers.

use super::MainLoop;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::offsets::move_origins;
use crate::machine::main_loop::surface::{leave_surface, take_known_mesh};
use crate::machine::numbers::exact;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::settings::{Advance, DriverGroups, Settings};
use crate::units::Mm;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Takes over another advance, for the following moves. Motion comes to rest only before its window changes, and
    /// before the generator first uses advance: from then on all axes are delayed ([`AdvanceInUse`]).
    ///
    /// [`AdvanceInUse`]: crate::machine::state::advance_in_use::AdvanceInUse
    pub async fn use_advance(&mut self, advance: Advance) -> Result<(), Interrupt> {
        // Not a struct with a base, which would be copied field by field.
        let mut wanted = *self.settings;
        wanted.advance = advance;
        if self.motion.needs_rest(&self.settings, &wanted) {
            self.finish().await?;
            self.use_settings(&wanted).await
        } else {
            self.motion.close_line(&self.settings);
            self.settings.replace_advance(advance);
            Ok(())
        }
    }

    /// Applies new driver settings. The drivers get them in the background.
    pub fn use_driver_settings(&mut self, wanted: DriverGroups) {
        self.settings.replace_drivers(wanted);
        self.power.want(&self.settings);
    }

    /// Has drivers hold something else for a while, or the settings in use again, and waits until they do.
    pub async fn configure_drivers(&mut self, other: Option<&Settings>) -> Result<(), Interrupt> {
        self.power.want(other.unwrap_or(&self.settings));
        self.await_drivers().await
    }

    /// Waits until the drivers of motors with power hold the wanted settings.
    pub async fn await_drivers(&mut self) -> Result<(), Interrupt> {
        self.until(|c| c.power.is_configured()).await
    }

    /// Takes over other settings, at rest: a step must not change its size under way. By reference: a future would hold
    /// them twice.
    pub async fn use_settings(&mut self, wanted: &Settings) -> Result<(), Interrupt> {
        if self.motion.has_motion() {
            self.finish().await?;
        }
        let resolutions = |s: &Settings| s.axes.map(|a| a.steps_per_mm);
        // A homed z stands where it stands, and its place gets another name.
        let [.., is_homed] = self.homed.axes();
        let is_otherwise = wanted.homes_z_by_probe() != self.settings.homes_z_by_probe();
        let ([offset, of_probe], [old, old_of_probe]) = (wanted.z_offsets(), self.settings.z_offsets());
        let by_probe = if is_otherwise { Mm::ZERO } else { of_probe.saturating_sub(old_of_probe) };
        let lifted = offset.saturating_sub(old).saturating_add(by_probe);
        let lifted = if is_homed { lifted } else { Mm::ZERO };
        let is_same = lifted == Mm::ZERO && resolutions(wanted) == resolutions(&self.settings);
        if is_homed && is_otherwise {
            self.hosts.notify_all(text!("echo:Z was homed otherwise than these settings say: home it (G28 Z)"));
        }
        if !is_same {
            leave_surface(self).await?;
        }
        if by_probe != Mm::ZERO {
            self.first_layer.believe_probe();
        }
        let way_of_probe = self.settings.probe.way_to(&wanted.probe);
        self.circulation.rescale(self.settings.axes.x.steps_per_mm, wanted.axes.x.steps_per_mm);
        let before = self.settings.home_offsets();
        self.settings.replace(wanted);
        move_origins(self, before);
        self.power.want(wanted);
        self.heat.note_settings();
        if is_same {
            self.follow().await?;
            return self.move_mesh(way_of_probe).await;
        }
        let [.., stood, _] = self.motion.end();
        self.motion.set_resolution(wanted);
        self.commanded.sink(lifted);
        self.in_pause(|program| program.commanded.sink(lifted));
        let position = self.motion.to_steps(self.commanded.of_machine(self.commanded.position()));
        // The bed gets another name with the tool.
        let [.., stands, _] = position;
        self.homed.note_shifted(stood.wrapping_sub(stands));
        self.adopt_position(position).await?;
        self.move_mesh(way_of_probe).await
    }

    /// The probe's place is another one by so much, and so are the places of the points that it has touched.
    async fn move_mesh(&mut self, by: [Mm; 2]) -> Result<(), Interrupt> {
        if by == [Mm::ZERO; 2] || !self.bed.moves(by) {
            return Ok(());
        }
        let [x, y] = by.map(exact);
        self.hosts.notify_all(text!("echo:the mesh moves with the probe: X{x} Y{y}. After a rebuild send G29"));
        take_known_mesh(self).await
    }
}
