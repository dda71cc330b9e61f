//! Lights that change without being bound again, and shadow maps in the caller's own layout.

use glam::{Mat4, UVec2, Vec3};

use super::{Light, LightSource, Lights, Shadow, ShadowLayer, ShadowMaps, ShadowSource};
use crate::gpu::{Pipelines, Recorder, Timing, upload};
use crate::hooks::{Mounted, Resource};
use crate::testing::{busy_room, device, read};
use crate::trace::CameraView;
use crate::trace::tests::room;
use crate::{Gi, GiConfig, Grid, TraceSettings};

struct Lab {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
}

impl Lab {
    fn new(shadow_maps: Option<Mounted>) -> Self {
        let (device, queue) = device();
        let grid = Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 24, Vec3::ZERO).expect("fits");
        let config = GiConfig { shadow_maps, ..GiConfig::new(grid) };
        let mut gi = Gi::with_pipelines(&device, &queue, config).expect("a device");
        let geometry = busy_room().build(&device);
        pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        Self { device, queue, gi }
    }

    /// The bits of the radiance of all faces after one gather.
    fn faces(&mut self, lights: &Lights) -> Vec<u32> {
        let mut recorder = Recorder::new(&self.device, &self.queue);
        let settings = TraceSettings::default();
        self.gi.light(&mut recorder, lights, 2, &settings).expect("valid settings");
        recorder.submit();
        let faces = self.gi.voxels().expect("there are voxels").face_count as usize;
        let radiance = self.gi.face_radiance().expect("there is light");
        read(&self.device, &self.queue, radiance, 4 * faces)
    }
}

fn point(x: f32, shadow: Shadow) -> Light {
    let source = LightSource::Point {
        position: Vec3::new(x, 0.45, 0.5),
        intensity: Vec3::new(1.0, 0.8, 0.6),
        radius_m: 0.02,
        range_m: None,
    };
    Light { source, shadow }
}

#[test]
fn updated_lights_equal_freshly_bound_ones() {
    let mut lab = Lab::new(None);
    let sets: [(Vec<Light>, Vec3); 5] = [
        (vec![point(0.2, Shadow::Cone)], Vec3::ZERO),
        (vec![point(0.6, Shadow::None)], Vec3::splat(0.3)),
        ((1..6).map(|i| point(0.15 * i as f32, Shadow::Cone)).collect(), Vec3::ZERO),
        ((1..8).map(|i| point(0.1 * i as f32, Shadow::None)).collect(), Vec3::X),
        (Vec::new(), Vec3::ONE),
    ];
    let mut updated = lab.gi.bind_lights(&sets[0].0, sets[0].1, None);
    for (number, (lights, environment)) in sets.iter().enumerate() {
        // The first set is bound already.
        let before = wgpu::BindGroup::clone(&updated.group);
        let version = updated.version;
        updated.update(&lab.queue, lights, *environment, None);
        assert_eq!(version == updated.version, number == 0, "set {number}");
        // A buffer for five has capacity for eight.
        assert_eq!(before == *updated.group, number != 2, "set {number}");
        let fresh = lab.gi.bind_lights(lights, *environment, None);
        assert!(lab.faces(&updated) == lab.faces(&fresh), "set {number}");
        assert_eq!(updated.count, lights.len() as u32);
    }
}

/// Parallel light from above, with a map whose left half is in shadow, in Lumivox's layout and in
/// another.
#[test]
fn shadow_maps_of_another_layout_give_the_same_bits() {
    let size = UVec2::splat(16);
    // x spans the room's width; higher places are nearer.
    let clip_from_world = Mat4::from_cols_array_2d(&[
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.5, 0.0],
        [0.0, 2.0, 0.0, 0.0],
        [-1.0, -1.0, 0.25, 1.0],
    ]);
    let view = CameraView::new(clip_from_world, Vec3::ZERO);
    let source = LightSource::Directional {
        direction: Vec3::NEG_Y,
        irradiance: Vec3::ONE,
        angular_radius_rad: 0.0,
    };
    let light = |shadow| [Light { source, shadow }];
    let mapped = light(Shadow::Map { first_layer: 0 });

    let mut lab = Lab::new(None);
    let (depth, _) = room::draw((&lab.device, &lab.queue), (view, size), "shadow", &[]);
    let array = wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    };
    let layer =
        ShadowLayer { clip_from_world, is_perspective: false, texel_size: 0.0, has_finer: false };
    let depth = depth.texture().create_view(&array).into();
    let maps = ShadowMaps { depth, layers: vec![layer] };
    let lights = lab.gi.bind_lights(&mapped, Vec3::ZERO, Some(&maps));
    let expected = lab.faces(&lights);
    let open = lab.gi.bind_lights(&light(Shadow::None), Vec3::ZERO, None);
    assert!(expected != lab.faces(&open), "the map shades nothing");

    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
    let buffer = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let module = Mounted::new(include_str!("forward.wgsl"), [buffer, texture, sampler]);
    let mut lab = Lab::new(Some(module));
    let (depth, _) = room::draw((&lab.device, &lab.queue), (view, size), "forward_shadow", &[]);
    let matrix = upload(&lab.device, "matrix", &[clip_from_world]);
    let sampler = lab.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::LessEqual),
        ..Default::default()
    });
    let own: [Resource; 3] = [wgpu::Buffer::clone(&matrix).into(), depth.into(), sampler.into()];
    let mut lights = lab.gi.bind_lights(&mapped, Vec3::ZERO, ShadowSource::Own(&own));
    assert!(lab.faces(&lights) == expected, "the other layout");
    // Moving the light does not rebind them.
    let before = wgpu::BindGroup::clone(&lights.group);
    lights.update(&lab.queue, &mapped, Vec3::ZERO, ShadowSource::Own(&own));
    assert!(before == *lights.group);
    assert!(lab.faces(&lights) == expected, "after an update");
}

/// The caller's own maps cover one half of the room; the other half has cone shadows.
#[test]
fn cone_shadows_fill_in_beyond_shadow_maps() {
    let module = "
        import package::light::lights::Light;

        @group(2) @binding(8) var<storage, read> border: f32;

        fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
            return select(-1.0, 1.0, position_in_world.x < border);
        }";
    let buffer = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let mut lab = Lab::new(Some(Mounted::new(module, [buffer])));
    let mut lit = |shadow, border: f32| {
        let border = upload(&lab.device, "border", &[border]);
        let own = [Resource::from(wgpu::Buffer::clone(&border))];
        let lights = [point(0.2, shadow)];
        let lights = lab.gi.bind_lights(&lights, Vec3::ZERO, ShadowSource::Own(&own));
        lab.faces(&lights)
    };
    let mapped = Shadow::Map { first_layer: 0 };
    // First a map that covers nothing, on new voxels: without the volume's opacities a cone would
    // see nothing. Then a map that covers everything.
    let nowhere = lit(mapped, -1.0);
    assert!(nowhere == lit(Shadow::Cone, 0.0));
    let everywhere = lit(mapped, 2.0);
    assert!(everywhere == lit(Shadow::None, 0.0));
    assert!(nowhere != everywhere, "cones shade nothing");
    let half = lit(mapped, 0.5);
    assert!(half != nowhere && half != everywhere);
}
