//! Baking with Lumivox: light maps and an irradiance volume of a room, by irradiance at points.
//!
//! `cargo run --release -p lumivox --example bake -- [name]` writes `name.png`, a look at both, and
//! `name.json`, the volume: for each probe the irradiance of six sides, as engines store in ambient
//! cubes ("Half-Life 2 / Valve Source Shading", GDC 2004).

mod picture;
mod room;

use std::fmt::Write as _;
use std::time::Instant;

use glam::{UVec3, Vec3};
use lumivox::gpu::{Recorder, Timing, open_device};
use lumivox::{
    GatherSettings, Gi, GiConfig, Grid, Irradiance, Light, LightSource, Shadow, TraceSettings,
};
use room::Quad;

type Failure = Box<dyn std::error::Error>;

/// The edge of a texel of the light maps, m.
const TEXEL_M: f32 = 0.1;
/// Probes along each axis.
const PROBES: UVec3 = UVec3::new(8, 8, 8);

/// The irradiance at a place from six sides: +x -x +y -y +z -z.
pub struct Probe {
    position: Vec3,
    sides: [Vec3; 6],
}

impl Probe {
    /// On a surface there that faces a direction of length 1.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        let side = |axis: usize| self.sides[2 * axis + usize::from(normal[axis] < 0.0)];
        (0..3).map(|axis| normal[axis] * normal[axis] * side(axis)).sum()
    }
}

fn main() -> Result<(), Failure> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "bake".to_owned());
    pollster::block_on(bake(&name))
}

async fn bake(name: &str) -> Result<(), Failure> {
    let (device, queue) = open_device().await?;
    let quads = room::quads();
    let (geometry, _buffers) = room::geometry(&device, &quads);
    let grid = Grid::fit(room::BOUNDS.0, room::BOUNDS.1, 64, Vec3::ZERO)?;
    let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    gi.voxelize(&geometry, Timing::Off).await?;

    // 200 candela in each direction, so that all results are in lux.
    let lamp = LightSource::Point {
        position: Vec3::new(-0.6, 1.6, 0.3),
        intensity: Vec3::splat(200.0),
        radius_m: 0.05,
        range_m: None,
    };
    let lights = [Light { source: lamp, shadow: Shadow::Cone }];
    let lights = gi.bind_lights(&lights, Vec3::ZERO, None);
    let mut recorder = Recorder::new(&device, &queue);
    gi.light(&mut recorder, &lights, 6, &TraceSettings::default())?;
    recorder.submit();

    // Both bakes are lists of points with normals.
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    let texels: Vec<[u32; 2]> = quads.iter().map(|quad| quad.texels(TEXEL_M)).collect();
    for (quad, [width, height]) in quads.iter().zip(&texels) {
        for y in 0..*height {
            for x in 0..*width {
                let place = [(x, width), (y, height)];
                let [u, v] = place.map(|(texel, count)| (texel as f32 + 0.5) / *count as f32);
                positions.push(quad.corner + u * quad.u + v * quad.v);
                normals.push(quad.normal());
            }
        }
    }
    let texel_count = positions.len();
    let (low, high) = room::BOUNDS;
    let places: Vec<Vec3> = (0..PROBES.element_product())
        .map(|i| UVec3::new(i % PROBES.x, i / PROBES.x % PROBES.y, i / (PROBES.x * PROBES.y)))
        .map(|cell| low + (cell.as_vec3() + 0.5) / PROBES.as_vec3() * (high - low))
        .collect();
    for place in &places {
        positions.extend([*place; 6]);
        normals.extend(Vec3::AXES.iter().flat_map(|axis| [*axis, -*axis]));
    }

    let started = Instant::now();
    let gathered = gi.gather(&positions, &normals, &lights, &GatherSettings::default()).await?;
    println!(
        "{texel_count} texels and {} probes in {:.1} s",
        places.len(),
        started.elapsed().as_secs_f32()
    );
    let light: Vec<Vec3> = gathered.iter().map(Irradiance::total).collect();
    let (texel_light, probe_light) = light.split_at(texel_count);

    let probes: Vec<Probe> = places
        .iter()
        .zip(probe_light.chunks_exact(6))
        .map(|(position, light)| Probe {
            position: *position,
            sides: std::array::from_fn(|side| light[side]),
        })
        .collect();
    std::fs::write(format!("{name}.json"), json(&probes))?;

    let mut rest = texel_light;
    let mut maps: Vec<(&Quad, Vec<Vec3>)> = Vec::new();
    for (quad, [width, height]) in quads.iter().zip(&texels) {
        let (own, others) = rest.split_at((width * height) as usize);
        let mean = own.iter().sum::<Vec3>() / own.len() as f32;
        println!("facing {}: {:.0} lux", quad.normal(), mean.y);
        maps.push((quad, own.to_vec()));
        rest = others;
    }
    let middle = (PROBES.x * PROBES.y * (PROBES.z / 2)) as usize;
    let slice: Vec<Vec<&Probe>> = probes[middle..middle + (PROBES.x * PROBES.y) as usize]
        .chunks_exact(PROBES.x as usize)
        .map(|row| row.iter().collect())
        .collect();
    let picture = picture::Picture::of(&maps, &texels, &slice);
    let (path, size) = (format!("{name}.png"), picture.size);
    image::save_buffer(&path, &picture.encoded(), size.x, size.y, image::ColorType::Rgb8)?;
    println!("{path}, {name}.json");
    Ok(())
}

/// The volume as JSON: its probes' places in m and their light in lux, x fastest.
fn json(probes: &[Probe]) -> String {
    let vector = |v: Vec3| format!("[{},{},{}]", v.x, v.y, v.z);
    let mut text = format!("{{\"probes\":[{},{},{}],\"list\":[", PROBES.x, PROBES.y, PROBES.z);
    for (index, probe) in probes.iter().enumerate() {
        let sides: Vec<String> = probe.sides.iter().map(|side| vector(*side)).collect();
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}\n{{\"position\":{},\"sides\":[{}]}}",
            vector(probe.position),
            sides.join(",")
        );
    }
    text + "\n]}\n"
}
