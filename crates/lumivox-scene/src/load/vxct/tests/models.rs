//! The search for the files of models.

use super::*;

#[test]
fn only_the_first_mesh_of_an_obj_is_used() {
    let (scene, warnings) =
        body("model { name = tri path = models/tri.obj } model { path = models/tri.obj }");
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.triangle_count()), (1, 2, 2));
    assert_eq!(scene.meshes[0].name, "tri");
    assert_eq!(scene.meshes[0].colors, []);
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.materials[1].name, "model 2");
    assert_eq!(
        warnings,
        ["models/tri.obj: the first mesh counts, \"first\", and 1 more was ignored"]
    );
}

#[test]
fn models_are_searched_in_vxct_and_common_folders() {
    let found = |name: &str, path: &str, file: &str| {
        let text = format!("scene {{ model {{ path = {path} }} }}");
        load_from(name, &text, &[file]).unwrap().instances.len() == 1
    };
    // In the folder above `scenes`, as VXCT does.
    assert!(found("scenes/a.scene", "models/tri.obj", "models/tri.obj"));
    assert!(found("a/b/Scenes/a.scene", "models/tri.obj", "a/b/models/tri.obj"));
    assert!(found("scenes/a.scene", "meshes/tri.obj", "meshes/tri.obj"));
    // Beside the scene.
    assert!(found("scenes/a.scene", "tri.obj", "scenes/tri.obj"));
    assert!(found("a.scene", "models/tri.obj", "models/tri.obj"));
    assert!(found("stuff/a.scene", "models/tri.obj", "stuff/models/tri.obj"));
    // In the folder `models` beside `scenes`.
    assert!(found("scenes/a.scene", "tri.obj", "models/tri.obj"));
    // Spelled as on other systems.
    assert!(found("scenes/a.scene", "Models\\TRI.obj", "models/tri.obj"));
    assert!(found("scenes/a.scene", "C:\\vxct\\models\\tri.obj", "models/tri.obj"));
    assert!(found("scenes/a.scene", "../models/tri.obj", "models/tri.obj"));
    // Not in the folder above one with another name.
    assert!(!found("stuff/a.scene", "models/tri.obj", "models/tri.obj"));
    assert!(!found("scenes/a.scene", "../../tri.obj", "../tri.obj"));
}

#[test]
fn vxcts_own_model_folder_takes_precedence() {
    let files = HashMap::from([
        ("models/tri.obj".to_owned(), OBJ.to_vec()),
        ("scenes/models/tri.obj".to_owned(), b"v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n".to_vec()),
    ]);
    let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
    let text = b"scene { model { path = models/tri.obj } }";
    let scene = Scene::from_memory("scenes/a.scene", text, &mut options).unwrap();
    assert_eq!(scene.bounds().max.x, 1.0);
}

#[test]
fn models_without_a_mesh_are_skipped_with_a_warning() {
    let (scene, warnings) = body(
        "model { name = a path = gone.obj primitive = cube } model { name = b primitive = sphere } \
         model { name = c } model { primitive = cube } model { path = models/tri.png }",
    );
    assert_eq!(scene.instances.len(), 1);
    // Models are numbered including those that are not shown.
    assert_eq!(scene.instances[0].name, "model 4");
    let place = "put it beside the scene, or into the folder `models` beside the folder `scenes`";
    let expected = [
        format!("1:33: model \"a\" is not shown: \"gone.obj\" does not exist; {place}"),
        "1:90: model \"b\" is not shown: there is no primitive \"sphere\", only \"cube\""
            .to_owned(),
        "1:99: model \"c\" is not shown: it has neither \"path\" nor \"primitive\"".to_owned(),
        format!(
            "1:160: model \"model 5\" is not shown: \"models/tri.png\" does not exist; {place}"
        ),
    ];
    assert_eq!(warnings, expected);
    let files = HashMap::from([
        ("a.obj".to_owned(), b"v 0 0 0\nf 1 2 3\n".to_vec()),
        ("b.obj".to_owned(), b"v 0 0 0\n".to_vec()),
        ("c.png".to_owned(), Vec::new()),
    ]);
    let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
    let text = b"scene { model { path = a.obj } model { path = b.obj } model { path = c.png } }";
    let scene = Scene::from_memory("a.scene", text, &mut options).unwrap();
    let warnings = scene.notes.warnings.join("\n");
    for needle in
        ["a.obj: a corner of line 2", "b.obj has no faces", "\"c.png\" is not an OBJ file"]
    {
        assert!(warnings.contains(needle), "{warnings}");
    }
}
