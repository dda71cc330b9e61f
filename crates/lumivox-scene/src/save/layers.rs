//! The layers of a material, each an extension.

use glam::Vec3;
use serde_json::{Map, Value};

use super::Writer;
use super::material::Object;
use crate::{Clearcoat, Material, Sheen, Transmission};

impl Writer<'_> {
    pub(super) fn layers(&mut self, material: &Material, extensions: &mut Map<String, Value>) {
        if material.clearcoat != Clearcoat::default() {
            let Clearcoat { strength, roughness, texture } = material.clearcoat;
            let mut coat = Object::default();
            coat.factor("clearcoatFactor", strength, 0.0);
            coat.factor("clearcoatRoughnessFactor", roughness, 0.0);
            // One image for both: red is the strength, green the roughness.
            self.map(&mut coat, "clearcoatTexture", texture);
            self.map(&mut coat, "clearcoatRoughnessTexture", texture);
            self.extension(extensions, "KHR_materials_clearcoat", coat);
        }
        if material.sheen != Sheen::default() {
            let Sheen { color, roughness, texture } = material.sheen;
            let mut sheen = Object::default();
            sheen.color("sheenColorFactor", color, Vec3::ZERO);
            sheen.factor("sheenRoughnessFactor", roughness, 0.0);
            // One image for both: RGB is the colour, alpha the roughness.
            self.map(&mut sheen, "sheenColorTexture", texture);
            self.map(&mut sheen, "sheenRoughnessTexture", texture);
            self.extension(extensions, "KHR_materials_sheen", sheen);
        }
        if material.transmission != Transmission::default() {
            let Transmission { factor, texture } = material.transmission;
            let mut transmission = Object::default();
            transmission.factor("transmissionFactor", factor, 0.0);
            self.map(&mut transmission, "transmissionTexture", texture);
            self.extension(extensions, "KHR_materials_transmission", transmission);
        }
    }
}
