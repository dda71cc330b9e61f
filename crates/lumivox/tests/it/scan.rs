//! The prefix sum against a plain loop.

use lumivox::gpu::{Recorder, read_buffer, upload};
use lumivox::internal::Scan;

#[test]
fn gpu_scan_matches_a_cpu_loop() {
    let (device, queue) = crate::common::device();
    let scan = Scan::new(&device, &lumivox::shaders::library()).expect("the shader links");
    for count in [1_u32, 2, 7, 2047, 2048, 2049, 5000, 4_200_000] {
        let values: Vec<u32> =
            (0..count).map(|i| i.wrapping_mul(2_654_435_761).rotate_left(7) % 97).collect();
        let buffer = upload(&device, "values", &values);
        let mut recorder = Recorder::new(&device, &queue);
        scan.run(&mut recorder, &buffer, count);
        recorder.submit();
        let result: Vec<u32> =
            pollster::block_on(read_buffer(&device, &queue, &buffer, 0..u64::from(count) * 4))
                .expect("the buffer is read");
        let mut sum = 0_u32;
        for (index, (value, scanned)) in values.iter().zip(&result).enumerate() {
            assert_eq!(*scanned, sum, "element {index} of {count}");
            sum = sum.wrapping_add(*value);
        }
    }
}
