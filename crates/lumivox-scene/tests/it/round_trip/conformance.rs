//! The rules of glTF 2.0 for the features that the writer uses, checked without the loader.
//!
//! Section numbers are those of Khronos' "glTF 2.0 specification" (2021).

use std::collections::BTreeSet;

use serde_json::Value;

/// Panics if the bytes violate a rule of GLB files.
pub fn check(glb: &[u8]) {
    let (json, binary) = split(glb);
    let document = Document { json, binary };
    document.structure();
    document.accessors();
    document.meshes();
    document.textures();
    document.materials();
    document.nodes();
    document.extensions();
    document.nothing_is_unused();
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// Section 4.4: the container.
fn split(glb: &[u8]) -> (Value, &[u8]) {
    assert_eq!(&glb[..4], b"glTF");
    assert_eq!(word(glb, 4), 2);
    assert_eq!(word(glb, 8), glb.len());
    assert_eq!(glb.len() % 4, 0);
    let length = word(glb, 12);
    assert_eq!(length % 4, 0);
    assert_eq!(&glb[16..20], b"JSON");
    let json = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let rest = &glb[20 + length..];
    // A scene without meshes needs no bytes.
    if rest.is_empty() {
        return (json, rest);
    }
    assert_eq!(word(rest, 0), rest.len() - 8);
    assert_eq!(&rest[4..8], b"BIN\0");
    (json, &rest[8..])
}

struct Document<'a> {
    json: Value,
    binary: &'a [u8],
}

/// An index that must exist.
fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap_or_else(|| panic!("{value} is no index"))).unwrap()
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Checks that a number, if it is given, is in a range.
fn within(object: &Value, key: &str, min: f64, max: f64) {
    let values = match &object[key] {
        Value::Null => Vec::new(),
        Value::Array(_) => floats(&object[key]),
        number => vec![number.as_f64().unwrap()],
    };
    for value in values {
        assert!((min..=max).contains(&value), "{key}: {value}");
    }
}

impl Document<'_> {
    fn list(&self, name: &str) -> &[Value] {
        self.json[name].as_array().map_or(&[], Vec::as_slice)
    }

    fn structure(&self) {
        assert_eq!(self.json["asset"]["version"], "2.0");
        // Section 5: lists must not be empty.
        for (name, value) in self.json.as_object().unwrap() {
            assert!(value.as_array().is_none_or(|list| !list.is_empty()), "{name} is empty");
        }
        if self.binary.is_empty() {
            assert!(self.list("buffers").is_empty() && self.list("bufferViews").is_empty());
            return;
        }
        let [buffer] = self.list("buffers") else { panic!("one buffer") };
        assert!(buffer["uri"].is_null());
        // The chunk may be up to three bytes longer.
        let length = index(&buffer["byteLength"]);
        assert!(length <= self.binary.len() && self.binary.len() < length + 4);
        let mut end = 0;
        for view in self.list("bufferViews") {
            assert_eq!(view["buffer"], 0);
            let (offset, bytes) = (index(&view["byteOffset"]), index(&view["byteLength"]));
            assert!(bytes > 0 && offset % 4 == 0 && offset >= end && offset + bytes <= length);
            end = offset + bytes;
        }
    }

    fn bytes_of_view(&self, view: usize) -> &[u8] {
        let view = &self.list("bufferViews")[view];
        let offset = index(&view["byteOffset"]);
        &self.binary[offset..offset + index(&view["byteLength"])]
    }

    /// An accessor's numbers; its elements must be packed, and fill the view.
    fn numbers(&self, accessor: usize) -> Vec<f64> {
        let accessor = &self.list("accessors")[accessor];
        let bytes = self.bytes_of_view(index(&accessor["bufferView"]));
        match accessor["componentType"].as_u64().unwrap() {
            5123 => bytes
                .chunks_exact(2)
                .map(|b| f64::from(u16::from_le_bytes(b.try_into().unwrap())))
                .collect(),
            5125 => bytes
                .chunks_exact(4)
                .map(|b| f64::from(u32::from_le_bytes(b.try_into().unwrap())))
                .collect(),
            5126 => bytes
                .chunks_exact(4)
                .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
                .collect(),
            other => panic!("component type {other}"),
        }
    }

    /// Section 3.6.2: accessors.
    fn accessors(&self) {
        for (i, accessor) in self.list("accessors").iter().enumerate() {
            let width = match accessor["type"].as_str().unwrap() {
                "SCALAR" => 1,
                kind => kind.strip_prefix("VEC").unwrap().parse().unwrap(),
            };
            let numbers = self.numbers(i);
            let count = index(&accessor["count"]);
            assert!(count > 0);
            assert_eq!(numbers.len(), count * width);
            assert!(numbers.iter().all(|n| n.is_finite()));
            for (key, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
                if accessor[key].is_null() {
                    continue;
                }
                let mut bounds = numbers[..width].to_vec();
                for element in numbers.chunks_exact(width) {
                    bounds.iter_mut().zip(element).for_each(|(b, &n)| *b = pick(*b, n));
                }
                let given: Vec<f32> = floats(&accessor[key]).iter().map(|&n| n as f32).collect();
                assert_eq!(given, bounds.iter().map(|&n| n as f32).collect::<Vec<_>>());
            }
        }
    }

    /// Section 3.7.2: meshes.
    fn meshes(&self) {
        for mesh in self.list("meshes") {
            for primitive in mesh["primitives"].as_array().unwrap() {
                self.primitive(primitive);
            }
        }
    }

    fn primitive(&self, primitive: &Value) {
        let accessor = |value: &Value| &self.list("accessors")[index(value)];
        let target = |value: &Value| {
            &self.list("bufferViews")[index(&accessor(value)["bufferView"])]["target"]
        };
        let attributes = primitive["attributes"].as_object().unwrap();
        let position = accessor(&attributes["POSITION"]);
        let count = index(&position["count"]);
        assert!(position["min"].is_array() && position["max"].is_array());
        for (name, value) in attributes {
            assert_eq!(index(&accessor(value)["count"]), count);
            assert_eq!(target(value), 34962);
            assert_eq!(accessor(value)["componentType"], 5126);
            let kind = match name.as_str() {
                "POSITION" | "NORMAL" => "VEC3",
                "TANGENT" | "COLOR_0" => "VEC4",
                "TEXCOORD_0" | "TEXCOORD_1" => "VEC2",
                other => panic!("attribute {other}"),
            };
            assert_eq!(accessor(value)["type"], kind, "{name}");
            let numbers = self.numbers(index(value));
            match name.as_str() {
                "NORMAL" => numbers.chunks_exact(3).for_each(assert_unit),
                "TANGENT" => numbers.chunks_exact(4).for_each(|tangent| {
                    assert_unit(&tangent[..3]);
                    assert!(tangent[3].abs() == 1.0);
                }),
                "COLOR_0" => assert!(numbers.iter().all(|n| (0.0..=1.0).contains(n))),
                _ => {}
            }
        }
        assert!(attributes.contains_key("TEXCOORD_0") || !attributes.contains_key("TEXCOORD_1"));

        let indices = &primitive["indices"];
        assert_eq!(target(indices), 34963);
        assert_eq!(accessor(indices)["type"], "SCALAR");
        assert_eq!(index(&accessor(indices)["count"]) % 3, 0);
        let restart =
            if accessor(indices)["componentType"] == 5123 { 65535.0 } else { 4_294_967_295.0 };
        for number in self.numbers(index(indices)) {
            assert!(number < count as f64 && number < restart);
        }

        // Textures need coordinates, normal textures also tangents or normals.
        let material = &self.list("materials")[index(&primitive["material"])];
        each_object(material, &mut |object| {
            if object.contains_key("index") {
                let set = object.get("texCoord").map_or(0, index);
                assert!(attributes.contains_key(&format!("TEXCOORD_{set}")));
            }
        });
    }

    /// Section 3.8: textures.
    fn textures(&self) {
        for texture in self.list("textures") {
            assert!(index(&texture["source"]) < self.list("images").len());
            assert!(index(&texture["sampler"]) < self.list("samplers").len());
        }
        for image in self.list("images") {
            assert_eq!(image["mimeType"], "image/png");
            let view = index(&image["bufferView"]);
            assert!(self.bytes_of_view(view).starts_with(b"\x89PNG\r\n\x1a\n"));
            assert!(self.list("bufferViews")[view]["target"].is_null());
        }
        for sampler in self.list("samplers") {
            assert!([9728, 9729].contains(&index(&sampler["magFilter"])));
            assert!([9984, 9987].contains(&index(&sampler["minFilter"])));
            for wrap in ["wrapS", "wrapT"] {
                assert!([33071, 33648, 10497].contains(&index(&sampler[wrap])));
            }
        }
    }

    /// Section 3.9, and the schemas of the extensions.
    fn materials(&self) {
        for material in self.list("materials") {
            let pbr = &material["pbrMetallicRoughness"];
            for key in ["baseColorFactor", "metallicFactor", "roughnessFactor"] {
                within(pbr, key, 0.0, 1.0);
            }
            within(material, "emissiveFactor", 0.0, 1.0);
            if !material["alphaCutoff"].is_null() {
                assert_eq!(material["alphaMode"], "MASK");
                within(material, "alphaCutoff", 0.0, f64::MAX);
            }
            let extension = |name: &str| &material["extensions"][name];
            let strength = extension("KHR_materials_emissive_strength");
            within(strength, "emissiveStrength", 0.0, f64::MAX);
            within(extension("KHR_materials_specular"), "specularFactor", 0.0, 1.0);
            within(extension("KHR_materials_specular"), "specularColorFactor", 0.0, f64::MAX);
            let ior = extension("KHR_materials_ior");
            if ior["ior"] != 0.0 {
                within(ior, "ior", 1.0, f64::MAX);
            }
            for key in ["clearcoatFactor", "clearcoatRoughnessFactor"] {
                within(extension("KHR_materials_clearcoat"), key, 0.0, 1.0);
            }
            for key in ["sheenColorFactor", "sheenRoughnessFactor"] {
                within(extension("KHR_materials_sheen"), key, 0.0, 1.0);
            }
            within(extension("KHR_materials_transmission"), "transmissionFactor", 0.0, 1.0);
        }
    }

    /// Sections 3.5 and 3.10, and `KHR_lights_punctual`.
    fn nodes(&self) {
        let nodes = self.list("nodes");
        assert_eq!(self.json["scene"], 0);
        let roots: Vec<usize> =
            self.list("scenes")[0]["nodes"].as_array().unwrap().iter().map(index).collect();
        // Lists must not be empty.
        assert!(!roots.is_empty());
        assert_eq!(roots, (0..nodes.len()).collect::<Vec<_>>());
        for node in nodes {
            if !node["matrix"].is_null() {
                let matrix = floats(&node["matrix"]);
                assert_eq!([matrix[3], matrix[7], matrix[11], matrix[15]], [0.0, 0.0, 0.0, 1.0]);
            }
            let light = &node["extensions"]["KHR_lights_punctual"];
            let rotated = !node["camera"].is_null() || !light.is_null();
            if rotated && !node["matrix"].is_null() {
                // The matrix must be a rigid motion, since other programs decompose it.
                let m = floats(&node["matrix"]);
                let axes = [&m[0..3], &m[4..7], &m[8..11]];
                for axis in axes {
                    assert_unit(axis);
                }
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let dot: f64 = axes[a].iter().zip(axes[b]).map(|(a, b)| a * b).sum();
                    assert!(dot.abs() < 1e-5, "{m:?}");
                }
            }
        }
        for camera in self.list("cameras") {
            assert_eq!(camera["type"], "perspective");
            within(&camera["perspective"], "yfov", f64::MIN_POSITIVE, std::f64::consts::PI);
            within(&camera["perspective"], "znear", f64::MIN_POSITIVE, f64::MAX);
        }
        let lights = &self.json["extensions"]["KHR_lights_punctual"]["lights"];
        for light in lights.as_array().map_or(&[][..], Vec::as_slice) {
            within(light, "color", 0.0, 1.0);
            within(light, "intensity", 0.0, f64::MAX);
            within(light, "range", f64::MIN_POSITIVE, f64::MAX);
            let kind = light["type"].as_str().unwrap();
            assert!(["directional", "point", "spot"].contains(&kind));
            assert_eq!(light["spot"].is_null(), kind != "spot");
            if kind == "spot" {
                let angle = |key: &str| light["spot"][key].as_f64().unwrap();
                let (inner, outer) = (angle("innerConeAngle"), angle("outerConeAngle"));
                assert!(0.0 <= inner && inner < outer && outer <= std::f64::consts::FRAC_PI_2);
            }
        }
    }

    /// Section 3.12: the used extensions are listed, and no others.
    fn extensions(&self) {
        let mut used = BTreeSet::new();
        each_object(&self.json, &mut |object| {
            if let Some(Value::Object(extensions)) = object.get("extensions") {
                used.extend(extensions.keys().cloned());
            }
        });
        let declared: Vec<&str> =
            self.list("extensionsUsed").iter().map(|name| name.as_str().unwrap()).collect();
        assert_eq!(declared, used.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(self.json["extensionsRequired"].is_null(), "everyone may read this");
    }

    /// Checks that everything in the file is used.
    fn nothing_is_unused(&self) {
        let mut used: std::collections::BTreeMap<&str, BTreeSet<usize>> = [
            ("accessors", BTreeSet::new()),
            ("bufferViews", BTreeSet::new()),
            ("materials", BTreeSet::new()),
            ("meshes", BTreeSet::new()),
            ("textures", BTreeSet::new()),
            ("images", BTreeSet::new()),
            ("samplers", BTreeSet::new()),
            ("cameras", BTreeSet::new()),
        ]
        .into();
        each_object(&self.json, &mut |object| {
            for (key, list) in [
                ("bufferView", "bufferViews"),
                ("material", "materials"),
                ("mesh", "meshes"),
                ("index", "textures"),
                ("source", "images"),
                ("sampler", "samplers"),
                ("camera", "cameras"),
                ("indices", "accessors"),
            ] {
                if let Some(value) = object.get(key) {
                    used.get_mut(list).unwrap().insert(index(value));
                }
            }
            if let Some(Value::Object(attributes)) = object.get("attributes") {
                used.get_mut("accessors").unwrap().extend(attributes.values().map(index));
            }
        });
        for (list, used) in used {
            let all: BTreeSet<usize> = (0..self.list(list).len()).collect();
            assert_eq!(used, all, "{list}");
        }
    }
}

fn assert_unit(vector: &[f64]) {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((length - 1.0).abs() < 1e-5, "{vector:?}");
}

fn each_object(value: &Value, each: &mut impl FnMut(&serde_json::Map<String, Value>)) {
    match value {
        Value::Object(object) => {
            each(object);
            object.values().for_each(|value| each_object(value, each));
        }
        Value::Array(list) => list.iter().for_each(|value| each_object(value, each)),
        _ => {}
    }
}
