#![no_main]

#[path = "../start.rs"]
mod start;
#[path = "../command.rs"]
mod command;

libfuzzer_sys::fuzz_target!(init: start::one_thread(), |data: &[u8]| command::run(data));
