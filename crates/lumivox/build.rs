//! Resolves the imports of this crate's WGSL.

use lumivox_wgsl::{Slot, build_modules};

fn main() {
    // The slots whose implementations are chosen at run time (`src/volume/mod.rs`).
    let slots = [
        // `src/cones/mod.rs`.
        Slot { path: "cones::trace_method", implementations: &["cones::exact", "cones::march"] },
        Slot {
            path: "light::gather_method",
            implementations: &["light::gather_rays", "light::gather_cones"],
        },
        Slot {
            path: "trace::gather_method",
            implementations: &["trace::near_and_far", "trace::by_cones"],
        },
        Slot {
            path: "trace::hit_method",
            implementations: &["trace::lit_hit", "trace::marched_hit"],
        },
        Slot { path: "volume", implementations: &["volume::six_lobes", "volume::isotropic"] },
        Slot {
            path: "volume::cells",
            implementations: &["volume::dense::cells", "volume::octree::cells"],
        },
    ];
    build_modules("", &slots);
}
