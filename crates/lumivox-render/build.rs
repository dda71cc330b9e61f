//! Resolves the imports of this crate's WGSL.

fn main() {
    lumivox_wgsl::build_modules("render", &[]);
}
