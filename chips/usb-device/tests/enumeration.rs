//! A host finds the device and talks to its port, and what it does to it at the worst moment.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod answers;
mod common;

use common::{
    Bench, CLOSE, FROM_DEVICE, GET_CONFIGURATION, GET_DEVICE, LINE, OPEN, SET_LINE, TO_DEVICE, clear_halt, halt,
};
use corehbot_usb_model::UsbCore;
use corehbot_usb_model::host::{Outcome, Transfer};

const DONE: Option<Outcome> = Some(Outcome::Done(Vec::new()));

#[test]
fn a_host_finds_the_port_and_hears_itself() {
    let mut bench = Bench::new();
    bench.enumerate();
    for length in [1, 3, 4, 5, 63, 62, 33] {
        let bytes: Vec<u8> = (0..length).collect();
        assert_eq!(bench.echo(&bytes), bytes);
    }
    assert_eq!(bench.breaches(), []);
}

#[test]
fn it_may_be_interrupted_between_any_two_accesses() {
    for every in 1..12 {
        let mut bench = Bench::interrupted(every);
        bench.enumerate();
        for length in 1..20 {
            let bytes: Vec<u8> = (0..length).collect();
            assert_eq!(bench.echo(&bytes), bytes, "every {every}");
        }
        assert_eq!(bench.breaches(), [], "every {every}");
    }
}

#[test]
fn a_suspend_from_before_the_reset_is_over_with_it() {
    let mut bench = Bench::new();
    {
        // Both are latched when the device comes to look.
        let mut core = bench.core();
        core.suspend();
        core.bus_reset();
        core.end_reset();
    }
    bench.settle();
    bench.enumerate();
    assert_eq!(bench.echo(b"up"), b"up");
    bench.bus(UsbCore::suspend);
    bench.bus(UsbCore::resume);
    assert_eq!(bench.echo(b"up again"), b"up again");
    assert_eq!(bench.breaches(), []);
}

#[test]
fn suspend_and_resume_in_one_look_are_no_suspend() {
    let mut bench = Bench::new();
    bench.enumerate();
    {
        let mut core = bench.core();
        core.suspend();
        core.resume();
    }
    bench.settle();
    assert_eq!(bench.echo(b"still here"), b"still here");
}

#[test]
fn clear_halt_begins_with_data0_again() {
    for packets in 0..4 {
        let mut bench = Bench::new();
        bench.enumerate();
        for _ in 0..packets {
            bench.echo(b"odd or even");
        }
        // Linux does so when its driver lets go of the port and takes it again.
        for endpoint in [TO_DEVICE as u8, 0x80 | FROM_DEVICE as u8] {
            assert_eq!(bench.request(clear_halt(endpoint), &[]), DONE);
        }
        assert_eq!(bench.echo(b"after"), b"after", "{packets}");
        assert_eq!(bench.breaches(), []);
    }
}

#[test]
fn an_endpoint_that_is_halted_with_a_packet_in_flight_lives_on() {
    let mut bench = Bench::new();
    bench.enumerate();
    let out = Transfer::Out { endpoint: TO_DEVICE, data: b"in flight".to_vec() };
    assert_eq!(bench.transfer(out), DONE);
    let input = 0x80 | FROM_DEVICE as u8;
    assert_eq!(bench.request(halt(input), &[]), DONE);
    assert_eq!(bench.transfer(Transfer::In { endpoint: FROM_DEVICE, length: 64 }), Some(Outcome::Stalled));
    assert_eq!(bench.request(clear_halt(input), &[]), DONE);
    assert_eq!(bench.echo(b"next"), b"next");
    assert_eq!(bench.request(halt(TO_DEVICE as u8), &[]), DONE);
    let out = Transfer::Out { endpoint: TO_DEVICE, data: b"no".to_vec() };
    assert_eq!(bench.transfer(out), Some(Outcome::Stalled));
    assert_eq!(bench.request(clear_halt(TO_DEVICE as u8), &[]), DONE);
    assert_eq!(bench.echo(b"last"), b"last");
    assert_eq!(bench.breaches(), []);
}

#[test]
fn requests_that_nobody_knows_are_refused_and_the_next_one_is_answered() {
    let mut bench = Bench::new();
    bench.enumerate();
    for setup in [
        [0xC0, 0x33, 1, 2, 3, 4, 64, 0],
        [0x40, 0x33, 1, 2, 3, 4, 0, 0],
        [0xA1, 0xFF, 0, 0, 0, 0, 7, 0],
        [0x80, 6, 9, 9, 0, 0, 255, 0],
        [0, 9, 7, 0, 0, 0, 0, 0],
        [1, 11, 3, 0, 0, 0, 0, 0],
    ] {
        assert_eq!(bench.request(setup, &[]), Some(Outcome::Stalled), "{setup:?}");
        assert!(matches!(bench.request(GET_DEVICE, &[]), Some(Outcome::Done(device)) if device.len() == 18));
    }
    // More data than the device has room for.
    assert_eq!(bench.request([0x21, 0x20, 0, 0, 0, 0, 200, 0], &[1; 200]), Some(Outcome::Stalled));
    assert_eq!(bench.request(SET_LINE, &LINE), DONE);
    assert_eq!(bench.breaches(), []);
}

#[test]
fn a_request_may_be_given_up_at_any_packet() {
    for turns in 0..8 {
        for setup in [GET_CONFIGURATION, GET_DEVICE, SET_LINE, OPEN] {
            let mut bench = Bench::new();
            bench.enumerate();
            let data = if setup == SET_LINE { LINE.to_vec() } else { Vec::new() };
            let id = bench.host.submit(Transfer::Control { setup, data });
            for _ in 0..turns {
                bench.turn();
            }
            bench.host.cancel(id);
            assert_eq!(bench.request(CLOSE, &[]), DONE, "{setup:?} after {turns}");
            let Some(Outcome::Done(whole)) = bench.request(GET_CONFIGURATION, &[]) else {
                panic!("{setup:?}, {turns}")
            };
            assert_eq!((whole[0], usize::from(whole[2])), (9, whole.len()));
            assert_eq!(bench.breaches(), [], "{setup:?} after {turns}");
        }
    }
}

#[test]
fn a_port_that_does_not_listen_holds_the_host_off_and_loses_nothing() {
    let mut bench = Bench::new();
    bench.enumerate();
    bench.listens.set(false);
    let bytes: Vec<u8> = (0..=255).cycle().take(1000).collect();
    let id = bench.host.submit(Transfer::Out { endpoint: TO_DEVICE, data: bytes.clone() });
    for _ in 0..100 {
        bench.turn();
    }
    assert!(bench.host.take_ended().is_none());
    bench.listens.set(true);
    let back = bench.transfer(Transfer::In { endpoint: FROM_DEVICE, length: 1000 });
    assert_eq!(back, Some(Outcome::Done(bytes.clone())));
    assert_eq!((bench.host.cancel(id), &*bench.heard.borrow()), (false, &bytes));
    assert_eq!(bench.breaches(), []);
}

#[test]
fn handshakes_that_get_lost_lose_and_repeat_nothing() {
    for lost in 2..9 {
        let mut bench = Bench::interrupted(7);
        bench.enumerate();
        bench.host.lost_handshakes = lost;
        let bytes: Vec<u8> = (0..=255).cycle().take(2000).collect();
        bench.host.submit(Transfer::Out { endpoint: TO_DEVICE, data: bytes.clone() });
        let back = bench.transfer(Transfer::In { endpoint: FROM_DEVICE, length: 2000 });
        assert_eq!(back, Some(Outcome::Done(bytes)), "every {lost}");
        assert_eq!(bench.breaches(), [], "every {lost}");
    }
}

#[test]
fn a_megabyte_goes_each_way() {
    let mut bench = Bench::new();
    bench.enumerate();
    let bytes: Vec<u8> = (0..1 << 14).map(|n: u32| (n.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    for _ in 0..64 {
        bench.host.submit(Transfer::Out { endpoint: TO_DEVICE, data: bytes.clone() });
        let back = bench.transfer(Transfer::In { endpoint: FROM_DEVICE, length: bytes.len() });
        assert_eq!(back, Some(Outcome::Done(bytes.clone())));
    }
    assert_eq!((bench.heard.borrow().len(), bench.breaches()), (1 << 20, vec![]));
}

#[test]
fn a_reset_at_any_packet_begins_anew() {
    for turns in 0..40 {
        let mut bench = Bench::interrupted(5);
        bench.enumerate();
        bench.host.submit(Transfer::Out { endpoint: TO_DEVICE, data: vec![7; 640] });
        bench.host.submit(Transfer::In { endpoint: FROM_DEVICE, length: 640 });
        bench.host.submit(Transfer::Control { setup: GET_CONFIGURATION, data: Vec::new() });
        for _ in 0..turns {
            bench.turn();
        }
        bench.enumerate();
        assert_eq!(bench.echo(b"anew"), b"anew", "after {turns}");
        assert_eq!(bench.breaches(), [], "after {turns}");
    }
}

#[test]
fn a_packet_that_no_host_sends_is_dropped() {
    for status in 0..16 {
        for endpoint in 0..16 {
            for length in [0, 1, 8, 64, 65, 500] {
                let mut bench = Bench::new();
                bench.enumerate();
                bench.bus(|core| core.inject(status, endpoint, &vec![0xA5; length]));
                bench.enumerate();
                assert_eq!(bench.echo(b"fine"), b"fine", "{status} {endpoint} {length}");
            }
        }
    }
}

#[test]
fn a_flush_that_never_ends_is_not_waited_for() {
    let mut bench = Bench::new();
    bench.enumerate();
    bench.core().break_flush();
    bench.enumerate();
    assert_eq!(bench.echo(b"on"), b"on");
}
