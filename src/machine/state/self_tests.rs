//! Self-tests of the heaters: the last one, and the one under way.

use crate::status::SelfTest;

/// Control periods after which the thermal context has begun for certain.
const TAKEN: u32 = 2;

/// A test under way.
#[derive(Clone, Copy)]
struct UnderWay {
    /// The tested heaters, as one number.
    subject: u32,
    /// The user asked for it.
    is_asked: bool,
    /// The control period in which its order was seen to have left.
    left: Option<u32>,
}

/// The state of the self-tests.
pub(in crate::machine) struct SelfTests {
    /// The subject of the last passed test.
    passed: Option<u32>,
    under_way: Option<UnderWay>,
    /// It is not stored yet.
    has_news: bool,
    /// The user knows that a test was put off.
    is_put_off: bool,
}

impl SelfTests {
    pub const fn new() -> Self {
        Self { passed: None, under_way: None, has_news: false, is_put_off: false }
    }

    /// Takes the subject of the last passed test from the storage.
    pub const fn know(&mut self, passed: Option<u32>) {
        self.passed = passed;
    }

    /// Whether heaters must not heat before they are tested.
    pub fn is_needed(&self, subject: u32) -> bool {
        self.under_way.is_none() && self.passed != Some(subject)
    }

    /// A test begins.
    pub const fn begin(&mut self, subject: u32, is_asked: bool) {
        self.under_way = Some(UnderWay { subject, is_asked, left: None });
    }

    /// Whether a test is under way.
    pub const fn is_under_way(&self) -> bool {
        self.under_way.is_some()
    }

    /// The test ends before its time, without a result. Whether one was under way.
    pub const fn stop(&mut self) -> bool {
        self.under_way.take().is_some()
    }

    /// Follows the test; returns how it ended, once.
    pub fn follow(&mut self, has_left: bool, period: u32, state: SelfTest) -> Option<SelfTest> {
        let under_way = self.under_way.as_mut()?;
        if !has_left {
            return None;
        }
        let left = *under_way.left.get_or_insert(period);
        if period.wrapping_sub(left) <= TAKEN || state == SelfTest::Testing {
            return None;
        }
        let UnderWay { subject, is_asked, .. } = *under_way;
        self.under_way = None;
        if state == SelfTest::Passed {
            (self.passed, self.has_news) = (Some(subject), true);
        }
        let was_put_off = core::mem::replace(&mut self.is_put_off, state == SelfTest::PutOff);
        (is_asked || !was_put_off || state != SelfTest::PutOff).then_some(state)
    }

    /// A passed test to store for later starts, once.
    pub fn take_news(&mut self) -> Option<u32> {
        core::mem::take(&mut self.has_news).then_some(self.passed).flatten()
    }

    /// Whether a passed test is to be stored.
    pub const fn has_news(&self) -> bool {
        self.has_news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_passed_is_noted_once_and_needs_no_test_until_it_changes() {
        let mut tests = SelfTests::new();
        tests.know(Some(6));
        assert!(tests.is_needed(7) && !tests.is_needed(6));
        tests.begin(7, false);
        assert!(!tests.is_needed(7), "it goes on");
        assert_eq!(tests.follow(false, 10, SelfTest::Passed), None, "that is the one before");
        assert_eq!(tests.follow(true, 10, SelfTest::Passed), None);
        assert_eq!(tests.follow(true, 13, SelfTest::Testing), None);
        assert_eq!(tests.follow(true, 99, SelfTest::Passed), Some(SelfTest::Passed));
        assert!(!tests.is_needed(7) && tests.is_needed(6) && tests.has_news());
        assert_eq!((tests.take_news(), tests.take_news()), (Some(7), None));
    }

    #[test]
    fn what_was_put_off_is_told_once_unless_it_was_asked_for() {
        let mut tests = SelfTests::new();
        for (is_asked, told) in [(false, Some(SelfTest::PutOff)), (false, None), (true, Some(SelfTest::PutOff))] {
            tests.begin(7, is_asked);
            assert_eq!(tests.follow(true, 0, SelfTest::Testing), None);
            assert_eq!(tests.follow(true, 3, SelfTest::PutOff), told);
            assert!(tests.is_needed(7) && !tests.has_news());
        }
    }
}
