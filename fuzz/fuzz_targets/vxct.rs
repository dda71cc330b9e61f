#![no_main]

#[path = "../start.rs"]
mod start;
#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(init: start::one_thread(), |data: &[u8]| targets::run("vxct", data));
