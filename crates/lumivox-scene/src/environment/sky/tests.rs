//! Compares computed skies with measurements.

use super::*;

fn sky_at(elevation_deg: f32, turbidity: f32) -> Sky {
    let (y, x) = elevation_deg.to_radians().sin_cos();
    let sun_direction = Vec3::new(x, y, 0.0);
    let settings = SkySettings { sun_direction, turbidity, width: 64, ..SkySettings::default() };
    sky(&settings).expect("valid settings")
}

fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(LUMINANCE.as_vec3())
}

fn lux(sun: Option<&Light>) -> f32 {
    sun.filter(|sun| sun.kind.is_parallel()).map_or(0.0, |sun| sun.intensity)
}

fn sky_lux(sky: &Sky) -> f32 {
    luminance(sky.map.irradiance(Vec3::Y))
}

/// IES and CIE tables of daylight: a clear noon has 90 to 115 klx across the sun's beam and 10 to
/// 20 klx from the sky on the level; haze moves light from the beam to the sky.
#[test]
fn a_clear_noon_is_as_bright_as_measured() {
    let noon = sky_at(60.0, 2.0);
    assert!((90e3..115e3).contains(&lux(noon.sun.as_ref())), "{}", lux(noon.sun.as_ref()));
    assert!((10e3..20e3).contains(&sky_lux(&noon)), "{}", sky_lux(&noon));
    // 2000 to 6000 cd/m² of blue at the zenith.
    let zenith = Vec3::from(noon.map.rgb[32]);
    assert!((2e3..6e3).contains(&luminance(zenith)), "{zenith}");
    assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
    let hazy = sky_at(60.0, 5.0);
    assert!(lux(hazy.sun.as_ref()) < 0.8 * lux(noon.sun.as_ref()));
    assert!(sky_lux(&hazy) > 1.5 * sky_lux(&noon));
}

#[test]
fn the_sun_reddens_as_it_sinks() {
    let mut last_lux = f32::INFINITY;
    let mut last_red = 0.0;
    for elevation in [60.0, 30.0, 10.0, 5.0, 2.0, 1.0, 0.0] {
        let sky = sky_at(elevation, 2.0);
        let sun = sky.sun.as_ref().expect("a part of it is up");
        let now = lux(Some(sun));
        assert!(now < last_lux && sun.color.x > last_red, "{elevation}: {now} {}", sun.color);
        assert!((luminance(sun.color) - 1.0).abs() < 1e-3);
        (last_lux, last_red) = (now, sun.color.x);
    }
    assert!(last_red > 3.0, "a setting sun is red");
}

/// Civil twilight ends, at 6 degrees below the horizon, with some 3 lx; nautical twilight, at 12,
/// with 0.01 lx (Seidelmann 1992, "Explanatory supplement to the astronomical almanac", section
/// 9.3, within the variation of the weather). At sunset there are 400 to 1000 lx.
#[test]
fn dusk_falls_as_measured() {
    let without_sun = |elevation| {
        let sky = sky_at(elevation, 2.0);
        assert!(sky.sun.is_none());
        sky_lux(&sky)
    };
    assert!((400.0..1000.0).contains(&sky_lux(&sky_at(0.0, 2.0))));
    assert!((2.0..8.0).contains(&without_sun(-6.0)), "{}", without_sun(-6.0));
    assert!((0.004..0.03).contains(&without_sun(-12.0)), "{}", without_sun(-12.0));
    assert!(without_sun(-40.0) < 1e-6);
}

#[test]
fn any_sun_gives_a_valid_scene() {
    let mut scene = crate::builtin::scene("spheres").expect("a scene");
    let directions =
        [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(-1e-20, 0.0, 0.0), Vec3::new(0.0, 1e30, -1e30)];
    for (turbidity, ground_albedo) in [(1.0, 0.0), (10.0, 1.0)] {
        let settings =
            SkySettings { turbidity, ground_albedo, width: 32, ..SkySettings::default() };
        let air = air(&settings);
        for sun_direction in directions {
            let settings = SkySettings { sun_direction, ..settings };
            check(&settings).expect("valid settings");
            let sky = sky_through(&air, &settings);
            scene.lights = sky.sun.into_iter().collect();
            scene.environment.map = Some(Arc::new(sky.map));
            scene.environment.radiance = Vec3::ONE;
            scene.validate().unwrap_or_else(|error| panic!("{settings:?}: {error}"));
        }
    }
}

/// The sky is brightest beside the sun, in the direction that the settings name.
#[test]
fn the_sky_is_brightest_beside_the_sun() {
    for azimuth in 0..8 {
        let (x, z) = (azimuth as f32).sin_cos();
        let to_sun = Vec3::new(x, 0.5, z).normalize();
        let settings = SkySettings { sun_direction: to_sun, width: 128, ..SkySettings::default() };
        let sky = sky(&settings).expect("valid settings");
        let map = &sky.map;
        let brightest = (0..map.rgb.len())
            .max_by(|a, b| {
                let of = |i: &usize| luminance(Vec3::from(map.rgb[*i]));
                of(a).total_cmp(&of(b))
            })
            .expect("texels");
        let (column, row) = (brightest as u32 % map.width, brightest as u32 / map.width);
        let at = map.direction(column as f32 + 0.5, row as f32 + 0.5);
        // Within a texel, 2.8 degrees.
        assert!(at.dot(to_sun) > 0.998, "{at} {to_sun}");
        let sun = sky.sun.expect("it is up");
        assert!((sun.direction + to_sun).length() < 1e-6);
    }
}

/// The ground reflects the share `ground_albedo` of its irradiance.
#[test]
fn the_ground_reflects_its_albedo_of_incoming_light() {
    let settings = SkySettings { ground_albedo: 0.5, width: 64, ..SkySettings::default() };
    let Sky { map, sun } = sky(&settings).expect("valid settings");
    let sun = sun.expect("it is up");
    let on_ground = map.irradiance(Vec3::Y) + sun.color * lux(Some(&sun)) * -sun.direction.y;
    let below = map.irradiance(Vec3::NEG_Y);
    // Rows are evaluated at their middles: an error of a thousandth.
    assert!((below / on_ground - 0.5).abs().max_element() < 2e-3, "{below} {on_ground}");
}

#[test]
fn invalid_sky_settings_are_refused() {
    let cases = [
        (SkySettings { turbidity: 0.5, ..SkySettings::default() }, "the turbidity is 0.5"),
        (SkySettings { ground_albedo: f32::NAN, ..SkySettings::default() }, "albedo is NaN"),
        (SkySettings { width: 8192, ..SkySettings::default() }, "from 16 to 4096"),
        (SkySettings { width: 33, ..SkySettings::default() }, "must be even"),
        (SkySettings { sun_direction: Vec3::ZERO, ..SkySettings::default() }, "a direction"),
    ];
    for (settings, expected) in cases {
        let message = sky(&settings).expect_err("out of range").to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn the_skys_sun_replaces_the_scenes_own() {
    let mut environment = Environment { radiance: Vec3::splat(7.0), ..Environment::default() };
    let lamp = Light { name: "lamp".to_owned(), ..Light::default() };
    let own =
        Light { name: "file's sun".to_owned(), kind: LightKind::Directional, ..Light::default() };
    let mut lights = vec![own, lamp.clone()];
    assert_eq!(sky_at(30.0, 2.0).surround(&mut environment, &mut lights), ["file's sun"]);
    assert_eq!(environment.radiance, Vec3::ONE);
    assert_eq!(lights.len(), 2);
    assert_eq!((&lights[0], lights[1].name.as_str()), (&lamp, Sky::SUN));

    // A new sky replaces the sun; at night there is none.
    assert!(sky_at(60.0, 2.0).surround(&mut environment, &mut lights).is_empty());
    assert_eq!(lights[1].kind, sky_at(60.0, 2.0).sun.unwrap().kind);
    assert!(sky_at(-30.0, 2.0).surround(&mut environment, &mut lights).is_empty());
    assert_eq!(lights, [lamp]);
}
