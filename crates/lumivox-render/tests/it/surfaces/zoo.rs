//! A picture of one of every material, to look at.

use glam::UVec2;
use lumivox_render::{Exposure, RenderSettings, View};

use crate::common::{gpu, picture, renderer, zoo};
use crate::surfaces::stage::settings;

/// Writes the picture that `tests/snapshots/materials.png` shows small, as large as is needed to
/// look at it: one frame, and many.
#[test]
#[ignore = "by hand: writes pictures to look at"]
fn picture_to_look_at_by_hand() {
    for (name, frames) in [("materials-1", 1), ("materials", 32)] {
        let settings = RenderSettings {
            size: UVec2::new(800, 450),
            resolution: 128,
            bounces: 3,
            frames,
            exposure: Exposure::default(),
            ..settings(View::Final)
        };
        let picture = picture(&mut renderer(&gpu(), &zoo::scene(), settings));
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        picture.write(&path).expect("the picture is written");
        println!("{}", path.display());
    }
}
