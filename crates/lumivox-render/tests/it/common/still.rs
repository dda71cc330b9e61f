//! A cone model for tests, on the library's hook.

use lumivox::hooks::ConeModel;

/// Cones with the same directions in each frame, the centres of their cells, that return a share of
/// the light.
#[derive(Clone, Copy, Debug)]
pub struct StillCones {
    /// The share of the light; 1 is physical.
    pub share: f32,
}

impl ConeModel for StillCones {
    fn name(&self) -> &'static str {
        "still"
    }

    fn module(&self) -> &'static str {
        "import package::cones::hemisphere::inner_ring;
        import package::cones::start::clear_of_walls;

        fn place_in_cell(drawn: vec2f, cell: u32, cell_count: u32, values: vec4f) -> vec2f {
            return vec2f(select(0.5, 0.0, cell == 0u && inner_ring(cell_count) == 1u), 0.5);
        }

        fn glossy_half_vector(drawn: vec3f, values: vec4f) -> vec3f {
            return vec3f(0.0, 0.0, 1.0);
        }

        fn start_of_cones(above: vec3f, normal: vec3f, level: u32, values: vec4f) -> vec3f {
            return clear_of_walls(above, normal, level);
        }

        fn shown_share(taken: f32, transmittance: f32, level: u32, width: f32, values: vec4f) -> f32 {
            return taken * values.x;
        }"
    }

    fn values(&self) -> [f32; 4] {
        [self.share, 0.0, 0.0, 0.0]
    }
}
