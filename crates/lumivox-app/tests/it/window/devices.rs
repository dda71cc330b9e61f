//! The window with its own device, and with the worker's.

use std::path::Path;

use super::support::{Display, Seen, Window};
use super::{QUICK, home, is_cornell};

const OWN: &str = "own";
const SHARED: &str = "shared";

/// Opens the Cornell box, and waits until a view of it, of only one frame, is complete.
fn open(display: &Display, home: &Path, device: &str, view: &str) -> (Window, Seen) {
    let line = format!("builtin:cornell {QUICK} --view {view} --window-device {device}");
    let mut window = Window::open(display, home, &line);
    window.wait("Cornell box", |window| Some(window.picture()).filter(is_cornell));
    let seen = window.wait_rest();
    (window, seen)
}

fn right(seen: &Seen) -> Seen {
    seen.part((seen.width / 2 + 20, 30), (seen.width, seen.height))
}

/// All ways of a picture to the screen: the picture, another view beside it, one from main memory,
/// and the picture in another size. Views without indirect light take the same ways, but are quick.
fn all_pictures(display: &Display, device: &str) -> Vec<Seen> {
    let home = home();
    let (mut window, first) = open(display, home.path(), device, "albedo");
    let mut seen = vec![first];
    for beside in ["normal", "reference 1"] {
        let before = right(seen.last().unwrap());
        let lines = window.lines().len();
        window.tell(&format!("compare_with {beside}"));
        if beside.starts_with("reference") {
            window.wait_line(lines, "the reference is complete: 1 samples");
        }
        window.wait(beside, |window| {
            Some(()).filter(|()| right(&window.picture()).distance(&before) > 2.0)
        });
        seen.push(window.wait_rest());
    }
    window.tell("compare_with nothing");
    window.resize(560, 400);
    window.wait("another size", |window| {
        window.tell("size");
        window.lines().iter().any(|line| line.starts_with("size 560x")).then_some(())
    });
    seen.push(window.wait_rest());
    assert_eq!(window.close(), 0);
    seen
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn shared_and_separate_devices_show_the_same_pictures() {
    let display = Display::start();
    let [own, shared] = [OWN, SHARED].map(|device| all_pictures(&display, device));
    for (number, (own, shared)) in own.iter().zip(&shared).enumerate() {
        assert!(own == shared, "picture {number}: {} apart", own.distance(shared));
    }
}

const WORKER_LOST: &str = "going on with a new device";

/// Waits until the picture equals `before`.
fn wait_for(window: &mut Window, before: &Seen) {
    window.wait("picture on another device", |window| {
        Some(()).filter(|()| window.picture().distance(before) < 1.0)
    });
}

/// Checks that the worker and the window both still work.
fn try_both(window: &mut Window, before: &Seen) {
    window.tell("view albedo");
    window.wait_change("picture of albedo", before);
    window.tell("view final");
    wait_for(window, before);
    window.wait_rest();
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn separate_devices_recover_from_loss_independently() {
    let (display, home) = (Display::start(), home());
    let (mut window, first) = open(&display, home.path(), OWN, "final");
    window.tell("lose_device");
    let lines = window.wait_line(0, WORKER_LOST);
    wait_for(&mut window, &first);
    window.wait_rest();
    window.tell("lose_device window");
    window.wait_error("the window's device was lost");
    // The picture returns without any input.
    wait_for(&mut window, &first);
    try_both(&mut window, &first);
    let said = window.lines();
    assert!(!said[lines..].iter().any(|line| line.contains(WORKER_LOST)), "{said:?}");
    assert_eq!(window.close(), 0);
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn a_lost_shared_device_is_replaced_for_both() {
    let (display, home) = (Display::start(), home());
    let (mut window, first) = open(&display, home.path(), SHARED, "final");
    let mut lines = 0;
    // After each loss, the two share a new device.
    for loss in ["lose_device", "lose_device window"] {
        window.tell(loss);
        lines = window.wait_line(lines, WORKER_LOST);
        wait_for(&mut window, &first);
        try_both(&mut window, &first);
    }
    assert_eq!(window.close(), 0);
}
