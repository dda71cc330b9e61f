//! `lumivox scenes`: the built-in scenes.

use lumivox_scene::builtin;

use crate::host::Host;

/// Lists the built-in scenes, one in a line.
///
/// # Errors
/// When stdout cannot be written.
pub fn run(host: &Host) -> anyhow::Result<()> {
    host.print(&text())
}

fn text() -> String {
    let plain: Vec<_> =
        builtin::names().iter().filter(|name| !name.ends_with(ROTATED)).copied().collect();
    let width = plain.iter().map(|name| name.len()).max().unwrap_or(0);
    let mut text = String::from("Built-in scenes, to be named as builtin:NAME:\n\n");
    for name in plain {
        text += &format!("  {name:<width$}  {}\n", about(name));
    }
    text += "\nEach but city and interior exists as NAME-rotated, too: turned so that no wall is aligned\nwith the voxels.\n";
    text
}

const ROTATED: &str = "-rotated";

fn about(name: &str) -> &'static str {
    match name {
        "cornell" => "the Cornell box: colour bleeding, soft indirect shadows",
        "two-rooms" => "a wall thinner than a voxel with a doorway: bleeding against leaking",
        "two-rooms-closed" => "the same without the doorway: the dark room must stay black",
        "atrium" => "a two-storey hall under sun and sky: large contrasts, columns, cloths",
        "furnace" => "a closed cube of uniform emission and albedo: the same radiance everywhere",
        "panel" => "a large emitter over a floor: form factors in closed form",
        "spheres" => "roughness from 0.05 to 1, metal and dielectric, over a textured floor",
        "furnished" => "a furnished room: things thinner than a voxel, one lamp",
        "window" => "a low sun and a sky through one window",
        "glow" => "a closed room without lamps, lit by what glows in it",
        "clutter" => "three hundred small things under a lamp and a sky",
        "lacquer" => "deep colours and black that mirror more than they scatter, checkered tiles",
        "city" => "a kilometre of streets, houses with rooms, a stadium; a fly-through",
        "city-night" => "the same by night: lamps in the streets and in rooms",
        "interior" => "a furnished room in the city by day",
        "interior-night" => "the same by night, by the light of its lamp",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_told() {
        for name in builtin::names() {
            let plain = name.strip_suffix(ROTATED).unwrap_or(name);
            assert!(!about(plain).is_empty(), "{plain} is not described");
            assert!(text().contains(&format!("  {plain} ")), "{plain} is not listed");
        }
    }
}
