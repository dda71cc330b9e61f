//! A test's check that a Rust struct and its WGSL counterpart lie in memory alike.

/// Asserts that `$rust` has the size of the WGSL struct `$name` of `$module`, and each listed field the offset
/// of the member of the same name; every WGSL member but padding must be listed.
macro_rules! assert_layout {
    ($library:expr, $module:literal, $name:literal, $rust:ty { $($field:ident),* $(,)? }) => {{
        let layout = $library.struct_layout($module, $name).expect("the struct is there");
        let rust: Vec<(String, u32)> =
            vec![$((stringify!($field).to_owned(), std::mem::offset_of!($rust, $field) as u32)),*];
        let wgsl: Vec<(String, u32)> = layout
            .members
            .iter()
            .filter(|(name, _)| !name.starts_with("padding"))
            .cloned()
            .collect();
        assert_eq!(rust, wgsl, "offsets of {} and {}", stringify!($rust), $name);
        assert_eq!(size_of::<$rust>() as u32, layout.size, "size of {}", stringify!($rust));
    }};
}
pub(crate) use assert_layout;
