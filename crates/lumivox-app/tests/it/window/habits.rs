//! The window's own messages: the light under the pointer, and notes.

use super::support::{Display, Window};
use super::{QUICK, home, is_cornell, open_cornell};

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn the_status_bar_shows_light_under_the_pointer() {
    let (display, home) = (Display::start(), home());
    let mut window = open_cornell(&display, home.path());
    window.wait_rest();
    let status = |window: &Window| {
        let seen = window.see();
        let bottom = seen.height;
        // Cut off the left part, which shows changing times.
        seen.part((seen.width - 200, bottom - 22), (seen.width, bottom))
    };
    window.point(240, 10);
    window.wait_rest();
    let before = status(&window);
    window.point(240, 200);
    let inside = window.wait("light in the status bar", |window| {
        Some(status(window)).filter(|now| *now != before)
    });
    window.point(240, 10);
    window.wait("nothing again", |window| Some(()).filter(|()| status(window) == before));
    window.point(240, 120);
    window.wait("another light", |window| {
        let now = status(window);
        (now != before && now != inside).then_some(())
    });
    assert_eq!(window.close(), 0);
}

/// A scene that only glows shows a note; another scene does not.
#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn a_scene_lit_only_by_emission_shows_a_note() {
    let (display, home) = (Display::start(), home());
    let mut window = Window::open(&display, home.path(), &format!("builtin:furnace {QUICK}"));
    let note = |window: &Window| {
        let seen = window.picture();
        let (width, height) = (seen.width, seen.height);
        seen.part((width / 2 - 60, height - 60), (width / 2 + 60, height - 10))
    };
    let is_dark = |[r, g, b]: [f32; 3]| r.max(g).max(b) < 60.0;
    window.wait("note over a bright wall", |window| {
        let bright = window.picture().share(is_dark) < 0.3;
        (bright && note(window).share(is_dark) > 0.3).then_some(())
    });
    window.tell("load builtin:cornell");
    window.wait("no note", |window| Some(()).filter(|()| is_cornell(&window.picture())));
    assert_eq!(window.close(), 0);
}
