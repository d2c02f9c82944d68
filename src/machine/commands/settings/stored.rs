//! Settings as they are stored: what is stored counts from the start on, and M500, M501, M502, M504.

use crate::machine::answers::answer::Answer;
use crate::machine::answers::storage_news::StorageNews;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::{DriverBus, Pend, Storage, StorageError};
use crate::settings::Settings;
use crate::storage::{self, Receipt, SaveError, Survey};

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
    fn into_result(self) -> Result<(), Interrupt> {
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
        while !self.console.ports.storage.is_done()? {
            self.go_round().await?;
        }
        Ok(())
    }

    fn image(&self) -> Option<u32> {
        self.console.ports.storage.image()
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Looks into the storage.
    pub(in crate::machine) async fn survey(&mut self) -> Result<Result<Survey, StorageError>, Interrupt> {
        let mut paced = Paced::new(self);
        let survey = storage::survey(&mut paced).await;
        paced.into_result()?;
        Ok(survey.map(|survey| survey.on(&self.defaults().mechanism)))
    }

    /// Takes the settings that are stored, before the first `start`, and returns what to tell of them after it: a
    /// host listens only then. A machine without storage has nothing to tell, and on a board that is no machine nothing stored counts.
    pub(in crate::machine) async fn load_at_start(&mut self) -> Result<Answer<'static>, Interrupt> {
        let survey = match self.survey().await? {
            Ok(survey) => survey,
            Err(StorageError::Absent) => return Ok(Answer::Nothing),
            Err(error) => return Ok(Answer::Storage(StorageNews::Unreadable(error))),
        };
        if self.ports.drivers.refusal().is_some() {
            return Ok(Answer::Nothing);
        }
        if let Some(stored) = survey.newest {
            self.use_settings(stored.settings).await?;
        }
        let mut paced = Paced::new(self);
        let passed = storage::passed_test(&mut paced).await;
        paced.into_result()?;
        // A note that cannot be read costs a test, and no more.
        self.self_tests.know(passed.unwrap_or_default());
        Ok(Answer::Storage(StorageNews::loaded(&survey)))
    }

    /// Notes the self-test that was passed, for starts to come.
    pub(in crate::machine) async fn note_self_test(&mut self) -> Result<(), Interrupt> {
        let Some(tested) = self.self_tests.take_news() else { return Ok(()) };
        let mut paced = Paced::new(self);
        let _ = storage::note_passed_test(&mut paced, tested).await;
        paced.into_result()
    }

    /// M500. Another machine that waits for the next reset is not written over, and a board without a machine does not become one.
    pub(in crate::machine) async fn save_settings(&mut self) -> Result<StorageNews, Interrupt> {
        if self.machine_pieces.is_stored {
            return Ok(StorageNews::MachineWaits);
        }
        if let Some(why) = self.ports.drivers.refusal() {
            return Ok(StorageNews::NoMachine(why));
        }
        let settings = *self.settings;
        Ok(self.save(&settings).await?.map_or_else(StorageNews::NotSaved, StorageNews::Saved))
    }

    /// Stores settings. The machine rests: storage may be flash, whose erasing stops the processor.
    pub(in crate::machine) async fn save(
        &mut self,
        settings: &Settings,
    ) -> Result<Result<Receipt, SaveError>, Interrupt> {
        self.finish().await?;
        let mut paced = Paced::new(self);
        let saved = storage::save(&mut paced, settings).await;
        paced.into_result()?;
        Ok(saved)
    }

    /// M501. Storage without valid settings gives the defaults, storage that does not answer changes nothing; nor does a board without
    /// a machine.
    pub(in crate::machine) async fn load_settings(&mut self) -> Result<StorageNews, Interrupt> {
        if let Some(why) = self.ports.drivers.refusal() {
            return Ok(StorageNews::NotLoaded(why));
        }
        self.finish().await?;
        let survey = match self.survey().await? {
            Ok(survey) => survey,
            Err(error) => return Ok(StorageNews::Unchanged(error)),
        };
        let settings = survey.newest.map_or(*self.defaults(), |stored| stored.settings);
        self.use_settings(settings).await?;
        Ok(StorageNews::loaded(&survey))
    }

    /// M502.
    pub(in crate::machine) async fn reset_settings(&mut self) -> Result<StorageNews, Interrupt> {
        self.finish().await?;
        self.use_settings(*self.defaults()).await?;
        Ok(StorageNews::Defaults)
    }

    /// M504.
    pub(in crate::machine) async fn check_storage(&mut self) -> Result<StorageNews, Interrupt> {
        Ok(match self.survey().await? {
            Ok(survey) => StorageNews::checked(&survey),
            Err(error) => StorageNews::Unanswered(error),
        })
    }

    /// Takes over other settings. Motion rests: a step must not change its size under way.
    pub(in crate::machine) async fn use_settings(&mut self, wanted: Settings) -> Result<(), Interrupt> {
        let resolutions = |s: &Settings| s.axes.map(|a| a.steps_per_mm);
        let is_same = resolutions(&wanted) == resolutions(&self.settings);
        self.circulation.rescale(self.settings.axes.x.steps_per_mm, wanted.axes.x.steps_per_mm);
        *self.settings = wanted;
        self.drivers.want(&wanted);
        self.heat_orders.note_settings();
        if is_same {
            return self.follow().await;
        }
        self.planner.set_resolution(&wanted);
        let position = self.planner.steps(self.retraction.away_from(self.modal.position));
        self.adopt_position(position).await
    }
}
