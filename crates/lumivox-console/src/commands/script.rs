//! The command `script`: the commands that lead to the present picture.

use lumivox_explorer::parameters::{Parameter, find_parameter};
use lumivox_explorer::{FRAME_BUDGET_MS, PreparedScene, Revoxelize};
use lumivox_render::Renderer;
use lumivox_scene::Light;

use super::{animation, camera, files, lights, materials, objects, parameters, voxels};
use crate::line::quote;
use crate::{Console, Reply, properties};

/// The command `script [FILE]`.
pub fn run(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let lines = lines(console);
    let Some(file) = arguments.first() else { return Ok(Reply::say(lines.join("\n"))) };
    console.outside.check_output(file)?;
    console.outside.write(file, (lines.join("\n") + "\n").as_bytes())?;
    Ok(Reply::say(format!("{file}: {} commands", lines.len())))
}

/// The commands. Their order matters: the scene's lighting depends on size and preset, and objects
/// move in the grid.
fn lines(console: &Console) -> Vec<String> {
    let explorer = &console.explorer;
    let settings = explorer.settings();
    let mut lines = vec![format!("size {}x{}", settings.size.x, settings.size.y)];
    // A look's cones depend on the resolution when it is chosen.
    lines.push(format!("resolution {}", settings.resolution));
    lines.push(format!("preset {}", explorer.preset().name()));
    let preset = parameters::of_preset(console);
    let mut differing: Vec<&Parameter> =
        parameters::differing(settings, &preset).filter(|p| p.name != "resolution").collect();
    // Settings that others require come first; those that require others come last, such as the
    // view of an octree's nodes.
    differing.sort_by_key(|parameter| match parameter.name {
        "look" | "volume" => 0,
        "view" | "level" => 2,
        _ => 1,
    });
    let line = |parameter: &Parameter| format!("{} {}", parameter.name, parameter.get(settings));
    lines.extend(differing.into_iter().map(line));
    if explorer.revoxelize != Revoxelize::WhenMoved {
        lines.push(voxels::revoxelize_line(explorer.revoxelize));
    }
    let budget_ms = explorer.pacing.budget_ms;
    if budget_ms.to_bits() != FRAME_BUDGET_MS.to_bits() {
        lines.push(format!("frame_budget {budget_ms}"));
    }
    let (Some(opened), Some(opening)) = (explorer.opened(), console.scene_request()) else {
        return lines;
    };
    let aspect = settings.size.x as f32 / settings.size.y as f32;
    lines.push(format!("load {}", files::line(opening, Some(aspect))));
    if settings.look.is_some() {
        // Opening a scene sets the exposure that its look needs.
        let shown = ["exposure", "tone_map"].into_iter().filter_map(find_parameter);
        lines.extend(shown.map(line));
    }
    let own_bounds = opened.scene().grid_bounds;
    if let Some(bounds) = settings.grid_bounds.filter(|box_| own_bounds != Some(*box_)) {
        lines.push(voxels::bounds_line(bounds, explorer.has_fitted_grid()));
    }
    lines.extend(animation::lines(console));
    lines.extend(object_lines(console, opened));
    lines.extend(material_lines(console, opened));
    let (surroundings, has_sky) = surroundings_lines(console, opened);
    lines.extend(surroundings);
    lines.extend(light_lines(console, opened, has_sky));
    lines.extend(camera_lines(console, opened));
    lines.extend(super::ray::line(console));
    if explorer.renderer().is_some_and(Renderer::has_stale_voxels) {
        lines.push(
            "# in the picture, voxels have not followed the moved objects; in this script they will"
                .to_owned(),
        );
    }
    lines
}

fn object_lines(console: &Console, opened: &PreparedScene) -> Vec<String> {
    let explorer = &console.explorer;
    let mut lines = Vec::new();
    for (object, name) in
        explorer.object_names().iter().enumerate().take(opened.scene().instances.len())
    {
        let name = quote(name);
        let (is_hidden, is_static) = explorer.marks(object);
        if let Some(is_hidden) = is_hidden {
            lines.push(format!("{} {name}", if is_hidden { "hide" } else { "show" }));
        }
        if let Some(is_static) = is_static {
            lines.push(format!("static {name} {}", if is_static { "on" } else { "off" }));
        }
        let edit = explorer.local_edit(object).unwrap_or_default();
        if edit != glam::Mat4::IDENTITY {
            lines.push(format!("matrix {name} {}", objects::matrix_words(edit)));
        }
    }
    lines
}

fn material_lines(console: &Console, opened: &PreparedScene) -> Vec<String> {
    let (scene, original) = (opened.scene(), opened.original());
    let names = console.explorer.material_names();
    let changed = scene.materials.iter().zip(&original.materials).zip(names);
    changed
        .filter_map(|((material, original), name)| {
            let difference = properties::difference(materials::PROPERTIES, material, original);
            let words = difference.join(" ");
            (!words.is_empty()).then(|| format!("material {} {words}", quote(&name)))
        })
        .collect()
}

/// The commands for the surroundings of the scene; `true` if they add a sun.
fn surroundings_lines(console: &Console, opened: &PreparedScene) -> (Vec<String>, bool) {
    use crate::arguments::{commas, degrees};
    let (scene, original) = (opened.scene(), opened.original());
    let (now, was) = (&scene.environment, &original.environment);
    let mut lines = Vec::new();
    let is_same_map = match (&now.map, &was.map) {
        (Some(now), Some(was)) => std::sync::Arc::ptr_eq(now, was),
        (None, None) => true,
        _ => false,
    };
    let mut has_sky = false;
    let (mut radiance, mut rotation_rad) = (was.radiance, was.rotation_rad);
    if !is_same_map {
        let maker = match &now.map {
            Some(map) => console.maker_of(map).map(str::to_owned),
            None => Some(format!("environment {}", commas(now.radiance))),
        };
        has_sky = maker.as_ref().is_some_and(|maker| maker.starts_with("sky"));
        radiance = if now.map.is_some() { glam::Vec3::ONE } else { now.radiance };
        rotation_rad = 0.0;
        lines.push(maker.unwrap_or_else(|| {
            "# the surroundings were made elsewhere and are left out".to_owned()
        }));
    }
    if now.radiance != radiance {
        lines.push(format!("environment_intensity {}", commas(now.radiance)));
    }
    if now.rotation_rad.to_bits() != rotation_rad.to_bits() {
        lines.push(format!("environment_rotation {}", degrees(now.rotation_rad)));
    }
    (lines, has_sky)
}

fn light_lines(console: &Console, opened: &PreparedScene, has_sky: bool) -> Vec<String> {
    let (scene, original) = (opened.scene(), opened.original());
    if !has_sky && scene.lights == original.lights {
        return Vec::new();
    }
    let names = console.explorer.light_names();
    let is_alike = |(now, was): (&Light, &Light)| now.name == was.name && now.kind == was.kind;
    let is_same_list = scene.lights.len() == original.lights.len()
        && scene.lights.iter().zip(&original.lights).all(is_alike);
    if is_same_list && !has_sky {
        let changed = scene.lights.iter().zip(&original.lights).zip(names);
        return changed
            .filter_map(|((light, original), name)| {
                let words = properties::difference(&lights::PROPERTIES, light, original).join(" ");
                (!words.is_empty()).then(|| format!("light {} {words}", quote(&name)))
            })
            .collect();
    }
    // Lights were added, removed or reordered. The last bits of the sum of light depend on their
    // order.
    let mut lines = vec!["remove_light all".to_owned()];
    for (light, name) in scene.lights.iter().zip(names) {
        let fields = light.kind.fields();
        let properties = fields.map(|field| format!("{} {}", field.name, field.value(light)));
        let properties: Vec<String> = properties.collect();
        lines.push(format!(
            "add_light {} {} {}",
            light.kind.word(),
            quote(&name),
            properties.join(" ")
        ));
    }
    lines
}

fn camera_lines(console: &Console, opened: &PreparedScene) -> Vec<String> {
    let explorer = &console.explorer;
    let mut lines = Vec::new();
    for (number, original) in opened.positions().iter().enumerate() {
        let stored = explorer.position(number);
        if stored != original.as_ref()
            && let Some(stored) = stored
        {
            lines.push(format!("camera_axes {}", camera::axes_words(stored)));
            lines.push(format!("store {}", number + 1));
        }
    }
    for (name, stored) in explorer.stored_cameras() {
        lines.push(format!("camera_axes {}", camera::axes_words(stored)));
        lines.push(format!("store {}", quote(name)));
    }
    let is_original = opened.camera() == explorer.camera() && lines.is_empty();
    if !is_original {
        lines.push(format!("camera_axes {}", camera::axes_words(explorer.camera())));
    }
    lines
}
