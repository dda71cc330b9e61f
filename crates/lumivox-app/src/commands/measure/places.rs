//! The places that are measured: points and rays of a file, the grid of a workplane, the pixels of a picture.

use std::path::Path;

use glam::{DVec3, UVec2, Vec3};
use lumivox_console::Failure;
use lumivox_render::measure::Workplane;
use lumivox_render::reference::Sensor;
use lumivox_scene::{Picker, Scene, read_regular};

use crate::cli::MeasureArgs;

/// The most points of a workplane or a file.
const MOST: usize = 1 << 20;
/// The most places that are looked at for solids around them.
const MOST_LOOKED_AT: usize = 1 << 14;
/// Cells along the longer side of a workplane without a spacing.
const CELLS: f32 = 24.0;

/// The places, in their order.
#[derive(Clone, Debug)]
pub struct Places {
    kind: Kind,
    /// The places in the scene, m, and the directions of surfaces or lines of sight; none for a picture.
    pub at: Vec<(Vec3, Vec3)>,
    /// The places in the coordinates of the scene's file, as they are given and told.
    given: Vec<DVec3>,
    /// Columns and rows of a workplane or a picture.
    pub size: Option<UVec2>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Points,
    Workplane { height_m: f32 },
    Rays,
    Picture,
}

impl Places {
    /// Reads the file of places, if there is one; a workplane's grid follows once the scene is known.
    ///
    /// # Errors
    /// When the file cannot be read, or a line of it; the message names it.
    pub fn read(args: &MeasureArgs) -> anyhow::Result<Self> {
        let (kind, read) = match (&args.points, &args.rays, args.workplane) {
            (Some(file), _, _) => (Kind::Points, table(file, ["nx", "ny", "nz"], Some(Vec3::Y))?),
            (_, Some(file), _) => (Kind::Rays, table(file, ["dx", "dy", "dz"], None)?),
            (_, _, Some(height_m)) => (Kind::Workplane { height_m }, Vec::new()),
            _ => (Kind::Picture, Vec::new()),
        };
        let (given, at) =
            read.into_iter().map(|(place, towards)| (place, (place.as_vec3(), towards))).unzip();
        Ok(Self { kind, at, given, size: (kind == Kind::Picture).then_some(args.size) })
    }

    /// The places in a scene.
    ///
    /// # Errors
    /// When a workplane has too many cells.
    pub fn of_scene(mut self, scene: &Scene, args: &MeasureArgs) -> anyhow::Result<Self> {
        for (at, given) in self.at.iter_mut().zip(&self.given) {
            at.0 = scene.from_file(*given);
        }
        let Kind::Workplane { height_m } = self.kind else { return Ok(self) };
        let bounds = scene.bounds();
        let [x, z, end_x, end_z] =
            args.area.map_or([bounds.min.x, bounds.min.z, bounds.max.x, bounds.max.z], |area| {
                let [x, z] = [scene.origin.x, scene.origin.z];
                let [low_x, low_z, high_x, high_z] = area;
                [low_x - x, low_z - z, high_x - x, high_z - z].map(|place| place as f32)
            });
        let (width, depth) = (end_x - x, end_z - z);
        let spacing = args.spacing.unwrap_or(width.max(depth) / CELLS);
        let cells = |edge: f32| (edge / spacing).round().max(1.0);
        let count = f64::from(cells(width)) * f64::from(cells(depth));
        if count.is_nan() || count > MOST as f64 {
            return Err(Failure::input(format!(
                "--spacing {spacing}: the workplane of {width} m x {depth} m would have {count:.0} points, but at most \
                 {MOST} are measured; use a greater one, or a smaller --area"
            ))
            .into());
        }
        let plane = Workplane {
            origin: Vec3::new(x, (f64::from(height_m) - scene.origin.y) as f32, z),
            along: Vec3::X * width,
            across: Vec3::Z * depth,
            columns: cells(width) as u32,
            rows: cells(depth) as u32,
        };
        self.at = plane.points().into_iter().map(|point| (point, Vec3::Y)).collect();
        self.given = self.at.iter().map(|(at, _)| scene.to_file(*at)).collect();
        self.size = Some(UVec2::new(plane.columns, plane.rows));
        Ok(self)
    }

    /// Whether luminance is measured, else illuminance.
    pub fn is_luminance(&self) -> bool {
        matches!(self.kind, Kind::Rays | Kind::Picture)
    }

    /// The places that lie inside of something solid, where no light is, by their numbers. With more than a few thousand, only
    /// those are looked at.
    pub fn inside(&self, scene: &Scene) -> Vec<usize> {
        if self.at.is_empty() {
            return Vec::new();
        }
        let picker = Picker::new(scene);
        let looked_at = self.at.iter().take(MOST_LOOKED_AT).enumerate();
        looked_at.filter(|(_, (at, _))| picker.is_inside(*at)).map(|(index, _)| index).collect()
    }

    /// The unit of readings.
    pub fn unit(&self) -> &'static str {
        if self.is_luminance() { "cd/m2" } else { "lux" }
    }

    /// The name of the kind of places.
    pub fn what(&self) -> String {
        match self.kind {
            Kind::Points => "points".to_owned(),
            Kind::Workplane { height_m } => format!("workplane at {height_m} m"),
            Kind::Rays => "rays".to_owned(),
            Kind::Picture => "picture".to_owned(),
        }
    }

    /// The sensors of the path tracer.
    pub fn sensors(&self) -> Vec<Sensor> {
        let is_ray = self.is_luminance();
        let sensor = |&(at, direction): &(Vec3, Vec3)| {
            if is_ray {
                Sensor::Radiance { at, direction }
            } else {
                Sensor::Irradiance { at, normal: direction }
            }
        };
        self.at.iter().map(sensor).collect()
    }

    /// The names of the columns of places.
    pub fn columns(&self) -> &'static [&'static str] {
        match self.kind {
            Kind::Points | Kind::Workplane { .. } => &["x", "y", "z", "nx", "ny", "nz"],
            Kind::Rays => &["x", "y", "z", "dx", "dy", "dz"],
            Kind::Picture => &["column", "row"],
        }
    }

    /// The numbers of a place's columns.
    pub fn numbers(&self, index: usize) -> Vec<f64> {
        match (self.at.get(index).zip(self.given.get(index)), self.size) {
            (Some(((_, direction), given)), _) => {
                let decimal = |number: f32| number.to_string().parse().unwrap_or_default();
                [given.to_array(), direction.to_array().map(decimal)].concat()
            }
            (None, Some(size)) => {
                vec![f64::from(index as u32 % size.x), f64::from(index as u32 / size.x)]
            }
            (None, None) => Vec::new(),
        }
    }
}

/// The places and directions of a CSV file, whose first line may name its columns.
fn table(
    file: &Path,
    directions: [&str; 3],
    without: Option<Vec3>,
) -> anyhow::Result<Vec<(DVec3, Vec3)>> {
    let name = file.display();
    let refuse = |reason: String| anyhow::Error::from(Failure::input(format!("{name}: {reason}")));
    let bytes = read_regular(file)
        .map_err(|error| refuse(format!("cannot read the places: {error}; check its name")))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut names: Vec<&str> = ["x", "y", "z"].into_iter().chain(directions).collect();
    let mut lines = (1..)
        .zip(text.trim_start_matches('\u{feff}').lines())
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
        .peekable();
    if let Some((_, line)) = lines.peek()
        && line.split(',').any(|word| word.trim().parse::<f32>().is_err())
    {
        names = line.split(',').map(str::trim).collect();
        lines.next();
    }
    let column = |wanted: &str| names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let place = ["x", "y", "z"].map(|axis| (axis, column(axis)));
    if let Some((missing, _)) = place.iter().find(|(_, column)| column.is_none()) {
        return Err(refuse(format!(
            "it has no column {missing}; its first line must name x,y,z,{}",
            directions.join(",")
        )));
    }
    let mut places = Vec::new();
    for (number, line) in lines {
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        let read = |axis: &str| -> anyhow::Result<Option<f64>> {
            let Some(text) = column(axis).and_then(|column| words.get(column)) else {
                return Ok(None);
            };
            let value = text.parse::<f64>().ok().filter(|value| (*value as f32).is_finite());
            let reason = || {
                refuse(format!("line {number}, column {axis}: \"{text}\" is not a finite number"))
            };
            value.map(Some).ok_or_else(reason)
        };
        let vector = |axes: [&str; 3]| -> anyhow::Result<Option<DVec3>> {
            let [x, y, z] = [read(axes[0])?, read(axes[1])?, read(axes[2])?];
            Ok(x.zip(y).zip(z).map(|((x, y), z)| DVec3::new(x, y, z)))
        };
        let lacks = |what: &str| refuse(format!("line {number}: it lacks {what}"));
        let at = vector(["x", "y", "z"])?.ok_or_else(|| lacks("x,y,z"))?;
        let direction = vector(directions)?.map(DVec3::as_vec3).or(without);
        let direction = direction.ok_or_else(|| lacks(&directions.join(",")))?;
        if direction.try_normalize().is_none() {
            return Err(refuse(format!("line {number}: its direction is zero")));
        }
        places.push((at, direction));
    }
    if places.is_empty() || places.len() > MOST {
        let count = places.len();
        return Err(refuse(format!("it has {count} places, but must have 1 to {MOST}")));
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, is_of_rays: bool) -> anyhow::Result<Vec<(DVec3, Vec3)>> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("places.csv");
        std::fs::write(&file, text)?;
        if is_of_rays {
            return table(&file, ["dx", "dy", "dz"], None);
        }
        table(&file, ["nx", "ny", "nz"], Some(Vec3::Y))
    }

    #[test]
    fn columns_are_found_by_name_and_by_place() {
        let at = (DVec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 0.0, -1.0));
        for text in [
            "1,2,3,0,0,-1",
            "\u{feff}x,y,z,nx,ny,nz\r\n 1, 2 ,3,0,0,-1\r\n",
            "# a comment\nname,NX,ny,nz,z,y,x\n\ndesk,0,0,-1,3,2,1\n",
        ] {
            assert_eq!(read(text, false).unwrap(), [at], "{text}");
        }
        assert_eq!(read("1,2,3", false).unwrap(), [(at.0, Vec3::Y)]);
        assert_eq!(read("1,2,3,0,0,-1\n1,2,3,0,0,-1", true).unwrap(), [at, at]);
    }

    #[test]
    fn lines_that_cannot_be_read_are_named() {
        for (text, is_of_rays, needle) in [
            ("x,y,z\n1,2,3\n1,two,3", false, "line 3, column y: \"two\""),
            ("1,2,inf", false, "line 1, column z: \"inf\""),
            ("0,0,0\n1,2,inf", false, "line 2, column z: \"inf\""),
            ("1,2", false, "line 1: it lacks x,y,z"),
            ("1,2,3", true, "line 1: it lacks dx,dy,dz"),
            ("1,2,3,0,0,0", true, "line 1: its direction is zero"),
            ("x,z\n1,2", false, "no column y"),
            ("x,y,z\n", false, "it has 0 places"),
        ] {
            let error = read(text, is_of_rays).unwrap_err().to_string();
            assert!(error.contains(needle) && error.contains("places.csv"), "{text}: {error}");
        }
    }
}
