//! The places that are measured: points and rays of a file, the grid of a workplane, the pixels of
//! a picture.

use std::path::Path;

use glam::{DVec3, UVec2, Vec3};
use lumivox_console::Failure;
use lumivox_render::measure::Workplane;
use lumivox_render::reference::Sensor;
use lumivox_scene::{Picker, Scene, ShadowMapFineness, read_regular};

use crate::cli::MeasureArgs;

/// The most points of a workplane or a file.
const MOST: usize = 1 << 20;
/// The most places that are checked for lying inside solids, or in shade that shadow maps miss.
const MOST_LOOKED_AT: usize = 1 << 14;
/// The largest distance of a place from the scene, as a multiple of the scene's size.
const FARTHEST: f32 = 1000.0;
/// Cells along the longer side of a workplane if no spacing is given.
const CELLS: f32 = 24.0;

/// The places, in their order.
#[derive(Clone, Debug)]
pub struct Places {
    kind: Kind,
    /// The places in the scene, m, and the directions of surfaces or lines of sight; empty for a
    /// picture.
    pub at: Vec<(Vec3, Vec3)>,
    /// The places in the coordinates of the scene's file, for input and output.
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
    /// Reads the file of places, if there is one; [`Self::of_scene`] makes a workplane's grid.
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

    /// Converts the places to the scene's coordinates; makes the grid of a workplane.
    ///
    /// # Errors
    /// When a workplane has too many cells, or a place is too far from the scene.
    pub fn of_scene(mut self, scene: &Scene, args: &MeasureArgs) -> anyhow::Result<Self> {
        let bounds = scene.bounds();
        let size_m = 2.0 * bounds.radius_m();
        for (number, (at, given)) in (1..).zip(self.at.iter_mut().zip(&self.given)) {
            at.0 = scene.from_file(*given);
            let away_m = at.0.distance(at.0.clamp(bounds.min, bounds.max));
            if away_m > FARTHEST * size_m {
                return Err(Failure::input(format!(
                    "place {number} at {},{},{} lies {away_m} m outside of the scene, which is {size_m} m large; give places in the \
                     coordinates of the scene's file, after --up, --unit and --rotate",
                    given.x, given.y, given.z
                ))
                .into());
            }
        }
        let Kind::Workplane { height_m } = self.kind else { return Ok(self) };
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

    /// `true` if luminance is measured, `false` if illuminance is.
    pub fn is_luminance(&self) -> bool {
        matches!(self.kind, Kind::Rays | Kind::Picture)
    }

    /// The indices of places inside solids, where there is no light. Only the first
    /// [`MOST_LOOKED_AT`] places are checked.
    pub fn inside(&self, picker: &Picker) -> Vec<usize> {
        let looked_at = self.at.iter().take(MOST_LOOKED_AT).enumerate();
        looked_at.filter(|(_, (at, _))| picker.is_inside(*at)).map(|(index, _)| index).collect()
    }

    /// The indices of places in shade that shadow maps miss, since the blocker is lower than two
    /// texels. If there are many places or lights, only some places are checked.
    pub fn in_lost_shade(
        &self,
        scene: &Scene,
        picker: &Picker,
        maps: ShadowMapFineness,
    ) -> Vec<usize> {
        if self.is_luminance() {
            return Vec::new();
        }
        // Sensors use the finer maps only if those belong to cascades.
        let squares = if maps.reach_m.is_some() { maps.squares } else { 0 };
        let maps = ShadowMapFineness { squares, ..maps };
        let (bounds, middle) = (scene.bounds(), middle(&self.at));
        // Start just above the surface that a place may lie in.
        let start_m = 1e-6 * bounds.radius_m();
        let is_lost = |at: (Vec3, Vec3)| {
            let distance = |above_m, way| picker.obstacle_m(at.0 + (start_m + above_m) * at.1, way);
            let mut shades =
                scene.lights.iter().filter_map(|l| maps.shade(l, at, (bounds, middle), distance));
            shades.any(|shade| shade.is_lost)
        };
        let most = (MOST_LOOKED_AT / scene.lights.len().max(1)).max(1);
        let looked_at = self.at.iter().enumerate().step_by(self.at.len().div_ceil(most).max(1));
        looked_at.filter(|(_, at)| is_lost(**at)).map(|(index, _)| index).collect()
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

    /// The values of a place's columns.
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

/// The middle of places: the median along each axis, so that outliers do not move it.
pub fn middle(places: &[(Vec3, Vec3)]) -> Vec3 {
    let along = |axis: usize| {
        let mut values: Vec<f32> = places.iter().map(|(at, _)| at[axis]).collect();
        values.sort_by(f32::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    Vec3::from_array([0, 1, 2].map(along))
}

/// Reads the places and directions of a CSV file, whose first line may name its columns. The
/// separator is the first of tab, semicolon, comma and blank that splits the first line. Fields may
/// be quoted, as spreadsheets write them.
fn table(
    file: &Path,
    directions: [&str; 3],
    without: Option<Vec3>,
) -> anyhow::Result<Vec<(DVec3, Vec3)>> {
    let name = file.display();
    let refuse = |reason: String| anyhow::Error::from(Failure::input(format!("{name}: {reason}")));
    let bytes = read_regular(file)
        .map_err(|error| refuse(format!("cannot read the places: {error}; check its name")))?;
    let text = decoded(&bytes).map_err(refuse)?;
    let lines = (1..).zip(text.lines()).filter(|(_, line)| {
        // Skip the separator line and the empty rows of spreadsheets.
        !line.starts_with("sep=")
            && line.contains(|c: char| !c.is_whitespace() && !",;\"".contains(c))
    });
    // With another separator, commas are decimal commas.
    let separator = ['\t', ';', ',', ' '].into_iter().find(|&separator| {
        let mut rows = lines.clone().filter(|(_, line)| !line.starts_with('#'));
        rows.next().is_some_and(|(_, line)| fields(line, separator).len() > 1)
    });
    let separator = separator.unwrap_or(',');
    let number = |word: &str| {
        let word = if separator == ',' { word.to_owned() } else { word.replace(',', ".") };
        word.parse::<f64>()
    };
    let axes: Vec<&str> = ["x", "y", "z"].into_iter().chain(directions).collect();
    let mut names: Option<Vec<String>> = None;
    let mut places = Vec::new();
    for (line_number, line) in lines {
        let remark = line.trim_start().strip_prefix('#');
        let words = fields(remark.unwrap_or(line), separator);
        let is_header = || {
            let has = |axis: &&str| words.iter().any(|word| is_called(word, axis));
            ["x", "y", "z"].iter().all(has)
        };
        if remark.is_some() || names.is_none() {
            // NumPy writes the names after a #.
            let is_named = if remark.is_some() {
                names.is_none() && is_header()
            } else {
                words.iter().any(|word| number(word).is_err())
            };
            if is_named {
                names = Some(words);
                continue;
            }
            if remark.is_some() {
                continue;
            }
            if words.len() != 3 && words.len() != 6 {
                return Err(refuse(format!(
                    "line {line_number}: it has {} fields and no line above it names them; begin with a line such as \
                     x,y,z,{}; if its commas are those of decimals, write points",
                    words.len(),
                    directions.join(",")
                )));
            }
            names = Some(axes[..words.len()].iter().map(|axis| (*axis).to_owned()).collect());
        }
        let known = names.as_deref().unwrap_or_default();
        let column = |axis: &str| known.iter().position(|name| is_called(name, axis));
        let is_twice = |axis: &&&str| known.iter().filter(|name| is_called(name, axis)).count() > 1;
        if let Some(axis) = axes.iter().find(is_twice) {
            let named = known.join(", ");
            return Err(refuse(format!("it has two columns {axis}: its first line is {named}")));
        }
        let named = |axes: &[&str]| axes.iter().filter(|axis| column(axis).is_some()).count();
        if let Some(missing) = ["x", "y", "z"].iter().find(|axis| column(axis).is_none()) {
            let are_numbers =
                known.iter().any(|name| name.starts_with(|c: char| c.is_ascii_digit()));
            let remedy = if are_numbers { "; write decimals with points" } else { "" };
            return Err(refuse(format!(
                "it has no column {missing}; its first line must name x,y,z,{}, but is {}{remedy}",
                directions.join(","),
                known.join(", ")
            )));
        }
        if ![0, 3].contains(&named(&directions)) {
            let missing = directions.iter().find(|axis| column(axis).is_none());
            return Err(refuse(format!(
                "it has no column {}; a direction needs {}",
                missing.unwrap_or(&""),
                directions.join(",")
            )));
        }
        if words.iter().skip(known.len()).any(|word| !word.is_empty()) {
            return Err(refuse(format!(
                "line {line_number}: it has {} fields, but there are {} columns; write decimals with points, or separate \
                 fields by semicolons",
                words.len(),
                known.len()
            )));
        }
        let vector = |axes: [&str; 3]| -> anyhow::Result<DVec3> {
            let mut vector = DVec3::ZERO;
            for (value, axis) in vector.as_mut().iter_mut().zip(axes) {
                let word =
                    column(axis).and_then(|column| words.get(column)).filter(|w| !w.is_empty());
                let Some(word) = word else {
                    return Err(refuse(format!("line {line_number}: it lacks {}", axes.join(","))));
                };
                let read = number(word).ok().filter(|value| (*value as f32).is_finite());
                *value = read.ok_or_else(|| {
                    refuse(format!(
                        "line {line_number}, column {axis}: \"{word}\" is not a finite number; write numbers such as 1.5, with a point"
                    ))
                })?;
            }
            Ok(vector)
        };
        let at = vector(["x", "y", "z"])?;
        let direction = match (named(&directions), without) {
            (0, Some(direction)) => direction,
            (0, None) => {
                let lacks = directions.join(",");
                return Err(refuse(format!("line {line_number}: it lacks {lacks}")));
            }
            _ => {
                let direction = vector(directions)?;
                let zero = || refuse(format!("line {line_number}: its direction is zero"));
                // Keep the direction's length, unless its square overflows or underflows an f32.
                let unit = direction.try_normalize().ok_or_else(zero)?.as_vec3();
                direction.as_vec3().try_normalize().map_or(unit, |_| direction.as_vec3())
            }
        };
        places.push((at, direction));
    }
    if places.is_empty() {
        return Err(refuse(
            "it has no places; each is a line of numbers such as 1.5,0.8,2".to_owned(),
        ));
    }
    if places.len() > MOST {
        let count = places.len();
        return Err(refuse(format!("it has {count} places, but at most {MOST} are measured")));
    }
    Ok(places)
}

/// Decodes UTF-8 or UTF-16 text, and turns all line ends into line feeds.
fn decoded(bytes: &[u8]) -> Result<String, String> {
    let wide = |order: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2).map(|pair| order([pair[0], pair[1]]));
        String::from_utf16_lossy(&units.collect::<Vec<_>>())
    };
    let text = match bytes {
        [b'P', b'K', 3, 4, ..] => {
            return Err(
                "it is a ZIP archive or a workbook, not a table of text; save it as CSV".to_owned()
            );
        }
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => String::from_utf8_lossy(bytes).into_owned(),
    };
    Ok(text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n"))
}

/// Splits a line into fields, without their quotation marks and the blanks around them. An empty
/// last field is dropped. Between blanks there are no empty fields.
fn fields(line: &str, separator: char) -> Vec<String> {
    if separator == ' ' {
        return line.split_whitespace().map(|field| field.trim_matches('"').to_owned()).collect();
    }
    let (mut fields, mut is_quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => is_quoted = !is_quoted,
            _ if letter == separator && !is_quoted => fields.push(String::new()),
            _ => fields.last_mut().into_iter().for_each(|field| field.push(letter)),
        }
    }
    let mut fields: Vec<String> = fields.iter().map(|field| field.trim().to_owned()).collect();
    if fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

/// Whether a column's name means this axis: `nx` is also called "Normal X" or `normal_x`, and `dx`
/// "direction x".
fn is_called(name: &str, axis: &str) -> bool {
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    let plain = letters.collect::<String>().to_ascii_lowercase();
    let long = match axis.split_at_checked(1) {
        Some(("n", rest @ ("x" | "y" | "z"))) => format!("normal{rest}"),
        Some(("d", rest @ ("x" | "y" | "z"))) => format!("direction{rest}"),
        _ => axis.to_owned(),
    };
    plain == axis || plain == long
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
            "# x, y, z, nx, ny, nz\n1, 2, 3, 0, 0, -1\n",
            "sep=;\nx;y;z;Normal X;Normal Y;Normal Z\r1,0;2;3;0;0;-1\r;;;;;\r",
            "\"name\",\"x\",\"y\",\"z\",\"nx\",\"ny\",\"nz\"\n\"a, b\",\"1\",\"2\",\"3\",\"0\",\"0\",\"-1\"\n,,,,,,\n",
            "x\ty\tz\tnx\tny\tnz\n1\t2\t3\t0\t0\t-1\n",
            "1,2,3,0,0,-1,\n",
            "1,0;2;3;0;0;-1",
            "x y z nx ny nz\n1  2 3 0 0 -1\n",
            "1 2 3 0 0 -1",
        ] {
            assert_eq!(read(text, false).unwrap(), [at], "{text}");
        }
        assert_eq!(read("1,2,3", false).unwrap(), [(at.0, Vec3::Y)]);
        assert_eq!(read("1,2,3,0,0,-1e30\n1,2,3,0,0,-1e-30", false).unwrap(), [at, at]);
        assert_eq!(read("1,2,3,0,0,-1\n1,2,3,0,0,-1", true).unwrap(), [at, at]);
    }

    #[test]
    fn errors_name_the_line_that_cannot_be_read() {
        for (text, is_of_rays, needle) in [
            ("x,y,z\n1,2,3\n1,two,3", false, "line 3, column y: \"two\""),
            ("1,2,inf", false, "line 1, column z: \"inf\""),
            ("0,0,0\n1,2,inf", false, "line 2, column z: \"inf\""),
            (
                "x,y,z\n\"1,5\",\"2,5\",\"0,0\"",
                false,
                "\"1,5\" is not a finite number; write numbers such as 1.5",
            ),
            ("0,25,0,5,0", false, "if its commas are those of decimals, write points"),
            (
                "1,5 2,5 0,0\n1,5 2,5 0,0",
                false,
                "but is 1, 5 2, 5 0, 0; write decimals with points",
            ),
            ("1,2", false, "line 1: it has 2 fields"),
            ("7,1,2,3,0,0,-1", false, "line 1: it has 7 fields"),
            ("x,y,z,nx,ny\n1,2,3,0,0", false, "no column nz"),
            ("x,y,z,nx,ny,nz\n1,2,3,0,0", false, "line 2: it lacks nx,ny,nz"),
            ("PK\u{3}\u{4}", false, "save it as CSV"),
            ("1,2,3", true, "line 1: it lacks dx,dy,dz"),
            ("1,2,3,0,0,0", true, "line 1: its direction is zero"),
            ("x,z\n1,2", false, "no column y"),
            ("x,x,y,z\n0,1,2,3", false, "two columns x: its first line is x, x, y, z"),
            ("x,y,z\n", false, "it has no places"),
            ("x,y,z\n0,25,0,5,0,0", false, "line 2: it has 6 fields, but there are 3 columns"),
            ("1,2,3\n1,2,3,4", false, "line 2: it has 4 fields"),
        ] {
            let error = read(text, is_of_rays).unwrap_err().to_string();
            assert!(error.contains(needle) && error.contains("places.csv"), "{text}: {error}");
        }
    }
}
