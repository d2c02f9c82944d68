//! Contexts that stop (F30): the watchdog is no longer fed, and heaters are off before it bites.

use super::{is_off, printing};
use corehbot::fault::Cause;

#[test]
fn f30_a_context_that_hangs_is_found_and_the_watchdog_hungers() {
    for context in 0..3 {
        let mut printer = printing();
        printer.silent[context] = true;
        let fed_before = printer.bench.borrow().fed;
        let time = printer.run_until(5.0, |printer| printer.fault().is_some() && is_off(printer)).unwrap();
        let fault = printer.fault().unwrap();
        println!("context {context} hangs: heaters off after {time:.2} s");
        assert_eq!((fault.cause, usize::from(fault.subject)), (Cause::ContextHangs, context));
        assert!(time <= 0.5, "{time}");
        let fed = printer.bench.borrow().fed;
        printer.run(5.0);
        assert_eq!(printer.bench.borrow().fed, fed, "nobody feeds it any more");
        assert!(fed - fed_before <= 11, "it was fed for 0.2 s at the most");
    }
}

#[test]
fn all_heartbeats_beating_it_is_fed_every_period() {
    let mut printer = printing();
    let fed = printer.bench.borrow().fed;
    printer.run(10.0);
    assert_eq!(printer.bench.borrow().fed - fed, 500);
}
