//! Keeping settings: what is stored counts from the start on, and M500 to M504.

use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::port::{Pend, Storage, StorageError};
use crate::settings::Settings;
use crate::storage::{self, Receipt, Rejected, SaveError, Slot, Survey};

/// Why the content of a slot is not used.
type Slots = [(Slot, Option<Rejected>); 2];

/// What there is to tell of the storage.
#[derive(Clone, Copy)]
pub(in crate::machine) enum StorageNews {
    /// M500 did it.
    Saved(Receipt),
    /// M500 did not.
    NotSaved(SaveError),
    /// M501 found no storage.
    Unchanged(StorageError),
    /// M504 found none.
    Unanswered(StorageError),
    /// There was none at the start.
    Unreadable(StorageError),
    /// These settings were found and taken, or the defaults if there is no receipt.
    Loaded { rejected: Slots, receipt: Option<Receipt> },
    /// These settings were found.
    Checked { rejected: Slots, receipt: Option<Receipt> },
    /// M502.
    Defaults,
}

impl StorageNews {
    fn loaded(survey: &Survey) -> Self {
        Self::Loaded { rejected: survey.rejected, receipt: survey.newest.map(|stored| stored.receipt) }
    }

    fn checked(survey: &Survey) -> Self {
        Self::Checked { rejected: survey.rejected, receipt: survey.newest.map(|stored| stored.receipt) }
    }
}

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
    pub(in crate::machine) async fn survey(&mut self) -> Result<Result<Survey, StorageError>, Interrupt> {
        let mut paced = Paced::new(self);
        let survey = storage::survey(&mut paced).await;
        paced.end()?;
        Ok(survey.map(|survey| survey.on(&self.defaults.mechanism)))
    }

    /// Takes the settings that are stored, before the first `start`, and returns what to tell of them after it: a
    /// host listens only then. A machine without storage has nothing to tell.
    pub(in crate::machine) async fn load_at_start(&mut self) -> Result<Answer<'static>, Interrupt> {
        let survey = match self.survey().await? {
            Ok(survey) => survey,
            Err(StorageError::Absent) => return Ok(Answer::Nothing),
            Err(error) => return Ok(Answer::Storage(StorageNews::Unreadable(error))),
        };
        if let Some(stored) = survey.newest {
            self.use_settings(stored.settings).await?;
        }
        Ok(Answer::Storage(StorageNews::loaded(&survey)))
    }

    /// M500. The machine rests: storage may be flash, whose erasing stops the processor.
    pub(in crate::machine) async fn save_settings(&mut self) -> Result<StorageNews, Interrupt> {
        self.finish().await?;
        let settings = self.settings;
        let mut paced = Paced::new(self);
        let saved = storage::save(&mut paced, &settings).await;
        paced.end()?;
        Ok(saved.map_or_else(StorageNews::NotSaved, StorageNews::Saved))
    }

    /// M501. Storage without valid settings gives the defaults, storage that does not answer changes nothing.
    pub(in crate::machine) async fn load_settings(&mut self) -> Result<StorageNews, Interrupt> {
        self.finish().await?;
        let survey = match self.survey().await? {
            Ok(survey) => survey,
            Err(error) => return Ok(StorageNews::Unchanged(error)),
        };
        let settings = survey.newest.map_or(self.defaults, |stored| stored.settings);
        self.use_settings(settings).await?;
        Ok(StorageNews::loaded(&survey))
    }

    /// M502.
    pub(in crate::machine) async fn reset_settings(&mut self) -> Result<StorageNews, Interrupt> {
        self.finish().await?;
        self.use_settings(self.defaults).await?;
        Ok(StorageNews::Defaults)
    }

    /// M504.
    pub(in crate::machine) async fn check_storage(&mut self) -> Result<StorageNews, Interrupt> {
        Ok(match self.survey().await? {
            Ok(survey) => StorageNews::checked(&survey),
            Err(error) => StorageNews::Unanswered(error),
        })
    }

    pub(in crate::machine) fn say_storage(&mut self, news: &StorageNews) {
        match *news {
            StorageNews::Saved(receipt) => self.say(format_args!("echo:Settings Stored {receipt}")),
            StorageNews::NotSaved(error) => self.say(format_args!("echo:Settings not stored: {error}")),
            StorageNews::Unchanged(error) => self.say(format_args!("echo:Settings unchanged: {error}")),
            StorageNews::Unanswered(error) => self.say(format_args!("echo:{error}")),
            StorageNews::Unreadable(error) => {
                self.say(format_args!("echo:{error}"));
                self.say_defaults();
            }
            StorageNews::Loaded { rejected, receipt } => {
                self.say_rejected(rejected);
                match receipt {
                    Some(receipt) => self.say(format_args!("echo:stored settings retrieved {receipt}")),
                    None => self.say_defaults(),
                }
            }
            StorageNews::Checked { rejected, receipt } => {
                self.say_rejected(rejected);
                match receipt {
                    Some(receipt) => self.say(format_args!("echo:stored settings valid {receipt}")),
                    None => self.say(format_args!("echo:no valid settings stored")),
                }
            }
            StorageNews::Defaults => self.say_defaults(),
        }
    }

    fn say_defaults(&mut self) {
        self.say(format_args!("echo:Hardcoded Default Settings Loaded"));
    }

    /// Names the slots whose content is not used; an empty one is no news.
    fn say_rejected(&mut self, slots: Slots) {
        for (slot, why) in slots {
            if let Some(why) = why.filter(|why| *why != Rejected::Blank) {
                self.say(format_args!("echo:storage slot {slot} not used: {why}"));
            }
        }
    }

    /// Takes over other settings. Motion rests: a step must not change its size under way.
    pub(in crate::machine) async fn use_settings(&mut self, wanted: Settings) -> Result<(), Interrupt> {
        let resolutions = |s: &Settings| s.axes.map(|a| a.steps_per_mm);
        let is_same = resolutions(&wanted) == resolutions(&self.settings);
        self.settings = wanted;
        self.drivers.want(&wanted);
        if is_same {
            return self.follow().await;
        }
        self.planner.set_resolution(&wanted);
        let position = self.planner.steps(self.retraction.away_from(self.modal.position));
        self.adopt_position(position).await
    }
}
