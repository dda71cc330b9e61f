//! The kernels that compute the light of faces.

use super::TRACES_SHADOWS;
use super::faces::Faces;
use super::turns::Turn;
use crate::GiError;
use crate::gpu::{
    BindGroup, Kernel, KernelVariants, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture,
};
use crate::voxels::FACE_ARGUMENTS;

/// The kernels.
#[derive(Debug)]
pub(super) struct LightKernels {
    pub direct_layout: wgpu::BindGroupLayout,
    pub bounce_layout: wgpu::BindGroupLayout,
    pub box_layout: wgpu::BindGroupLayout,
    pub reflect_layout: wgpu::BindGroupLayout,
    pub move_light_layout: wgpu::BindGroupLayout,
    pub settle_layout: wgpu::BindGroupLayout,
    pub copy_layout: wgpu::BindGroupLayout,
    /// `true` if light is also stored in cells.
    pub has_cells: bool,
    /// `None` if cones march.
    find: Option<[Kernel; 2]>,
    pub far: Option<FarKernels>,
    box_moved: [Kernel; 2],
    bounce: [Kernel; 2],
    shine: [Kernel; 2],
    reflect: Kernel,
    move_light: Kernel,
    settle: Kernel,
    copy_replaced: Kernel,
}

/// The kernels of far light.
#[derive(Debug)]
pub(super) struct FarKernels {
    pub collect_layout: wgpu::BindGroupLayout,
    pub share_layout: wgpu::BindGroupLayout,
    collect: Kernel,
    rows: Kernel,
    columns: Kernel,
}

impl LightKernels {
    /// Queues the kernels of bounces for compilation, and with `in_frames` those that only frames
    /// use.
    pub(super) fn expect_bounces(&self, device: &Pipelines, has_emitters: bool, in_frames: bool) {
        if in_frames {
            self.box_moved.iter().for_each(|kernel| kernel.expect(device));
        }
        let far = self.far.iter().flat_map(|far| [&far.collect, &far.rows, &far.columns]);
        for kernel in self.find.iter().flatten().chain(far) {
            kernel.expect(device);
        }
        let shine = has_emitters.then_some(&self.shine);
        for [in_turn, fresh] in [&self.bounce].into_iter().chain(shine) {
            in_turn.expect(device);
            if in_frames {
                fresh.expect(device);
            }
        }
    }

    /// Links the kernels; `grid` is the layout of only the grid, the others are those of groups 0
    /// and 2. Marching cones do not need hits, so `find` is `None` then.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &wgpu::BindGroupLayout,
        [globals, lights]: [&wgpu::BindGroupLayout; 2],
        (marches, has_cells): (bool, bool),
    ) -> Result<Self, GiError> {
        let layout = |uniforms: u32, read: u32, written: u32, label: &str| {
            let layout = (0..uniforms).fold(LayoutBuilder::compute(), |layout, _| layout.uniform());
            let layout = (0..read).fold(layout, |layout, _| layout.storage());
            (0..written).fold(layout, |layout, _| layout.storage_mut()).build(device, label)
        };
        let bounce_layout = layout(3, 1, 2, "bounce");
        let box_layout = layout(2, 1, 1, "box of moved surface");
        let reflect_layout = layout(1, 3, 1, "reflect");
        let move_light_layout = layout(1, 6, 2, "move light");
        let settle_layout = layout(2, 2, 2, "settle");
        let copy_layout = layout(0, 6, 1, "copy replaced light");
        let kernel = |module, layout| Kernel::new(device, shaders, module, "main", &[grid, layout]);
        // One kernel for the faces whose turn it is, and one for those that have never gathered.
        let gather = |module| {
            let groups = [globals, &bounce_layout, lights];
            let kernel = |entry| Kernel::deferred(device, shaders, module, entry, &groups);
            Ok::<_, ShaderError>([kernel("main")?, kernel("fresh")?])
        };
        let find = || {
            let groups = [globals, &bounce_layout];
            let find = |entry| Kernel::deferred(device, shaders, "light::find", entry, &groups);
            Ok::<_, ShaderError>([find("main")?, find("beside")?])
        };
        let far = || {
            let collect_layout = (0..3)
                .fold(LayoutBuilder::compute(), |layout, _| layout.uniform())
                .storage()
                .storage_mut()
                .storage_mut()
                .storage()
                .storage_texels()
                .build(device, "far light");
            let share_layout = LayoutBuilder::compute()
                .uniform()
                .storage()
                .uniform()
                .texels()
                .storage_texels()
                .build(device, "share far light");
            let share = |entry| {
                let groups = [grid, &share_layout];
                Kernel::deferred(device, shaders, "light::share_far", entry, &groups)
            };
            let [rows, columns] = [share("rows")?, share("columns")?];
            let groups = [globals, &collect_layout, lights];
            let collect = Kernel::deferred(device, shaders, "light::far", "main", &groups)?;
            Ok::<_, ShaderError>(FarKernels {
                collect_layout,
                share_layout,
                collect,
                rows,
                columns,
            })
        };
        let box_moved = ["empty", "main"].map(|entry| {
            let groups = [grid, &box_layout];
            Kernel::deferred(device, shaders, "light::box_moved", entry, &groups)
        });
        let [empty, main] = box_moved;
        let [bounce, shine] = [gather("light::bounce")?, gather("light::shine")?];
        Ok(Self {
            has_cells,
            direct_layout: layout(1, 1, 1, "direct light"),
            find: (!marches).then(find).transpose()?,
            far: (!marches).then(far).transpose()?,
            box_moved: [empty?, main?],
            bounce,
            shine,
            reflect: kernel("light::reflect", &reflect_layout)?,
            move_light: kernel("light::move_light", &move_light_layout)?,
            settle: kernel("light::settle", &settle_layout)?,
            copy_replaced: kernel("light::copy_replaced", &copy_layout)?,
            bounce_layout,
            box_layout,
            reflect_layout,
            move_light_layout,
            settle_layout,
            copy_layout,
        })
    }

    /// The kernel of direct light; the layouts are those of groups 0 and 2.
    pub fn direct(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, lights]: [&wgpu::BindGroupLayout; 2],
    ) -> Result<KernelVariants, ShaderError> {
        let groups = [globals, &self.direct_layout, lights];
        let (feature, module) = (TRACES_SHADOWS, "light::direct");
        let kernels = KernelVariants::new(device, shaders, feature, module, "main", &groups)?;
        kernels.expect(device, false);
        Ok(kernels)
    }

    /// Finds the hits of the faces' rays and the adjacent faces, unless they are already known.
    pub fn find(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, faces: &Faces) {
        for find in self.find.iter().flatten() {
            faces.run(recorder, "light::find", find, &[globals, &faces.bounce]);
        }
    }

    /// Finds the box around the voxels that dynamic surface touches.
    pub fn box_moved(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        let [empty, main] = &self.box_moved;
        let groups = [grid, &faces.box_moved];
        recorder.compute("light::box_moved", |pass| {
            empty.dispatch_linear(pass, &groups, 1);
            main.dispatch_linear(pass, &groups, faces.moving_capacity);
        });
    }

    /// Computes the far light of all faces, shared among neighbours. `None` if cones march.
    pub fn far<'f>(
        &self,
        recorder: &mut Recorder<'_>,
        grid: &BindGroup,
        [globals, lights]: [&BindGroup; 2],
        faces: &'f Faces,
    ) -> Option<&'f Texture> {
        let (kernels, far) = (self.far.as_ref()?, faces.far.as_ref()?);
        recorder.compute("light::far", |pass| {
            let mut run = |kernel: &Kernel, groups: &[&BindGroup]| {
                kernel.dispatch_indirect(pass, groups, &faces.counts, FACE_ARGUMENTS);
            };
            run(&kernels.collect, &[globals, &far.collect, lights]);
            run(&kernels.rows, &[grid, &far.rows]);
            run(&kernels.columns, &[grid, &far.columns]);
        });
        Some(&far.light)
    }

    /// Gathers for the faces whose turn it is, and for those that have never gathered.
    pub fn gather(
        &self,
        recorder: &mut Recorder<'_>,
        [globals, lights]: [&BindGroup; 2],
        faces: &Faces,
        turn: Turn,
    ) {
        run_turn(recorder, "light::bounce", &self.bounce, [globals, lights], faces, turn);
    }

    /// Computes the irradiance straight from emitters, for the faces whose turn it is and for those
    /// that have never gathered.
    pub fn shine(
        &self,
        recorder: &mut Recorder<'_>,
        groups: [&BindGroup; 2],
        faces: &Faces,
        turn: Turn,
    ) {
        run_turn(recorder, "light::shine", &self.shine, groups, faces, turn);
    }

    /// Computes the radiance that faces send out.
    pub fn reflect(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        faces.run(recorder, "light::reflect", &self.reflect, &[grid, &faces.reflect]);
    }

    /// Before a list is committed: moves the light of faces whose place in the list changes.
    pub fn move_light(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        recorder.compute("light::move_light", |pass| {
            let voxels = faces.moving_voxels;
            self.move_light.dispatch_linear(pass, &[grid, &faces.move_light], voxels);
            self.settle.dispatch_linear(pass, &[grid, &faces.settle], faces.moving_capacity);
        });
    }

    /// After a list was committed: copies light from the faces of the list that it replaced.
    pub fn copy_replaced(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &mut Faces) {
        if let Some(group) = faces.replaced.take() {
            self.copy_replaced.run_linear(recorder, &[grid, &group], faces.capacity);
        }
    }
}

/// Runs kernels for the faces whose turn it is, and for those that have never gathered.
fn run_turn(
    recorder: &mut Recorder<'_>,
    label: &str,
    [in_turn, fresh]: &[Kernel; 2],
    [globals, lights]: [&BindGroup; 2],
    faces: &Faces,
    turn: Turn,
) {
    let groups = [globals, &faces.bounce, lights];
    let count = faces.capacity.min(turn.faces.into());
    let fresh_count = if turn.is_list_new { faces.capacity } else { faces.moving_capacity };
    recorder.compute(label, |pass| {
        in_turn.dispatch_linear(pass, &groups, count);
        if count < faces.capacity || turn.is_by_cascade {
            fresh.dispatch_linear(pass, &groups, fresh_count);
        }
    });
}
