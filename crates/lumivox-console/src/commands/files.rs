//! Scenes: opening, closing, listing.

use clap::Parser;

use crate::command::Run::Now;
use crate::command::{Command, Edits, Group, MANY, PLAIN, Takes};
use crate::values::camera::{self, CameraChoice};
use crate::{
    Console, Effect, Failure, LoadArgs, Reply, SceneRequest, SceneSource, SourceArgs, shown,
};

const FILES: Command = Command { group: Group::Files, ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "load",
        usage: "[SCENE [OPTIONS...]]",
        count: (0, MANY),
        takes: &[Takes::Scene, Takes::Word(&OPTIONS)],
        summary: "Open a scene, or print the command that opened the present one",
        details: "SCENE is a file, a name in the folder `scenes` (of the working folder, beside the open scene or beside \
                  its folder; with any extension that loads), or builtin:NAME. Options are those of `lumivox render` for \
                  files, rotation, sun, sky and surroundings, such as `--up z --sky 30,120`; the defaults are those of the \
                  program's command line. Settings stay; changes of objects, materials and lights are lost.",
        example: "load builtin:atrium --sky 40,120",
        run: Now(load),
        ..FILES
    },
    Command {
        name: "reload",
        summary: "Read the present scene's file again, without the changes made to the scene",
        example: "reload",
        edits: Edits::Nothing,
        run: Now(|console, _| {
            let opening = console.scene_request().cloned();
            let opening = opening
                .ok_or_else(|| Failure::input("no scene is open; `load SCENE` opens one"))?;
            Ok(Reply::ask(Effect::Open(Box::new(opening))))
        }),
        ..FILES
    },
    Command {
        name: "close",
        summary: "Close the scene",
        example: "close",
        run: Now(|console, _| {
            console.explorer.close();
            Ok(Reply::default())
        }),
        ..FILES
    },
    Command {
        name: "scenes",
        summary: "List the scenes that `load` finds by name",
        example: "scenes",
        run: Now(|console, _| {
            let names = console.names().scenes;
            let lines: Vec<_> = names.iter().map(|name| shown::line(name)).collect();
            Ok(Reply::say(lines.join("\n")))
        }),
        ..FILES
    },
];

/// Options that the completion offers.
const OPTIONS: [&str; 18] = [
    "--scene-in-file",
    "--up",
    "--unit",
    "--crease",
    "--rotate",
    "--allow-outside",
    "--ignore-required",
    "--texture-memory",
    "--geometry-memory",
    "--sun",
    "--sky",
    "--turbidity",
    "--environment",
    "--environment-rotation",
    "--environment-intensity",
    "--surroundings",
    "--no-default-light",
    "--camera",
];

/// The arguments of `load`.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct LoadLine {
    scene: String,
    #[command(flatten)]
    load: LoadArgs,
    #[command(flatten)]
    light: SourceArgs,
    #[arg(long, value_parser = camera::camera, allow_hyphen_values = true)]
    camera: Option<CameraChoice>,
    /// Width over height of the picture for which camera and lamps are found; default: the present
    /// picture's.
    #[arg(long, value_parser = crate::values::number::number(1e-3..=1e3), allow_negative_numbers = true)]
    aspect: Option<f32>,
}

impl SceneRequest {
    /// A request for a scene without options, seen in a picture of this aspect (width over height).
    #[allow(
        clippy::missing_panics_doc,
        reason = "the line is always the same, and a test reads it"
    )]
    pub fn plain(source: SceneSource, aspect: f32) -> Self {
        let LoadLine { load, light, camera, .. } =
            LoadLine::try_parse_from(["scene"]).expect("all options may be left out");
        Self { source, load, light, camera, aspect }
    }
}

fn load(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if arguments.is_empty() {
        return Ok(Reply::say(match console.scene_request() {
            Some(opening) => format!("load {}", line(opening, None)),
            None => "no scene is open; `scenes` lists those that `load` finds by name".to_owned(),
        }));
    }
    let read = LoadLine::try_parse_from(arguments).map_err(|error| told(&error))?;
    let (load, light) = match &console.defaults {
        Some(defaults) if arguments.len() == 1 => defaults.clone(),
        _ => (read.load, read.light),
    };
    let size = console.explorer.settings().size;
    let opening = SceneRequest {
        source: console.outside.find(&read.scene, console.scene_request())?,
        load,
        light,
        camera: read.camera,
        aspect: read.aspect.unwrap_or(size.x as f32 / size.y as f32),
    };
    console.outside.check(&opening)?;
    Ok(Reply::ask(Effect::Open(Box::new(opening))))
}

/// An error of clap as a failure of `load`, in one line.
fn told(error: &clap::Error) -> Failure {
    let text = error.render().to_string();
    let said: Vec<&str> = text
        .lines()
        .take_while(|line| !line.starts_with("Usage"))
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with("For more"))
        .collect();
    let said = said.join("; ");
    Failure::input(format!("load: {}", said.trim_start_matches("error: ")))
}

/// The arguments of `load` that repeat this request. `aspect` is the picture's, if known.
pub fn line(opening: &SceneRequest, aspect: Option<f32>) -> String {
    use crate::line::quote;
    let mut words = vec![quote(&opening.source.to_string())];
    let mut option = |name: &str, value: String| words.push(format!("{name} {}", quote(&value)));
    let LoadArgs {
        scene_in_file,
        up,
        unit,
        crease,
        rotate,
        open_backs,
        allow_outside,
        ignore_required,
        texture_memory,
        geometry_memory,
        second_uvs: _,
    } = &opening.load;
    if let Some(name) = scene_in_file {
        option("--scene-in-file", name.clone());
    }
    if *up != lumivox_scene::UpAxis::Y {
        option("--up", "z".to_owned());
    }
    if unit.to_bits() != 1.0_f32.to_bits() {
        option("--unit", unit.to_string());
    }
    if let Some(degrees) = crease {
        option("--crease", degrees.to_string());
    }
    if *rotate != glam::Vec3::ZERO {
        option("--rotate", crate::arguments::commas(*rotate));
    }
    if *texture_memory != 4 << 30 {
        option("--texture-memory", format!("{}KiB", texture_memory >> 10));
    }
    if *geometry_memory != 8 << 30 {
        option("--geometry-memory", format!("{}KiB", geometry_memory >> 10));
    }
    light_options(&opening.light, &mut option);
    if let Some(camera) = &opening.camera {
        option("--camera", camera_words(camera));
    }
    if let Some(aspect) = aspect
        && aspect.to_bits() != opening.aspect.to_bits()
    {
        option("--aspect", opening.aspect.to_string());
    }
    if *open_backs {
        words.push("--open-backs".to_owned());
    }
    if *allow_outside {
        words.push("--allow-outside".to_owned());
    }
    if *ignore_required {
        words.push("--ignore-required".to_owned());
    }
    if opening.light.no_default_light {
        words.push("--no-default-light".to_owned());
    }
    words.join(" ")
}

fn light_options(light: &SourceArgs, option: &mut impl FnMut(&str, String)) {
    use crate::arguments::commas;
    let SourceArgs {
        sun,
        environment,
        environment_rotation,
        environment_intensity,
        sky,
        turbidity,
        surroundings,
        no_default_light: _,
    } = light;
    if let Some(staging) = surroundings {
        option("--surroundings", staging.name().to_owned());
    }
    if let Some(sun) = sun {
        option("--sun", format!("{},{}", commas(-sun.direction), sun.intensity));
    }
    match environment {
        Some(crate::values::light::Surroundings::Uniform(radiance)) => {
            option("--environment", commas(*radiance));
        }
        Some(crate::values::light::Surroundings::File(file)) => {
            option("--environment", file.display().to_string());
        }
        None => {}
    }
    if let Some(degrees) = environment_rotation {
        option("--environment-rotation", degrees.to_string());
    }
    if environment_intensity.to_bits() != 1.0_f32.to_bits() {
        option("--environment-intensity", environment_intensity.to_string());
    }
    if let Some(towards) = sky {
        option("--sky", commas(*towards));
        option("--turbidity", turbidity.to_string());
    }
}

fn camera_words(camera: &CameraChoice) -> String {
    let CameraChoice::LookAt { position, target, vertical_fov_rad } = camera else {
        return camera.to_string();
    };
    // The command line reads degrees in f32, so a neighbour of `near` may give the exact radians.
    let near = vertical_fov_rad.to_degrees();
    let numbers = [
        near,
        near.next_up(),
        near.next_down(),
        near.next_up().next_up(),
        near.next_down().next_down(),
    ];
    let exact =
        numbers.into_iter().find(|n| n.to_radians().to_bits() == vertical_fov_rad.to_bits());
    let [p, t] = [position, target];
    format!("{},{},{},{},{},{},{}", p.x, p.y, p.z, t.x, t.y, t.z, exact.unwrap_or(near))
}
