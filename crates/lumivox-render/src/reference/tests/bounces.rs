//! Tests of limits of bounces.

use super::*;

#[test]
fn the_first_gather_equals_a_one_bounce_render() {
    let scene = builtin("cornell");
    let by =
        |bounces, samples| traced(&scene, &ReferenceSettings { bounces, ..settings(16, samples) });
    let one = by(Some(1), 16);
    assert_eq!(one.one_bounce, one.full);
    assert_eq!(one.one_bounce_variance, one.full_variance);
    let none = by(Some(0), 16);
    assert_eq!(none.radiance, none.direct);
    assert!(none.full.iter().flatten().all(|value| *value == 0.0));

    // The first bounce does not depend on the number of further ones.
    let (one, many, all) = (by(Some(1), 64), by(Some(24), 64), by(None, 64));
    let once =
        |layers: &ReferenceLayers| Estimate::of(&layers.one_bounce, &layers.one_bounce_variance);
    once(&many).assert_near("one of many bounces", once(&one));
    // Bounces from the 25th on add less than 0.73^24 of the light, a two-thousandth.
    let limit = Estimate::full(&all);
    let most = Estimate::full(&many);
    most.assert_near(
        "24 bounces",
        Estimate { error: limit.error.hypot(1.5e-4 * limit.mean), ..limit },
    );
    let first = Estimate::full(&one);
    assert!(first.mean + 4.0 * first.error < limit.mean, "bounces add light");
    // Direct light does not depend on bounces.
    let direct = |layers: &ReferenceLayers| Estimate::of(&layers.direct, &layers.direct_variance);
    direct(&one).assert_near("direct light", direct(&all));
}
