//! Settings of the look of VXCT: units, ranges, defaults.

use lumivox::settings::{Kind, Redoes, Setting, Value};

/// The shape of a kind of cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeShape {
    /// The whole angle, radians, 0.001 to 2. Wider: blurrier, and cheaper.
    pub aperture_rad: f32,
    /// The start of sampling along the cone, in VXCT's units (half the longest edge of the grid's
    /// box), 0 to 4. Higher: nearby surfaces are missed. Lower: surfaces see themselves.
    pub offset: f32,
    /// Step as a share of the cone's diameter, 0.001 to 4. Opacity is not corrected for it: finer
    /// steps darken shadows, and cost more.
    pub distance_factor: f32,
}

/// Parameters of the look, and the look itself. Of the voxel settings it uses only the resolution;
/// it needs the brightness of [`vxct_display`](crate::vxct_display).
/// [`VxctSettings::for_resolution`] has the defaults; the fields document those for 128 voxels.
// The switches are those of VXCT's console.
#[allow(clippy::struct_excessive_bools)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VxctSettings {
    /// Whether cones are traced. If not, Phong's shader shows all its terms, including highlights,
    /// without shadows. Default: yes.
    pub indirect_light: bool,
    /// Whether any of Phong's terms are shown. Default: yes.
    pub phong: bool,
    /// Phong's ambient term. Default: yes.
    pub phong_ambient: bool,
    /// Phong's diffuse term. Default: yes.
    pub phong_diffuse: bool,
    /// Phong's specular term, the highlights. Default: no.
    pub phong_specular: bool,
    /// Light by diffuse cones (`vox_diffuse`). Default: yes.
    pub diffuse: bool,
    /// Reflections by specular cones (`vox_specular`). Default: yes.
    pub specular: bool,
    /// Shadows by cones towards the lights (`vox_shadows`). Default: yes. Without Phong's terms and
    /// the other cones, shadows are shown as grey: the sum over all lights of the share that is not
    /// blocked.
    pub shadows: bool,
    /// The diffuse cone along the normal. Default: yes.
    pub front_cone: bool,
    /// Four diffuse cones along the surface. Default: no. The diffuse light is five times the mean
    /// of all diffuse cones.
    pub side_cones: bool,
    /// Four diffuse cones half-way between the normal and the sides. Default: yes.
    pub intermediate_cones: bool,
    /// Default: 0.55 rad, from 0.19, steps of 0.01.
    pub diffuse_cone: ConeShape,
    /// Default: 0.4 rad, from 0.08, steps of 0.35.
    pub occlusion_cone: ConeShape,
    /// Default: 0.02 rad, from 0.15, steps of 0.3.
    pub specular_cone: ConeShape,
    /// How far above the surface, along its normal, diffuse cones begin, in VXCT's units, 0 to 1.
    /// Default: 0.05.
    pub diffuse_origin_offset: f32,
    /// Strength of shadows, 0 to 16. Default: 1.5. At the distance d from the surface, with the
    /// light at the distance D, a sample counts with smoothstep(0, D, strength sqrt(d)) of its
    /// opacity (VXCT's units). Higher: harder near contacts. 0: no shadows.
    pub shadow_strength: f32,
    /// How fast reflections fade if a light is off the mirrored direction by an angle a: by (1 - (a
    /// - 0.008 pi shininess) / pi)^falloff for each light, 0 to 16. Default: 3. 0: not at all.
    pub shininess_falloff: f32,
}

impl Default for VxctSettings {
    /// The settings for 128 voxels, the renderer's default.
    fn default() -> Self {
        Self::for_resolution(128)
    }
}

impl VxctSettings {
    /// The defaults for voxels along the longest axis.
    ///
    /// VXCT was three programs, of 64, 128 and 256 voxels, each with its own constants; other
    /// resolutions use those of the nearest one by ratio (below 91: 64; from 182 on: 256).
    pub fn for_resolution(resolution: u32) -> Self {
        let cone = |aperture_rad, offset, distance_factor| ConeShape {
            aperture_rad,
            offset,
            distance_factor,
        };
        let program = match resolution {
            0..=90 => 0,
            91..=181 => 1,
            _ => 2,
        };
        Self {
            indirect_light: true,
            phong: true,
            phong_ambient: true,
            phong_diffuse: true,
            phong_specular: false,
            diffuse: true,
            specular: true,
            shadows: true,
            front_cone: true,
            side_cones: false,
            intermediate_cones: true,
            diffuse_cone: cone(0.55, 0.19, [0.1, 0.01, 0.1][program]),
            occlusion_cone: cone(0.4, 0.08, [0.35, 0.35, 0.1][program]),
            specular_cone: cone(
                [0.04, 0.02, 0.01][program],
                [0.15, 0.15, 0.05][program],
                [0.8, 0.3, 0.15][program],
            ),
            diffuse_origin_offset: 0.05,
            shadow_strength: 1.5,
            shininess_falloff: [3.0, 3.0, 2.0][program],
        }
    }

    /// The table of the settings, under the names of VXCT's console.
    pub const SETTINGS: [Setting<Self>; 23] = [
        Setting {
            name: "indirect_light",
            summary: "Cones; without them Phong's shader shows all of its terms, and no shadows",
            get: |s| Value::Switch(s.indirect_light),
            set: |s, v| s.indirect_light = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "phong",
            summary: "Phong's terms",
            get: |s| Value::Switch(s.phong),
            set: |s, v| s.phong = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "phong_ambient",
            summary: "Phong's ambient term",
            get: |s| Value::Switch(s.phong_ambient),
            set: |s, v| s.phong_ambient = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "phong_diffuse",
            summary: "Phong's diffuse term",
            get: |s| Value::Switch(s.phong_diffuse),
            set: |s, v| s.phong_diffuse = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "phong_specular",
            summary: "Phong's highlights",
            get: |s| Value::Switch(s.phong_specular),
            set: |s, v| s.phong_specular = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "vox_diffuse",
            summary: "Light by diffuse cones",
            get: |s| Value::Switch(s.diffuse),
            set: |s, v| s.diffuse = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "vox_specular",
            summary: "Reflections by specular cones",
            get: |s| Value::Switch(s.specular),
            set: |s, v| s.specular = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "vox_shadows",
            summary: "Shadows by cones towards the lights",
            get: |s| Value::Switch(s.shadows),
            set: |s, v| s.shadows = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "front_cone",
            summary: "The diffuse cone along the normal",
            get: |s| Value::Switch(s.front_cone),
            set: |s, v| s.front_cone = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "side_cones",
            summary: "Four diffuse cones along the surface",
            get: |s| Value::Switch(s.side_cones),
            set: |s, v| s.side_cones = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "intermediate_cones",
            summary: "Four diffuse cones half-way between normal and sides",
            get: |s| Value::Switch(s.intermediate_cones),
            set: |s, v| s.intermediate_cones = v.is_on(),
            ..OF_VXCT
        },
        Setting {
            name: "diffuse_aperture",
            aliases: &["da"],
            unit: "rad",
            summary: "Angle of diffuse cones",
            kind: Kind::number(0.001, 2.0),
            get: |s| Value::Number(s.diffuse_cone.aperture_rad),
            set: |s, v| s.diffuse_cone.aperture_rad = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "occlusion_aperture",
            aliases: &["oa"],
            unit: "rad",
            summary: "Angle of shadow cones",
            kind: Kind::number(0.001, 2.0),
            get: |s| Value::Number(s.occlusion_cone.aperture_rad),
            set: |s, v| s.occlusion_cone.aperture_rad = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "specular_aperture",
            aliases: &["sa"],
            unit: "rad",
            summary: "Angle of specular cones",
            kind: Kind::number(0.001, 2.0),
            get: |s| Value::Number(s.specular_cone.aperture_rad),
            set: |s, v| s.specular_cone.aperture_rad = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "diffuse_offset",
            aliases: &["do"],
            unit: "half edges",
            summary: "Start of diffuse cones",
            kind: Kind::number(0.0, 4.0),
            get: |s| Value::Number(s.diffuse_cone.offset),
            set: |s, v| s.diffuse_cone.offset = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "occlusion_offset",
            aliases: &["oo"],
            unit: "half edges",
            summary: "Start of shadow cones",
            kind: Kind::number(0.0, 4.0),
            get: |s| Value::Number(s.occlusion_cone.offset),
            set: |s, v| s.occlusion_cone.offset = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "specular_offset",
            aliases: &["so"],
            unit: "half edges",
            summary: "Start of specular cones",
            kind: Kind::number(0.0, 4.0),
            get: |s| Value::Number(s.specular_cone.offset),
            set: |s, v| s.specular_cone.offset = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "diffuse_dist_factor",
            aliases: &["ddf"],
            unit: "diameters",
            summary: "Step of diffuse cones",
            kind: Kind::number(0.001, 4.0),
            get: |s| Value::Number(s.diffuse_cone.distance_factor),
            set: |s, v| s.diffuse_cone.distance_factor = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "occlusion_dist_factor",
            aliases: &["odf"],
            unit: "diameters",
            summary: "Step of shadow cones",
            help: "Finer steps are darker: opacity is not corrected for them. VXCT's documentation calls it `ddf` by mistake.",
            kind: Kind::number(0.001, 4.0),
            get: |s| Value::Number(s.occlusion_cone.distance_factor),
            set: |s, v| s.occlusion_cone.distance_factor = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "specular_dist_factor",
            aliases: &["sdf"],
            unit: "diameters",
            summary: "Step of specular cones",
            help: "Finer steps are darker: opacity is not corrected for them. VXCT's documentation calls it `ddf` by mistake.",
            kind: Kind::number(0.001, 4.0),
            get: |s| Value::Number(s.specular_cone.distance_factor),
            set: |s, v| s.specular_cone.distance_factor = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "diffuse_origin_offset",
            aliases: &["doo"],
            unit: "half edges",
            summary: "Start of diffuse cones above the surface",
            help: "VXCT sets it and does not print it.",
            kind: Kind::number(0.0, 1.0),
            get: |s| Value::Number(s.diffuse_origin_offset),
            set: |s, v| s.diffuse_origin_offset = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "shadow_str",
            aliases: &["ss"],
            summary: "How fast what is in the way of light becomes a full shadow",
            help: "At 0 there are no shadows.",
            kind: Kind::number(0.0, 16.0),
            get: |s| Value::Number(s.shadow_strength),
            set: |s, v| s.shadow_strength = number(v),
            ..OF_VXCT
        },
        Setting {
            name: "shininess_falloff",
            summary: "How fast reflections fade where a light stands off the mirrored direction",
            help: "At 0 they do not fade at all. `sf NUMBER` is the same; without a number `sf` renders a frame.",
            kind: Kind::number(0.0, 16.0),
            get: |s| Value::Number(s.shininess_falloff),
            set: |s, v| s.shininess_falloff = number(v),
            ..OF_VXCT
        },
    ];
}

/// A row of the table.
const OF_VXCT: Setting<VxctSettings> =
    Setting { needs: Some(("look", crate::NAME)), redoes: Redoes::Frames, ..Setting::ROW };

/// The value as a number; NaN if it is of another kind.
fn number(value: Value) -> f32 {
    value.number().unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_render::look::Look as _;

    #[test]
    fn defaults_match_vxct_at_each_resolution() {
        let [coarse, middle, fine] = [64, 128, 256].map(VxctSettings::for_resolution);
        let diffuse =
            |factor| ConeShape { aperture_rad: 0.55, offset: 0.19, distance_factor: factor };
        assert_eq!(coarse.diffuse_cone, diffuse(0.1));
        assert_eq!(middle.diffuse_cone, diffuse(0.01));
        assert_eq!(fine.diffuse_cone, diffuse(0.1));
        let apertures = [coarse, middle, fine].map(|s| s.specular_cone.aperture_rad);
        assert_eq!(apertures, [0.04, 0.02, 0.01]);
        assert_eq!([coarse, fine].map(|s| s.shininess_falloff), [3.0, 2.0]);
        assert_eq!(VxctSettings::for_resolution(16), coarse);
        assert_eq!(VxctSettings::for_resolution(96), middle);
        assert_eq!(VxctSettings::for_resolution(1024), fine);
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        type Set = fn(&mut VxctSettings, f32);
        let cases: [(Set, f32, f32); 6] = [
            (|s, v| s.diffuse_cone.aperture_rad = v, 0.001, 2.0),
            (|s, v| s.occlusion_cone.offset = v, 0.0, 4.0),
            (|s, v| s.specular_cone.distance_factor = v, 0.001, 4.0),
            (|s, v| s.diffuse_origin_offset = v, 0.0, 1.0),
            (|s, v| s.shadow_strength = v, 0.0, 16.0),
            (|s, v| s.shininess_falloff = v, 0.0, 16.0),
        ];
        for (set, low, high) in cases {
            let accepts = |value: f32| {
                let mut settings = VxctSettings::default();
                set(&mut settings, value);
                settings.validate().is_ok()
            };
            assert!(accepts(low) && accepts(high), "{low} {high}");
            assert!(!accepts(low - 1e-3) && !accepts(high + 1e-3) && !accepts(f32::NAN));
        }
    }
}
