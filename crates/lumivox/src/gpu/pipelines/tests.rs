use super::*;
use crate::gpu::{BindGroupBuilder, Kernel, LayoutBuilder, Recorder, storage_buffer};
use crate::testing::{device, read};

const DOUBLE: &str = "
@group(0) @binding(0) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u) {
    values[thread.x] = 2 * values[thread.x] + 1;
}
";

fn library(factor: u32) -> ShaderLibrary {
    let mut library = crate::shaders::library();
    library.add("test::double", DOUBLE).constant_u32("TEST_FACTOR", factor);
    library
}

fn layout(pipelines: &Pipelines, label: &str) -> wgpu::BindGroupLayout {
    LayoutBuilder::compute().storage_mut().build(pipelines, label)
}

fn kernel(pipelines: &Pipelines, library: &ShaderLibrary) -> Result<Kernel, ShaderError> {
    let layout = layout(pipelines, "values");
    Kernel::new(pipelines, library, "test::double", "main", &[&layout])
}

#[test]
fn equal_shaders_and_layouts_are_created_once() {
    let pipelines = Pipelines::new(&device().0);
    for library in [library(1), library(1)] {
        kernel(&pipelines, &library).expect("it links");
        assert_eq!(layout(&pipelines, "another name"), layout(&pipelines, "values"));
    }
    let one = PipelineCounts { shaders: 1, layouts: 1, pipelines: 1, made: 0 };
    assert_eq!(pipelines.counts(), one);
    // The shader is linked again and found in the cache, since it does not use the constant.
    kernel(&pipelines, &library(2)).expect("it links");
    assert_eq!(pipelines.counts(), one);
    let mut other = library(1);
    other.add("test::double", DOUBLE.replace("+ 1", "+ 3"));
    kernel(&pipelines, &other).expect("it links");
    assert_eq!(pipelines.counts(), PipelineCounts { shaders: 2, pipelines: 2, ..one });
    LayoutBuilder::compute().storage().build(&pipelines, "values");
    assert_eq!(pipelines.counts().layouts, 2);
}

#[test]
fn uncompiled_pipelines_are_compiled_at_first_use() {
    let (device, queue) = device();
    let pipelines = Pipelines::new(&device);
    let kernel = kernel(&pipelines, &library(1)).expect("it links");
    let values = storage_buffer(&device, "values", 256);
    // A layout from another request is compatible.
    let layout = layout(&pipelines, "others");
    let group = BindGroupBuilder::new(&layout).buffer(&values).build(&device, "values");
    for _ in 0..3 {
        let mut recorder = Recorder::new(&device, &queue);
        kernel.run_linear(&mut recorder, &[&group], 64);
        recorder.submit();
    }
    assert_eq!(read::<u32>(&device, &queue, &values, 64), vec![7; 64]);
    assert_eq!(pipelines.counts().made, 1);
    let mut heard = Vec::new();
    pollster::block_on(pipelines.compile(&mut |done, total| heard.push((done, total))));
    assert!(heard.is_empty(), "nothing was left to make: {heard:?}");
}

#[test]
fn pending_pipelines_are_compiled_and_counted() {
    let (device, queue) = device();
    let pipelines = Pipelines::new(&device);
    let grid = crate::Grid::fit(glam::Vec3::ZERO, glam::Vec3::ONE, 16, glam::Vec3::ZERO);
    let config = crate::GiConfig::new(grid.expect("a grid"));
    let gi = crate::Gi::with_pipelines(&pipelines, &queue, config.clone()).expect("a device");
    let counts = pipelines.counts();
    assert_eq!(counts.made, 0, "{counts:?}");
    let mut heard = Vec::new();
    pollster::block_on(pipelines.compile(&mut |done, total| heard.push((done, total))));
    let total = heard[0].1;
    assert_eq!(heard, (0..=total).map(|done| (done, total)).collect::<Vec<_>>());
    let made = total as usize;
    assert!(made < counts.pipelines, "nothing is deferred");
    assert_eq!(pipelines.counts(), PipelineCounts { made, ..counts });
    pollster::block_on(pipelines.compile_all(&mut |_, _| {}));
    assert_eq!(pipelines.counts(), PipelineCounts { made: counts.pipelines, ..counts });

    // A second `Gi` of this kind needs no new pipelines.
    drop(gi);
    crate::Gi::with_pipelines(&pipelines, &queue, config).expect("a device");
    assert_eq!(pipelines.counts(), PipelineCounts { made: counts.pipelines, ..counts });
}

#[test]
fn shader_errors_are_returned_when_creating_a_kernel() {
    let pipelines = Pipelines::new(&device().0);
    let mut broken = library(1);
    broken.add("test::double", DOUBLE.replace("2 *", "2.5 *"));
    let error = kernel(&pipelines, &broken).expect_err("a u32 is no float");
    assert_eq!(error.module, "test::double");
    assert!(error.message.starts_with("line 6: "), "{error}");
    let layout = layout(&pipelines, "values");
    let error = Kernel::new(&pipelines, &library(1), "test::double", "none", &[&layout])
        .expect_err("there is no such entry point");
    assert!(error.to_string().contains("`none`"), "{error}");
    assert_eq!(pipelines.counts().pipelines, 0);
}
