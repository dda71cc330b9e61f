//! Validation of scenes.

mod outlier;

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3, Mat4, Vec3};

pub use outlier::Outlier;

use crate::{
    Bounds, Camera, Environment, Instance, Light, Material, Mesh, Scene, SceneError, Shading,
    Texture, model::to_unit,
};

impl Scene {
    /// Checks a hand-made scene, and removes things without extent: triangles of zero area (counted
    /// in [`Scene::notes`]), meshes that have none left, and instances whose transform collapses
    /// them to a line or a point (with a warning). A transform that flattens gets a thickness of a
    /// millionth, since normals need its inverse. Normals are normalised. Calling it again changes
    /// nothing.
    ///
    /// Areas are computed in local space, in f64, and only exact zeros count: thin triangles stay.
    /// After the transform, f32 may still round a tiny triangle to nothing.
    ///
    /// # Errors
    /// [`SceneError`] for numbers that are not finite or out of range, invalid indices, arrays
    /// whose lengths disagree, a scene without visible triangles, and one of size zero. A scene
    /// with [`Scene::grid_bounds`] may be empty or a point. The message names the scene and the
    /// part.
    pub fn validate(&mut self) -> Result<(), SceneError> {
        let name = PathBuf::from(&self.name);
        validate(self, &name)
    }
}

/// [`Scene::validate`], with `file` in the messages instead of the scene's name.
pub(crate) fn validate(scene: &mut Scene, file: &Path) -> Result<(), SceneError> {
    check(scene, file)?;
    scene.meshes.iter_mut().for_each(normalize_normals);
    drop_flattened_instances(scene);
    drop_degenerate_triangles(scene);
    if scene.triangle_count() == 0 && scene.grid_bounds.is_none() {
        let removed = scene.notes.degenerate_triangles;
        return Err(SceneError::NoTriangles {
            file: file.to_owned(),
            reason: format!(
                "{removed} degenerate ones, without an area or a finite place, were removed"
            ),
        });
    }
    // The remaining scene may be smaller.
    Check { file }.extent(scene)
}

/// The checks of [`Scene::validate`], without its changes.
pub(crate) fn check(scene: &Scene, file: &Path) -> Result<(), SceneError> {
    let check = Check { file };
    for mesh in &scene.meshes {
        check.mesh(mesh)?;
    }
    for texture in &scene.textures {
        check.texture(texture)?;
    }
    for material in &scene.materials {
        check.material(material, scene.textures.len())?;
    }
    for instance in &scene.instances {
        check.instance(instance, scene.meshes.len(), scene.materials.len())?;
    }
    for light in &scene.lights {
        check.light(light)?;
    }
    for camera in &scene.cameras {
        check.camera(camera)?;
    }
    check.environment(&scene.environment)?;
    check.extent(scene)
}

/// Normalises the normals that have a direction.
fn normalize_normals(mesh: &mut Mesh) {
    for normal in &mut mesh.normals {
        *normal = to_unit(*normal).unwrap_or(*normal);
    }
}

/// Removes instances that scales of zero hide, as some exporters do.
fn drop_flattened_instances(scene: &mut Scene) {
    let mut notes = std::mem::take(&mut scene.notes);
    retain_instances(scene, |instance| {
        let placed = invertible(instance.world_from_local, false);
        match placed {
            Some(world_from_local) => instance.world_from_local = world_from_local,
            None => notes.warnings.push(format!(
                "instance \"{}\" was skipped: its transform scales two axes or more to zero",
                instance.name
            )),
        }
        placed.is_some()
    });
    scene.notes = notes;
}

/// Drops instances, and removes them from the rig.
fn retain_instances(scene: &mut Scene, mut keep: impl FnMut(&mut Instance) -> bool) {
    let Scene { instances, rig, .. } = scene;
    let mut kept = 0;
    instances.retain_mut(|instance| {
        let stays = keep(instance);
        if stays {
            kept += 1;
        } else if let Some(rig) = rig {
            rig.forget_instance(kept);
        }
        stays
    });
}

/// Returns a transform whose f32 inverse exists, as normals need it: unchanged if possible. A
/// transform that flattens, up to rounding, gets a thickness of about a millionth, and mirrors if
/// `mirrors` is true. `None` if it collapses to a line or a point. Idempotent.
pub(crate) fn invertible(world_from_local: Mat4, mirrors: bool) -> Option<Mat4> {
    let mut made = world_from_local;
    // If the lengths of the columns differ greatly, rounding may remove some of the thickness.
    for _ in 0..8 {
        let Some(thicker) = thickened(made, mirrors) else { break };
        made = thicker;
    }
    let exists = made.as_dmat4().determinant() != 0.0 && made.inverse().is_finite();
    exists.then_some(made)
}

/// Gives a transform that flattens a thickness; `None` for other transforms.
fn thickened(world_from_local: Mat4, mirrors: bool) -> Option<Mat4> {
    // If one factor of a product of f32 matrices is flat, the determinant is about 2^-24.
    const ROUNDING: f64 = 1.0 / (1 << 22) as f64;
    let linear = DMat3::from_mat4(world_from_local.as_dmat4());
    let [a, b, c] = [linear.x_axis, linear.y_axis, linear.z_axis];
    // With the singular values s1 >= s2 >= s3, the determinant is s1 s2 s3. If s3 is zero, the
    // cofactors are s1 s2 times the product of the normals of the plane before and after.
    let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b));
    let length =
        |m: DMat3| DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length()).length();
    let (size, area) = (length(linear), length(cofactors));
    let is_flat =
        linear.determinant().abs() <= ROUNDING * size * area && area > ROUNDING * size * size;
    if !is_flat {
        return None;
    }
    let thickness = 4.0 * ROUNDING * size * if mirrors { -1.0 } else { 1.0 };
    let thick = linear + cofactors * (thickness / area);
    let columns = [thick.x_axis, thick.y_axis, thick.z_axis].map(|v| v.as_vec3().extend(0.0));
    Some(Mat4::from_cols(columns[0], columns[1], columns[2], world_from_local.w_axis))
}

/// Removes triangles of zero area, then meshes without triangles, then instances without a mesh. If
/// the scene has a rig, empty meshes stay: they may have triangles at another time.
fn drop_degenerate_triangles(scene: &mut Scene) {
    for mesh in &mut scene.meshes {
        scene.notes.degenerate_triangles += drop_degenerate(mesh);
    }
    if scene.rig.is_some() {
        let is_empty: Vec<bool> = scene.meshes.iter().map(|m| m.indices.is_empty()).collect();
        retain_instances(scene, |instance| !is_empty[instance.mesh]);
        return;
    }
    let mut kept = Vec::with_capacity(scene.meshes.len());
    let mut count = 0;
    for mesh in &scene.meshes {
        kept.push((!mesh.indices.is_empty()).then_some(count));
        count += usize::from(!mesh.indices.is_empty());
    }
    scene.meshes.retain(|mesh| !mesh.indices.is_empty());
    scene.instances.retain_mut(|instance| {
        let Some(mesh) = kept[instance.mesh] else { return false };
        instance.mesh = mesh;
        true
    });
}

fn drop_degenerate(mesh: &mut Mesh) -> usize {
    let before = mesh.indices.len();
    let mut write = 0;
    for read in (0..before).step_by(3) {
        let triangle = [mesh.indices[read], mesh.indices[read + 1], mesh.indices[read + 2]];
        if has_area(triangle.map(|i| mesh.positions[i as usize])) {
            mesh.indices[write..write + 3].copy_from_slice(&triangle);
            write += 3;
        }
    }
    mesh.indices.truncate(write);
    (before - write) / 3
}

/// Whether a triangle has an area; in f64, where that of a finite f32 triangle cannot underflow.
pub(crate) fn has_area(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).length_squared() > 0.0
}

/// The length of an optional list; an empty list counts as complete.
fn or_all(length: usize, all: usize) -> usize {
    if length == 0 { all } else { length }
}

struct Check<'a> {
    file: &'a Path,
}

impl Check<'_> {
    fn finite(&self, part: impl FnOnce() -> String, values: &[f32]) -> Result<(), SceneError> {
        if values.iter().all(|v| v.is_finite()) {
            return Ok(());
        }
        Err(SceneError::NotFinite { file: self.file.to_owned(), part: part() })
    }

    fn range(&self, part: &str, value: f32, fits: bool, expected: &str) -> Result<(), SceneError> {
        self.finite(|| part.to_owned(), &[value])?;
        if fits {
            return Ok(());
        }
        Err(self.out_of_range(part, value.to_string(), expected))
    }

    fn out_of_range(&self, part: &str, value: String, expected: &str) -> SceneError {
        SceneError::OutOfRange {
            file: self.file.to_owned(),
            part: part.to_owned(),
            value,
            expected: expected.to_owned(),
        }
    }

    fn not_negative(&self, part: &str, values: &[f32]) -> Result<(), SceneError> {
        values.iter().try_for_each(|&v| self.range(part, v, v >= 0.0, "at least 0"))
    }

    fn unit(&self, part: &str, values: &[f32]) -> Result<(), SceneError> {
        values
            .iter()
            .try_for_each(|&v| self.range(part, v, (0.0..=1.0).contains(&v), "from 0 to 1"))
    }

    fn index(
        &self,
        part: impl FnOnce() -> String,
        index: usize,
        count: usize,
        target: &'static str,
    ) -> Result<(), SceneError> {
        if index < count {
            return Ok(());
        }
        Err(SceneError::IndexOutOfRange {
            file: self.file.to_owned(),
            part: part(),
            index,
            count,
            target,
        })
    }

    fn mesh(&self, mesh: &Mesh) -> Result<(), SceneError> {
        let name = &mesh.name;
        let count = mesh.positions.len();
        for (what, length) in [
            ("normals", mesh.normals.len()),
            ("texture coordinates", mesh.uvs.len()),
            ("tangents", mesh.tangents.len()),
            ("second texture coordinates", or_all(mesh.uvs1.len(), count)),
            ("colours", or_all(mesh.colors.len(), count)),
        ] {
            if length != count {
                let part = format!("mesh \"{name}\", the number of {what}");
                let expected = format!("{count}, one a position");
                return Err(self.out_of_range(&part, length.to_string(), &expected));
            }
        }
        if !mesh.indices.len().is_multiple_of(3) {
            let part = format!("mesh \"{name}\", the number of indices");
            return Err(self.out_of_range(
                &part,
                mesh.indices.len().to_string(),
                "a multiple of three",
            ));
        }
        for i in 0..count {
            let part = |what: &str| format!("mesh \"{name}\", {what} {i}");
            self.finite(|| part("position"), &mesh.positions[i].to_array())?;
            self.finite(|| part("normal"), &mesh.normals[i].to_array())?;
            self.finite(|| part("texture coordinate"), &mesh.uvs[i].to_array())?;
            self.finite(|| part("tangent"), &mesh.tangents[i].to_array())?;
            if let Some(uv) = mesh.uvs1.get(i) {
                self.finite(|| part("second texture coordinate"), &uv.to_array())?;
            }
            // Most colours are valid, so the message is only made for invalid ones.
            if let Some(color) = mesh.colors.get(i)
                && color.to_array().iter().any(|c| !(0.0..=1.0).contains(c))
            {
                self.unit(&part("colour"), &color.to_array())?;
            }
            if mesh.normals[i] == Vec3::ZERO {
                return Err(self.out_of_range(&part("normal"), "zero".to_owned(), "a direction"));
            }
        }
        for (i, &index) in mesh.indices.iter().enumerate() {
            self.index(
                || format!("mesh \"{name}\", index {i}"),
                index as usize,
                count,
                "vertices",
            )?;
        }
        Ok(())
    }

    fn texture(&self, texture: &Texture) -> Result<(), SceneError> {
        let part = format!("texture \"{}\", its size", texture.name);
        let (width, height) = (texture.width, texture.height);
        if width == 0 || height == 0 {
            let value = format!("{width} x {height}");
            return Err(self.out_of_range(&part, value, "at least 1 x 1"));
        }
        let expected = u64::from(width) * u64::from(height) * 4;
        if texture.rgba8.len() as u64 != expected {
            let value = format!("{} bytes", texture.rgba8.len());
            let expected = format!("{expected} bytes for {width} x {height} texels");
            return Err(self.out_of_range(&part, value, &expected));
        }
        Ok(())
    }

    fn material(&self, material: &Material, textures: usize) -> Result<(), SceneError> {
        let part = |what: &str| format!("material \"{}\", its {what}", material.name);
        for reference in material.textures() {
            self.index(|| part("texture"), reference.texture, textures, "textures")?;
            self.finite(|| part("texture transform"), &reference.transform.to_cols_array())?;
            let expected = "0 or 1";
            let set = reference.uv_set as f32;
            self.range(&part("set of texture coordinates"), set, set <= 1.0, expected)?;
        }
        self.not_negative(&part("emission"), &material.emissive.to_array())?;
        self.finite(|| part("normal scale"), &[material.normal_scale])?;
        if let crate::AlphaMode::Mask { cutoff } = material.alpha {
            // A cutoff above 1 is legal and hides everything.
            self.not_negative(&part("alpha cutoff"), &[cutoff])?;
        }
        let coat = &material.clearcoat;
        self.unit(&part("clearcoat"), &[coat.strength, coat.roughness])?;
        self.unit(&part("sheen colour"), &material.sheen.color.to_array())?;
        self.unit(&part("sheen roughness"), &[material.sheen.roughness])?;
        self.unit(&part("transmission"), &[material.transmission.factor])?;
        if let Some(s) = &material.strengths {
            let numbers =
                [s.color.x, s.color.y, s.color.z, s.ambient, s.diffuse, s.specular, s.shininess];
            self.finite(|| part("strengths"), &numbers)?;
        }
        match &material.shading {
            Shading::MetallicRoughness(m) => {
                self.unit(&part("base colour"), &m.base_color.to_array())?;
                self.unit(&part("metallic"), &[m.metallic])?;
                self.unit(&part("roughness"), &[m.roughness])?;
                self.unit(&part("specular"), &[m.specular])?;
                self.not_negative(&part("specular colour"), &m.specular_color.to_array())?;
                let fits = m.ior >= 1.0 || m.ior == 0.0;
                self.range(&part("index of refraction"), m.ior, fits, "at least 1, or 0")
            }
            Shading::Phong(p) => {
                self.unit(&part("diffuse colour"), &p.diffuse.to_array())?;
                self.unit(&part("opacity"), &[p.opacity])?;
                self.unit(&part("specular colour"), &p.specular.to_array())?;
                self.range(&part("shininess"), p.shininess, p.shininess >= 0.0, "at least 0")
            }
            Shading::Unlit(u) => self.unit(&part("colour"), &u.color.to_array()),
        }
    }

    fn instance(
        &self,
        instance: &Instance,
        meshes: usize,
        materials: usize,
    ) -> Result<(), SceneError> {
        let part = |what: &str| format!("instance \"{}\", its {what}", instance.name);
        self.index(|| part("mesh"), instance.mesh, meshes, "meshes")?;
        self.index(|| part("material"), instance.material, materials, "materials")?;
        let m = instance.world_from_local;
        self.finite(|| part("transform"), &m.to_cols_array())?;
        if m.row(3) != glam::Vec4::W {
            let value = format!("a projection with the last row {}", m.row(3));
            return Err(self.out_of_range(&part("transform"), value, "affine"));
        }
        Ok(())
    }

    fn light(&self, light: &Light) -> Result<(), SceneError> {
        // Positions of all kinds of light must be finite.
        let position = || format!("light \"{}\", its position", light.name);
        self.finite(position, &light.position.to_array())?;
        for field in light.kind.fields() {
            let part = format!("light \"{}\", its {}", light.name, field.title.to_lowercase());
            let value = field.value(light).to_string();
            field.check(light).map_err(|allowed| self.out_of_range(&part, value, &allowed))?;
        }
        Ok(())
    }

    fn direction(&self, part: &str, direction: Vec3) -> Result<(), SceneError> {
        self.finite(|| part.to_owned(), &direction.to_array())?;
        if (direction.length() - 1.0).abs() <= 1e-3 {
            return Ok(());
        }
        Err(self.out_of_range(part, direction.to_string(), "of unit length"))
    }

    fn camera(&self, camera: &Camera) -> Result<(), SceneError> {
        let part = |what: &str| format!("camera \"{}\", its {what}", camera.name);
        self.finite(|| part("position"), &camera.position.to_array())?;
        self.direction(&part("forward"), camera.forward)?;
        self.direction(&part("up"), camera.up)?;
        let fov = camera.vertical_fov_rad;
        let fits = fov > 0.0 && fov < std::f32::consts::PI;
        self.range(&part("vertical field of view"), fov, fits, "above 0 and below pi radians")?;
        self.range(&part("near plane"), camera.near_m, camera.near_m > 0.0, "above 0")
    }

    fn environment(&self, environment: &Environment) -> Result<(), SceneError> {
        self.not_negative("the environment's radiance", &environment.radiance.to_array())?;
        self.finite(|| "the environment's rotation".to_owned(), &[environment.rotation_rad])?;
        let Some(map) = &environment.map else { return Ok(()) };
        let part = format!("the environment map \"{}\"", map.name);
        let texels = u64::from(map.width) * u64::from(map.height);
        if texels == 0 || map.rgb.len() as u64 != texels {
            let value = format!("{} texels for {} x {}", map.rgb.len(), map.width, map.height);
            return Err(self.out_of_range(&format!("{part}, its size"), value, "all, at least 1"));
        }
        map.rgb.iter().try_for_each(|texel| self.not_negative(&part, texel))
    }

    /// Checks that there are triangles, and that they span a finite box that is not a point; or
    /// that the scene has such a box.
    fn extent(&self, scene: &Scene) -> Result<(), SceneError> {
        let file = self.file.to_owned();
        let is_empty = scene.triangle_count() == 0;
        if let Some(bounds) = scene.grid_bounds {
            self.grid(bounds)?;
            if is_empty {
                return Ok(());
            }
        }
        if is_empty {
            let is_hidden = scene.instances.iter().any(|instance| instance.is_hidden);
            let reason = if is_hidden {
                "all instances are hidden".to_owned()
            } else {
                "it has no instance of a mesh with triangles".to_owned()
            };
            return Err(SceneError::NoTriangles { file, reason });
        }
        let bounds = scene.bounds();
        if !bounds.size().is_finite() {
            let part = "the scene's bounds, after the transforms,".to_owned();
            return Err(SceneError::NotFinite { file, part });
        }
        if bounds.size().max_element() <= 0.0 && scene.grid_bounds.is_none() {
            return Err(SceneError::ZeroSize { file, point: bounds.min.to_string() });
        }
        Ok(())
    }

    fn grid(&self, bounds: Bounds) -> Result<(), SceneError> {
        let part = "the box of the voxels";
        self.finite(|| part.to_owned(), &[bounds.min.to_array(), bounds.max.to_array()].concat())?;
        self.finite(|| part.to_owned(), &bounds.size().to_array())?;
        if bounds.is_empty() || bounds.size().max_element() <= 0.0 {
            let value = format!("{} to {}", bounds.min, bounds.max);
            return Err(self.out_of_range(part, value, "larger than a point"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
