//! Commands for animations.

use lumivox_scene::AnimationChoice;

use crate::arguments::{number, on_or_off};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::{Console, Failure, Reply, shown, suggest};

const FRAMES: Command = Command { group: Group::Frames, ..PLAIN };

/// The latest moment of an animation, s.
const LATEST_S: f32 = 1e4;

pub const TABLE: &[Command] = &[
    Command {
        name: "play",
        summary: "Let the animation play",
        details: "In the window time passes as usual; in scripts each frame of `wait` lasts 1/30 s.",
        example: "play",
        run: Now(|console, _| play(console, true)),
        ..FRAMES
    },
    Command {
        name: "pause",
        summary: "Stop the animation where it is",
        example: "pause",
        run: Now(|console, _| play(console, false)),
        ..FRAMES
    },
    Command {
        name: "time",
        usage: "[SECONDS]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Show a time of the animation in seconds, or print the present one",
        details: "From 0 to 10000 s; beyond its end the animation starts again.",
        example: "time 1.5",
        sets: Some(1),
        run: Now(time),
        ..FRAMES
    },
    Command {
        name: "animation",
        usage: "[NAME|NUMBER|all]",
        count: (0, 1),
        takes: &[Takes::Animation],
        summary: "Choose the animation and start it, or list all",
        details: "Numbers count from 0; `all` plays all at once.",
        example: "animation walk",
        run: Now(animation),
        ..FRAMES
    },
];

fn play(console: &mut Console, is_playing: bool) -> anyhow::Result<Reply> {
    check(console)?;
    console.explorer.play(is_playing);
    Ok(Reply::default())
}

fn check(console: &Console) -> Result<(), Failure> {
    if console.explorer.playback().animation.is_some() {
        return Ok(());
    }
    Err(Failure::input("the scene has no animation; `load` a scene that has one"))
}

fn time(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    check(console)?;
    if let Some(text) = arguments.first() {
        let time_s = number(text, "the time in seconds", 0.0..=LATEST_S)?;
        console.explorer.seek(time_s)?;
        return Ok(Reply::default());
    }
    let playback = console.explorer.playback();
    let state = if playback.is_playing { "playing" } else { "paused" };
    Ok(Reply::say(format!("time {} of {} s, {state}", playback.time_s, playback.duration_s)))
}

fn animation(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    check(console)?;
    let animations = console.explorer.scene().map(lumivox_scene::Scene::animations);
    let animations = animations.unwrap_or_default();
    let Some(text) = arguments.first() else {
        let chosen = console.explorer.playback().animation;
        let line = |(index, animation): (usize, &lumivox_scene::AnimationInfo)| {
            let is_on =
                chosen == Some(AnimationChoice::One(index)) || chosen == Some(AnimationChoice::All);
            let (name, seconds) = (shown::line(&animation.name), animation.duration_s);
            format!("{index} \"{name}\", {seconds} s, {}", on_or_off(is_on))
        };
        let lines: Vec<String> = animations.iter().enumerate().map(line).collect();
        return Ok(Reply::say(lines.join("\n")));
    };
    let named = animations.iter().position(|animation| animation.name == *text);
    let numbered = || text.parse().ok().filter(|number: &usize| *number < animations.len());
    let choice = match named.or_else(numbered) {
        Some(number) => AnimationChoice::One(number),
        None if *text == "all" => AnimationChoice::All,
        None => {
            let known = animations.iter().map(|animation| animation.name.as_str()).chain(["all"]);
            let remedy = suggest::remedy(text, known, "animation");
            return Err(Failure::input(format!("there is no animation \"{text}\"{remedy}")).into());
        }
    };
    console.explorer.set_animation(choice)?;
    Ok(Reply::default())
}

/// The commands that restore the animation's present state.
pub fn lines(console: &Console) -> Vec<String> {
    let playback = console.explorer.playback();
    let mut lines = Vec::new();
    match playback.animation {
        None => return lines,
        Some(AnimationChoice::One(0)) => {}
        Some(AnimationChoice::One(number)) => lines.push(format!("animation {number}")),
        Some(AnimationChoice::All) => lines.push("animation all".to_owned()),
    }
    if playback.time_s > 0.0 || playback.is_moved {
        lines.push(format!("time {}", playback.time_s));
    }
    if playback.is_playing {
        lines.push("play".to_owned());
    }
    lines
}
