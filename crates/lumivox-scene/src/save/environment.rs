//! Writes the surroundings and the box of the voxels, which glTF cannot express, to the scene's
//! extras.

use serde_json::{Map, Value, json};

use super::Writer;
use super::binary::{Source, Target};
use super::document::{number, numbers, own_extras};
use crate::{Bounds, Environment};

impl<'a> Writer<'a> {
    pub(super) fn scene_extras(&mut self) {
        let scene = self.scene;
        let mut own = Map::new();
        if scene.environment != Environment::default() {
            let environment = self.environment(&scene.environment);
            own.insert("environment".to_owned(), environment);
        }
        if let Some(Bounds { min, max }) = scene.grid_bounds {
            let [min, max] = [min, max].map(|corner| (corner.as_dvec3() + scene.origin).to_array());
            let grid = json!({ "min": min, "max": max });
            own.insert("grid".to_owned(), grid);
        }
        own_extras(&mut self.document.scene, &own);
    }

    fn environment(&mut self, environment: &'a Environment) -> Value {
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
        Value::Object(json)
    }
}
