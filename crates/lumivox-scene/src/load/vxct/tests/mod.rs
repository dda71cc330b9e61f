mod models;

use std::collections::HashMap;
use std::f32::consts::PI;

use glam::{Mat4, Quat, Vec3};

use crate::{
    Attenuation, Bounds, Instance, LightKind, LoadOptions, Phong, Scene, SceneError, Shading,
    Strengths,
};

/// Two objects, the first a triangle with a colour at a vertex.
const OBJ: &[u8] =
    b"mtllib no.mtl\no first\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n\
    o second\nv 0 0 5\nf 1 2 4\nf 2 3 4\n";

fn load_from(name: &str, text: &str, files: &[&str]) -> Result<Scene, SceneError> {
    let files: HashMap<_, _> =
        files.iter().map(|file| ((*file).to_owned(), OBJ.to_vec())).collect();
    let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
    Scene::from_memory(name, text.as_bytes(), &mut options)
}

fn load(text: &str) -> Result<Scene, SceneError> {
    load_from("scenes/a.scene", text, &["models/tri.obj"])
}

/// The scene with this text in its block, and the warnings.
fn body(text: &str) -> (Scene, Vec<String>) {
    let scene = load(&format!("scene {{ {text} }}")).unwrap();
    let warnings = scene.notes.warnings.clone();
    (scene, warnings)
}

/// A scene of one cube with this text in the model's block.
fn cube(text: &str) -> (Scene, Vec<String>) {
    body(&format!("model {{ primitive = cube {text} }}"))
}

fn fault(text: &str) -> String {
    load(text).unwrap_err().to_string()
}

fn phong(scene: &Scene) -> Phong {
    match scene.materials[0].shading {
        Shading::Phong(phong) => phong,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_model_has_defaults() {
    let (scene, warnings) = cube("");
    assert_eq!(warnings, [""; 0]);
    let instance = Instance { name: "model 1".to_owned(), ..Instance::default() };
    assert_eq!(scene.instances, [instance]);
    assert_eq!(scene.bounds(), Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) });
    assert_eq!(scene.triangle_count(), 12);
    assert!(scene.materials[0].double_sided);
    assert_eq!(scene.materials[0].emissive, Vec3::ZERO);
    let expected = Phong {
        diffuse: Vec3::splat(0.85),
        specular: Vec3::splat(2.0 * 0.5 / 34.0),
        shininess: 32.0,
        ..Phong::default()
    };
    assert_eq!(phong(&scene), expected);
    let strengths = Strengths { is_rounded: true, ..Strengths::default() };
    assert_eq!(scene.materials[0].strengths, Some(strengths));
    // The cube is flat: each normal is along an axis.
    assert!(scene.meshes[0].normals.iter().all(|n| n.abs().max_element() == 1.0));
}

#[test]
fn vxct_scenes_get_the_unit_cube_and_vxct_cameras() {
    let (scene, _) = cube("scale = 0.1");
    assert_eq!(scene.grid_bounds, Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }));
    assert_eq!(scene.voxel_bounds(), scene.grid_bounds.unwrap());
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["vxct", "pos1", "pos2"]);
    assert_eq!(scene.cameras[0].position, Vec3::new(0.0, 0.0, 3.0));
    assert_eq!(scene.cameras[0].vertical_fov_rad, PI / 4.0);
    assert_eq!(scene.cameras[2].position, Vec3::new(0.0, 0.0, 1.8));
    assert!(scene.cameras[1].forward.abs_diff_eq(Vec3::new(-0.586, -0.070, -0.807), 1e-3));
}

#[test]
fn lights_have_defaults_and_vxct_intensity() {
    let (scene, warnings) = body(
        "light { } light { position { x = 1f y = -2.5f, z = 3 } color { r = 2 g = 0.5 b = 0 } att_constant = 0 att_linear = 0 att_quadratic = 4 }",
    );
    assert_eq!(warnings, [""; 0]);
    let [plain, other] = scene.lights.as_slice() else { panic!("{:?}", scene.lights) };
    assert_eq!(
        (plain.name.as_str(), plain.position, plain.color),
        ("light 1", Vec3::ZERO, Vec3::ONE)
    );
    assert_eq!(
        plain.attenuation,
        Some(Attenuation { constant: 1.0, linear: 0.15, quadratic: 0.45 })
    );
    assert_eq!((plain.kind, plain.range_m), (LightKind::Point, None));
    // A white diffuse surface at a metre: I / pi, against VXCT's 1 / (1 + .15 + .45).
    assert!((plain.intensity / PI - 1.0 / 1.6).abs() < 1e-6);
    assert_eq!(other.position, Vec3::new(1.0, -2.5, 3.0));
    assert_eq!(other.color, Vec3::new(2.0, 0.5, 0.0));
    assert_eq!(other.name, "light 2");
    assert!((other.intensity - PI / 4.0).abs() < 1e-6);
    assert_eq!(other.attenuation.unwrap().at(2.0), 1.0 / 16.0);
}

#[test]
fn the_matrix_is_t_rx_ry_rz_s_sxyz() {
    let (scene, _) = cube(
        "position { x = 1 y = 2 z = 3 } rotation { x = 30 y = 40 z = 50 } scale = 0.5 scale_x = 2 \
         scale_y = 3 scale_z = 4",
    );
    let [x, y, z] = [30.0_f32, 40.0, 50.0].map(f32::to_radians);
    let expected = Mat4::from_translation(Vec3::new(1.0, 2.0, 3.0))
        * Mat4::from_quat(Quat::from_rotation_x(x))
        * Mat4::from_quat(Quat::from_rotation_y(y))
        * Mat4::from_quat(Quat::from_rotation_z(z))
        * Mat4::from_scale(Vec3::splat(0.5))
        * Mat4::from_scale(Vec3::new(2.0, 3.0, 4.0));
    let matrix = scene.instances[0].world_from_local;
    assert!(matrix.abs_diff_eq(expected, 1e-5), "{matrix} {expected}");
    // In the opposite order, about x first, y would become z, and then x.
    let (scene, _) = cube("rotation { x = 90 y = 90 z = 0 }");
    let turned = scene.instances[0].world_from_local.transform_vector3(Vec3::Y);
    assert!(turned.abs_diff_eq(Vec3::Z, 1e-6), "{turned}");
}

#[test]
fn mirrored_models_get_flipped_winding() {
    let (scene, warnings) = body(
        "model { primitive = cube } model { primitive = cube scale_x = -1 } \
         model { primitive = cube scale = -1 }",
    );
    assert_eq!(warnings, [""; 0]);
    let meshes: Vec<_> = scene.instances.iter().map(|instance| instance.mesh).collect();
    assert_eq!(meshes, [0, 1, 1]);
    let turned: Vec<_> = scene.meshes[0].triangles().map(|[a, b, c]| [a, c, b]).collect();
    assert!(scene.meshes[1].triangles().eq(turned));
}

#[test]
fn only_the_word_true_counts_as_true() {
    let marks = |text: &str| {
        let (scene, warnings) = cube(text);
        let cube = &scene.instances[0];
        (!cube.is_hidden, !cube.is_voxelized, warnings.len())
    };
    assert_eq!(marks(""), (true, false, 0));
    assert_eq!(marks("active = false"), (false, false, 0));
    assert_eq!(marks("active = true static = true"), (true, true, 0));
    assert_eq!(marks("static = false"), (true, false, 0));
    assert_eq!(marks("active = True static = true,"), (false, false, 2));
    assert_eq!(marks("active = 1"), (false, false, 1));
    let (_, warnings) = cube("active = True");
    assert_eq!(warnings, ["1:43: \"True\" for \"active\" counts as false; only true is true"]);
}

#[test]
fn numbers_may_end_in_f_and_a_comma() {
    for (text, number) in [
        ("2", 2.0),
        ("2f", 2.0),
        ("2.5f,", 2.5),
        ("2.5,", 2.5),
        (".5", 0.5),
        ("5.f", 5.0),
        ("-1e-2f", -0.01),
        ("+3E1", 30.0),
        ("1e-60", 0.0),
    ] {
        let (scene, warnings) = body(&format!("light {{ position {{ x = {text} y = 0 z = 0 }} }}"));
        assert_eq!(scene.lights[0].position.x, number, "{text}");
        assert_eq!(warnings, [""; 0]);
    }
    for text in [
        "x", "1.0ff", "1,f", "0x10", "inf", "nan", "f", ",", "-", ".", "1e", "--1", "NaN",
        "infinity",
    ] {
        let message = fault(&format!("scene {{\n model {{ scale = {text} }} }}"));
        let expected = format!(
            "scenes/a.scene:2:18: found \"{text}\", expected a number such as 0.5, 0.5f or -1e3"
        );
        assert_eq!(message, expected);
    }
    for text in ["1e39", "-1e39f", "9e999,"] {
        let message = fault(&format!("scene {{ light {{ att_linear = {text} }} }}"));
        assert!(
            message.contains(&format!("1:30: found \"{text}\", expected a number between")),
            "{message}"
        );
    }
}

#[test]
fn a_missing_component_takes_its_first_siblings_value() {
    let (scene, warnings) =
        body("light { position { y = 2 } color { b = 0.5 r = 1 } } light { position { } }");
    assert_eq!(scene.lights[0].position, Vec3::splat(2.0));
    assert_eq!(scene.lights[0].color, Vec3::new(1.0, 0.5, 0.5));
    assert_eq!(scene.lights[1].position, Vec3::ZERO);
    let expected = [
        "1:17: \"position\" has no \"x\", which takes the value of \"y\"",
        "1:17: \"position\" has no \"z\", which takes the value of \"y\"",
        "1:36: \"color\" has no \"g\", which takes the value of \"b\"",
        "1:70: \"position\" has no number and keeps its default",
    ];
    assert_eq!(warnings, expected);
}

#[test]
fn of_duplicate_entries_the_first_counts() {
    let (scene, warnings) =
        cube("name = a name = b scale = 2 scale = x position { x = 1 x = 2 y = 0 z = 0 }");
    assert_eq!(scene.instances[0].name, "a");
    assert_eq!(scene.instances[0].world_from_local.x_axis.x, 2.0);
    assert_eq!(scene.instances[0].world_from_local.w_axis.x, 1.0);
    assert_eq!(warnings[0], "1:43: \"name\" of a model comes twice, the first counts");
    assert_eq!(warnings.len(), 3);
    let scene = load("scene { name = x light { } } scene { light { } light { } }").unwrap();
    assert_eq!(scene.lights.len(), 1);
    let expected = ["1:30: the first scene of the file counts, the others were ignored"];
    assert_eq!(scene.notes.warnings, expected);
    assert_eq!(scene.notes.scenes, ["x", "1"]);
}

#[test]
fn another_scene_can_be_asked_for() {
    let text = b"scene { name = x light { } } scene { light { } light { } }";
    let lights = |wanted: &str| {
        let scene = Some(wanted.to_owned());
        let mut options = LoadOptions { scene, ..LoadOptions::default() };
        Scene::from_memory("a.scene", text, &mut options).map(|scene| scene.lights.len())
    };
    assert_eq!(lights("x").unwrap(), 1);
    assert_eq!(lights("1").unwrap(), 2);
    let message = lights("z").unwrap_err().to_string();
    assert_eq!(message, "a.scene: has no scene \"z\"; give one by name or number: x, 1");
}

#[test]
fn unknown_names_are_ignored_with_a_warning() {
    let (scene, warnings) = cube("colour { r = 1 }");
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(
        warnings,
        [
            "1:34: a model knows no \"colour\", it was ignored; there are: name, active, static, path, \
          primitive, position, rotation, scale, scale_x, scale_y, scale_z, shader, material"
        ]
    );
    let (_, warnings) = body(
        "camera { } light { att = 1 color { a = 1 r = 1 g = 1 b = 1 } } model { primitive = cube material { gloss = 1 } }",
    );
    assert_eq!(warnings.len(), 4);
    assert!(warnings[0].starts_with("1:9: a scene knows no \"camera\""), "{warnings:?}");
    assert!(warnings[1].contains("there are: position, color, att_constant"), "{warnings:?}");
    assert!(warnings[2].contains("a colour knows no \"a\""), "{warnings:?}");
    assert!(warnings[3].contains("a material knows no \"gloss\""), "{warnings:?}");
}

#[test]
fn a_block_in_place_of_a_value_is_refused() {
    for (text, message) in [
        ("scene = a", "1:9: found \"a\", expected a block: `scene { model { } light { } }`"),
        (
            "scene { model = box }",
            "1:17: found \"box\", expected a block: `model { path = models/box.obj }`",
        ),
        (
            "scene { light { position = 5 } }",
            "1:28: found \"5\", expected a block: `position { x = 0.5 y = 0.5 z = 0.5 }`",
        ),
        (
            "scene { model { material = red } }",
            "1:28: found \"red\", expected a block: `material { color { r = 0.8 g = 0.8 b = 0.8 } }`",
        ),
        ("scene { name { } }", "1:14: found `{`, expected a value: `name = room`"),
        (
            "scene { model { path { } } }",
            "1:22: found `{`, expected a value: `path = models/box.obj`",
        ),
        ("scene { model { scale { } } }", "1:23: found `{`, expected a value: `scale = 0.5f`"),
    ] {
        assert_eq!(fault(text), format!("scenes/a.scene:{message}"));
    }
}

#[test]
fn an_empty_file_is_an_empty_scene() {
    for text in ["", " \n\t", "scene { }", "scene {\n name = nothing }", "\u{feff}"] {
        let mut scene = load(text).unwrap();
        assert_eq!((scene.instances.len(), scene.triangle_count()), (0, 0));
        assert!(scene.bounds().is_empty());
        assert_eq!(scene.voxel_bounds().size(), Vec3::splat(2.0));
        scene.validate().unwrap();
        // It is not a room, does not shine, and can be saved.
        assert!(!crate::Framing::of(&scene).is_place() && !scene.shines());
        let again =
            Scene::from_memory("a.glb", &scene.to_glb().unwrap(), &mut LoadOptions::default());
        assert_eq!(again.unwrap().grid_bounds, scene.grid_bounds);
    }
    assert_eq!(load("").unwrap().notes.warnings, ["the file is empty, and so is the scene"]);
}

#[test]
fn text_without_a_scene_block_is_refused() {
    assert_eq!(
        load_from("notes.txt", "\nDear diary, = it", &[]).unwrap_err().to_string(),
        "notes.txt:2:1: found \"Dear\" and no scene after it, expected `scene {`"
    );
    assert!(fault("model { primitive = cube }").contains("1:1: found \"model\" and no scene"));
}

#[test]
fn the_shader_name_selects_the_material() {
    let shown = |shader: &str| {
        let (scene, warnings) =
            cube(&format!("shader = {shader} material {{ color {{ r = 0.5 g = 0.25 b = 2 }} }}"));
        (scene.materials[0].emissive, phong(&scene).diffuse, warnings)
    };
    let color = Vec3::new(0.5, 0.25, 2.0);
    for shader in ["EMIT", "EMITRGBA"] {
        assert_eq!(shown(shader), (color, Vec3::ZERO, Vec::new()));
    }
    let (emissive, diffuse, warnings) = shown("COLOR");
    assert_eq!((emissive, diffuse), (Vec3::ZERO, Vec3::new(0.5, 0.25, 1.0)));
    assert!(
        warnings[0].contains("\"color\" times \"diffuse_str\" was limited to 1"),
        "{warnings:?}"
    );
    assert!(shown("VOX").2[0].starts_with("1:43: the shader VOX"));
    assert!(
        shown("SHINY").2[0]
            .contains("no shader \"SHINY\", COLOR is used instead; there are: COLOR, EMIT")
    );
    assert_eq!(shown("emit").0, Vec3::ZERO);
}

#[test]
fn vxct_strengths_are_converted_to_reflectances() {
    let (scene, warnings) = cube(
        "material { shininess = 8 specular_str = 0.25 diffuse_str = 0.5 ambient_str = 0.1 \
         color { r = 1 g = 0.5 b = 0 } }",
    );
    assert_eq!(warnings, [""; 0]);
    let surface = phong(&scene);
    assert_eq!(surface.diffuse, Vec3::new(0.5, 0.25, 0.0));
    // The peak of the normalised lobe under the irradiance pi L equals VXCT's highlight.
    let peak = surface.specular * (surface.shininess + 2.0) / (2.0 * PI) * PI;
    assert!(peak.abs_diff_eq(Vec3::splat(0.25), 1e-6), "{peak}");

    let (scene, warnings) = cube(
        "material { shininess = -1 specular_str = 3 diffuse_str = -0.5 ambient_str = -1 color { r = -1 g = 1 b = 1 } }",
    );
    let surface = phong(&scene);
    assert_eq!(surface.shininess.to_bits(), 0);
    assert_eq!((surface.diffuse, surface.specular), (Vec3::ZERO, Vec3::ONE));
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    // The look of VXCT gets the unchanged values.
    let strengths = scene.materials[0].strengths.unwrap();
    assert_eq!(strengths.color, Vec3::new(-1.0, 1.0, 1.0));
    let numbers = [strengths.ambient, strengths.diffuse, strengths.specular, strengths.shininess];
    assert_eq!(numbers, [-1.0, -0.5, 3.0, -1.0]);
}

#[test]
fn impossible_lights_are_repaired() {
    let (scene, warnings) = body(
        "light { att_constant = 0 att_linear = 0 att_quadratic = 0 } \
         light { att_constant = -1 att_linear = 0 att_quadratic = 2 color { r = -1 g = 1 b = 1 } } \
         light { att_constant = 1e-45 att_linear = 0 att_quadratic = 0 } \
         light { att_constant = 3e38 att_linear = 3e38 }",
    );
    let attenuations: Vec<_> =
        scene.lights.iter().map(|light| light.attenuation.unwrap()).collect();
    let default = Attenuation::default();
    let second = Attenuation { constant: 0.0, linear: 0.0, quadratic: 2.0 };
    assert_eq!(attenuations, [default, second, default, default]);
    assert_eq!(scene.lights[1].color, Vec3::new(0.0, 1.0, 1.0));
    assert_eq!(warnings.len(), 5, "{warnings:?}");
}

#[test]
fn zero_scale_drops_a_model_and_overflow_is_refused() {
    let (scene, warnings) = cube("scale_y = 0 scale_x = 0");
    assert_eq!(scene.instances.len(), 0);
    assert!(warnings[0].contains("scales two axes or more to zero"), "{warnings:?}");
    assert_eq!(cube("scale_y = 0").0.instances.len(), 1);
    let message = fault("scene {\n model { primitive = cube scale = 3e38 scale_x = 9 } }");
    assert!(
        message.contains("model \"model 1\" at 2:2, its transform has a number that is not finite")
    );
    assert!(load("scene { model { primitive = cube position { x = 3e38 y = 0 z = 0 } rotation { x = 1e38 y = 0 z = 0 } } }").is_ok());
}

#[test]
fn non_utf8_bytes_are_read_as_latin_1() {
    let text = b"scene { model { name = B\xfccher primitive = cube } }";
    let scene = Scene::from_memory("a.vxct", text, &mut LoadOptions::default()).unwrap();
    assert_eq!(scene.instances[0].name, "Bücher");
    let zeros = Scene::from_memory("a.vxct", &[0; 100], &mut LoadOptions::default());
    assert!(zeros.unwrap_err().to_string().contains("no scene after it"));
}

#[test]
fn large_and_hostile_texts_are_bounded() {
    let load = |text: &[u8]| Scene::from_memory("a.txt", text, &mut LoadOptions::default());
    let braces = vec![b'{'; 10 << 20];
    assert!(load(&braces).unwrap_err().to_string().len() < 300);
    assert!(load(&b"{ ".repeat(5 << 20)).unwrap_err().to_string().contains("1:1: found `{`"));
    assert!(load(&b"a { ".repeat(2 << 20)).unwrap_err().to_string().contains("a block within 32"));
    assert!(
        load(&vec![b' '; (16 << 20) + 1]).unwrap_err().to_string().contains("more than 16777216")
    );
    assert_eq!(load(&vec![b' '; 16 << 20]).unwrap().instances.len(), 0);
    let models = format!("scene {{ {} }}", "model { primitive = cube } ".repeat(100_001));
    assert!(load(models.as_bytes()).unwrap_err().to_string().contains("found model 100001"));
    // Notes are bounded, too.
    let many = format!("scene {{ {} }}", "model { } ".repeat(10_000));
    assert_eq!(load(many.as_bytes()).unwrap().notes.warnings.len(), 100);
}
