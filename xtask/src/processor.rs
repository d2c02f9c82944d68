//! Time of the processors that steps take: other programs on the computer change a step's seconds, but hardly this.

use std::time::Duration;

/// The unit of `/proc/PID/stat`: `USER_HZ` of Linux, 100 on x86 and Arm (include/asm-generic/param.h).
const PER_SECOND: f64 = 100.0;

/// Time that this process has taken so far, with its children that have ended; `None` on systems without `/proc`.
pub fn taken() -> Option<Duration> {
    read(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// The same of another process.
pub fn of_process(id: u32) -> Option<Duration> {
    read(&std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?)
}

/// Does some work of this process, and says how long it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let before = taken();
    let done = work();
    (done, taken().zip(before).map_or(Duration::ZERO, |(now, then)| now - then))
}

/// The sum of utime, stime, cutime and cstime, the fields 14 to 17 of `proc_pid_stat(5)`.
fn read(stat: &str) -> Option<Duration> {
    sum(stat, 4)
}

/// Time that a thread has taken so far, by its `stat`: utime and stime. The other two are of its whole process.
pub fn of_thread(stat: &str) -> Option<Duration> {
    sum(stat, 2)
}

/// The sum of so many of the times.
fn sum(stat: &str, count: usize) -> Option<Duration> {
    let times: Vec<f64> = fields(stat)?.skip(10).take(count).collect();
    (times.len() == count).then(|| Duration::from_secs_f64(times.iter().sum::<f64>() / PER_SECOND))
}

/// The numbers from the fourth field on. The second field is the program's name in parentheses and may have spaces.
pub fn fields(stat: &str) -> Option<impl Iterator<Item = f64>> {
    let (_, after_name) = stat.rsplit_once(')')?;
    Some(after_name.split_whitespace().skip(1).map_while(|n| n.parse().ok()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_time_and_the_childrens_are_added() {
        let stat = "4711 (a ) name) R 1 2 3 0 -1 4194304 100 200 0 0 150 50 1000 300 20 0 1 0 12345 0 0";
        assert_eq!(read(stat), Some(Duration::from_secs(15)));
        assert_eq!(of_thread(stat), Some(Duration::from_secs(2)));
        assert_eq!((read(""), read("1 (cut) R 1 2")), (None, None));
        assert_eq!(fields(stat).unwrap().next(), Some(1.0), "the parent");
    }
}
