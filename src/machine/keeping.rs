//! Keeping settings: what is stored counts from the start on, and M500 to M504.

use super::console::{Console, Interrupt, PortSet};
use crate::port::{Pend, Storage, StorageError};
use crate::settings::Settings;
use crate::storage::{self, Rejected, Survey};

/// The storage, with the world going round once after every transfer, so that M112 is heard while settings
/// are being saved.
struct Paced<'c, 'm, P: PortSet, W: Pend> {
    console: &'c mut Console<'m, P, W>,
    interrupt: Option<Interrupt>,
}

impl<'c, 'm, P: PortSet, W: Pend> Paced<'c, 'm, P, W> {
    const fn new(console: &'c mut Console<'m, P, W>) -> Self {
        Self { console, interrupt: None }
    }

    /// An interrupt ends the transfers, but for an M410 that finds no motion to stop.
    async fn go_round(&mut self) -> Result<(), StorageError> {
        match self.console.turn().await {
            Err(interrupt) if interrupt == Interrupt::Halt || self.console.has_motion() => {
                self.interrupt = Some(interrupt);
                Err(StorageError::Failed)
            }
            Err(_) | Ok(()) => Ok(()),
        }
    }

    /// What ended the transfers before their time, if something did.
    fn end(self) -> Result<(), Interrupt> {
        match self.interrupt {
            Some(interrupt) => Err(interrupt),
            None => Ok(()),
        }
    }
}

impl<P: PortSet, W: Pend> Storage for Paced<'_, '_, P, W> {
    fn capacity(&self) -> u32 {
        self.console.ports.storage.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.console.ports.storage.read(at, into).await?;
        self.go_round().await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.console.ports.storage.write(at, bytes).await?;
        self.go_round().await?;
        while !self.console.ports.storage.is_settled()? {
            self.go_round().await?;
        }
        Ok(())
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Looks into the storage.
    pub(super) async fn survey(&mut self) -> Result<Result<Survey, StorageError>, Interrupt> {
        let mut paced = Paced::new(self);
        let survey = storage::survey(&mut paced).await;
        paced.end()?;
        Ok(survey)
    }

    /// Takes the settings that are stored, before the first `start`. Nothing is said yet: a host listens
    /// only after it.
    pub(super) async fn load_at_start(&mut self) -> Result<Result<Survey, StorageError>, Interrupt> {
        let found = self.survey().await?;
        if let Ok(Survey { newest: Some(stored), .. }) = &found {
            self.use_settings(stored.settings).await?;
        }
        Ok(found)
    }

    /// Tells what was found at the start. A machine without storage has nothing to tell.
    pub(super) async fn report_start(&mut self, found: Result<Survey, StorageError>) -> Result<(), Interrupt> {
        match found {
            Err(StorageError::Absent) => Ok(()),
            Err(error) => {
                self.say(format_args!("echo:{error}")).await?;
                self.report_defaults().await
            }
            Ok(survey) => self.report_loaded(&survey).await,
        }
    }

    /// M500. The machine rests: storage may be flash, whose erasing stops the processor.
    pub(super) async fn save_settings(&mut self) -> Result<(), Interrupt> {
        self.finish().await?;
        let settings = self.settings;
        let mut paced = Paced::new(self);
        let saved = storage::save(&mut paced, &settings).await;
        paced.end()?;
        match saved {
            Ok(receipt) => self.say(format_args!("echo:Settings Stored {receipt}")).await,
            Err(error) => self.say(format_args!("echo:Settings not stored: {error}")).await,
        }
    }

    /// M501. Storage without valid settings gives the defaults, storage that does not answer changes nothing.
    pub(super) async fn load_settings(&mut self) -> Result<(), Interrupt> {
        self.finish().await?;
        match self.survey().await? {
            Ok(survey) => {
                let settings = survey.newest.map_or(self.defaults, |stored| stored.settings);
                self.use_settings(settings).await?;
                self.report_loaded(&survey).await
            }
            Err(error) => self.say(format_args!("echo:Settings unchanged: {error}")).await,
        }
    }

    /// M502.
    pub(super) async fn reset_settings(&mut self) -> Result<(), Interrupt> {
        self.finish().await?;
        self.use_settings(self.defaults).await?;
        self.report_defaults().await
    }

    /// M504.
    pub(super) async fn check_storage(&mut self) -> Result<(), Interrupt> {
        let survey = match self.survey().await? {
            Ok(survey) => survey,
            Err(error) => return self.say(format_args!("echo:{error}")).await,
        };
        self.report_rejected(&survey).await?;
        match survey.newest {
            Some(stored) => self.say(format_args!("echo:stored settings valid {}", stored.receipt)).await,
            None => self.say(format_args!("echo:no valid settings stored")).await,
        }
    }

    async fn report_loaded(&mut self, survey: &Survey) -> Result<(), Interrupt> {
        self.report_rejected(survey).await?;
        match survey.newest {
            Some(stored) => self.say(format_args!("echo:stored settings retrieved {}", stored.receipt)).await,
            None => self.report_defaults().await,
        }
    }

    async fn report_defaults(&mut self) -> Result<(), Interrupt> {
        self.say(format_args!("echo:Hardcoded Default Settings Loaded")).await
    }

    /// Names the slots whose content is not used; an empty one is no news.
    async fn report_rejected(&mut self, survey: &Survey) -> Result<(), Interrupt> {
        for (slot, why) in survey.rejected {
            if let Some(why) = why.filter(|why| *why != Rejected::Blank) {
                self.say(format_args!("echo:storage slot {slot} not used: {why}")).await?;
            }
        }
        Ok(())
    }

    /// Takes over other settings. Motion rests: a step must not change its size under way.
    pub(super) async fn use_settings(&mut self, wanted: Settings) -> Result<(), Interrupt> {
        let resolutions = |s: &Settings| s.axes.map(|a| a.steps_per_mm);
        let is_same = resolutions(&wanted) == resolutions(&self.settings);
        self.settings = wanted;
        self.drivers.want(&wanted);
        if is_same {
            return Ok(());
        }
        self.planner.set_resolution(&wanted);
        let position = self.planner.steps(self.retraction.away_from(self.modal.position));
        self.adopt_position(position).await
    }
}
