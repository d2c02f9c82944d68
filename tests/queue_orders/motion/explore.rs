//! Every choice is taken, one run after the other.

use std::cell::RefCell;

/// The choices of a run: the one taken, and their number.
#[derive(Default)]
struct Path {
    taken: Vec<(usize, usize)>,
    at: usize,
}

thread_local! {
    static PATH: RefCell<Path> = RefCell::default();
}

/// One of `options`, from 0 on.
pub fn choose(options: usize) -> usize {
    PATH.with_borrow_mut(|path| {
        if path.at == path.taken.len() {
            path.taken.push((0, options));
        }
        let (taken, of) = path.taken[path.at];
        assert_eq!(of, options, "a run is not repeatable");
        path.at += 1;
        taken
    })
}

/// Does `run` once for every sequence of choices, and returns the number of sequences.
pub fn explore(mut run: impl FnMut()) -> u32 {
    PATH.set(Path::default());
    let mut runs = 0;
    loop {
        run();
        runs += 1;
        let is_last = PATH.with_borrow_mut(|path| {
            path.at = 0;
            while path.taken.pop_if(|(taken, of)| *taken + 1 == *of).is_some() {}
            path.taken.last_mut().map(|(taken, _)| *taken += 1).is_none()
        });
        if is_last {
            return runs;
        }
    }
}
