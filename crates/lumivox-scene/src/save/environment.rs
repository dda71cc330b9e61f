//! The surroundings, of which glTF knows nothing: all of them go to the scene's extras.

use serde_json::{Map, Value, json};

use super::Writer;
use super::binary::{Source, Target};
use super::document::{number, numbers, own_extras};
use crate::Environment;

impl Writer<'_> {
    pub(super) fn environment(&mut self) {
        let scene = self.scene;
        let environment = &scene.environment;
        if *environment == Environment::default() {
            return;
        }
        let mut json = Map::new();
        json.insert("radiance".to_owned(), numbers(environment.radiance.as_ref()));
        json.insert("rotationRad".to_owned(), number(environment.rotation_rad));
        if let Some(map) = &environment.map {
            // Three floats a texel, row by row from the top.
            let view = self.document.binary.view(Source::Texels(&map.rgb), Target::None);
            let map = json!({
                "bufferView": view, "height": map.height, "name": map.name, "width": map.width,
            });
            json.insert("map".to_owned(), map);
        }
        let mut own = Map::new();
        own.insert("environment".to_owned(), Value::Object(json));
        own_extras(&mut self.document.scene, &own);
    }
}
