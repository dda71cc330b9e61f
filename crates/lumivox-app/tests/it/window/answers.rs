//! How long the window takes to answer while the worker computes.

use std::time::{Duration, Instant};

use super::support::{Display, Window};

/// The longest delay that users do not notice (Miller 1968, "Response time in man-computer
/// conversational transactions", topic 1).
const AT_ONCE: Duration = Duration::from_millis(100);
/// Inputs of each kind.
const INPUTS: usize = 40;

/// The time from an input to the first change in a part of the window that nothing else changes.
fn answer(
    window: &Window,
    part: ((i16, i16), (u16, u16)),
    input: impl FnOnce(&Window),
) -> Duration {
    let before = window.part(part.0, part.1);
    let start = Instant::now();
    input(window);
    while window.part(part.0, part.1) == before {
        assert!(start.elapsed() < Duration::from_secs(20), "an input has no answer");
        std::thread::sleep(Duration::from_millis(1));
    }
    start.elapsed()
}

fn told(name: &str, times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{name}: median {:.0} ms, 95 % {:.0} ms, most {:.0} ms of {} inputs",
        at(0.5).as_secs_f64() * 1e3,
        at(0.95).as_secs_f64() * 1e3,
        at(1.0).as_secs_f64() * 1e3,
        times.len()
    );
    at(1.0)
}

/// Moves the pointer onto a menu and off, and opens and closes it by clicks: nothing else changes
/// the menu bar and the list below it. Meanwhile the Cornell box is rendered with default settings,
/// frame after frame.
#[test]
#[ignore = "a measurement, for a machine that does nothing else, of the release build"]
fn inputs_are_answered_at_once_by_hand() {
    let (display, home) = (Display::start(), tempfile::tempdir().unwrap());
    let folder = home.path().join("config/lumivox");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("window.json"), r#"{"window": [1090, 790]}"#).unwrap();
    let mut window = Window::open(&display, home.path(), "builtin:cornell --frames 60000");
    window.wait("scene", |window| {
        window.lines().iter().any(|line| line.contains("opened")).then_some(())
    });
    let (bar, list) = (((0, 0), (60, 26)), ((8, 60), (120, 60)));
    let names = ["pointer to a menu", "pointer away", "click opens", "click closes"];
    let mut times = [const { Vec::new() }; 4];
    let click = |window: &Window| {
        window.press();
        window.release();
    };
    for round in 0..INPUTS {
        let rest = || std::thread::sleep(Duration::from_millis(450 + 17 * (round as u64 % 20)));
        window.point(500, 12);
        rest();
        times[0].push(answer(&window, bar, |window| window.point(24, 12)));
        rest();
        times[1].push(answer(&window, bar, |window| window.point(500, 12)));
        window.point(24, 12);
        rest();
        times[2].push(answer(&window, list, click));
        rest();
        times[3].push(answer(&window, list, click));
    }
    let most: Vec<Duration> =
        names.iter().zip(&mut times).map(|(name, times)| told(name, times)).collect();
    assert!(most.iter().all(|most| *most <= AT_ONCE), "slower than {AT_ONCE:?}: {most:?}");
    assert_eq!(window.close(), 0);
}
