//! A city, a kilometre wide, and a room in it, by day and by night: near and far light in one
//! scene.
//!
//! Ten by ten blocks of 100 m, each surrounded by streets, with houses along its four sides and a
//! court inside. There are about thirty kinds of houses ([`house`]) with rooms behind open windows.
//! They get higher towards the centre, where towers stand in the courts. A stadium takes four
//! blocks, a park one. Everything is computed from hashes of a block's number, so the city is the
//! same on every machine.
//!
//! The 3.7 million triangles are instances of 88 meshes. The colours of a mesh's parts are vertex
//! colours, so that a house is one instance, plus one for the lamps in its rooms. By night the
//! lamps of rooms, streets and the stadium shine, all as emissive surfaces; by day there are the
//! sun and a computed sky.

mod flight;
mod home;
mod house;
mod paint;
mod street;
#[cfg(test)]
mod tests;

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat4, Vec3};

use self::flight::Stop;
use self::house::{Kind, Roof, house};
use self::paint::{Paint, chance, pick};
use super::build::{diffuse, glowing};
use crate::sky::{SkySettings, sky};
use crate::{Camera, Environment, Instance, Mesh, Scene, SceneError};

/// Blocks along an edge of the city.
const BLOCKS: u32 = 10;
/// The edge of a block, with half of the streets around it.
const BLOCK_M: f32 = 100.0;
/// The height of pavements above streets.
const PAVEMENT_M: f32 = 0.15;
/// The block of the home, the park, and the first of the stadium's four, along x and z.
const HOME: [u32; 2] = [5, 5];
const PARK: [u32; 2] = [3, 6];
const STADIUM: [u32; 2] = [6, 2];
/// The lot of the home along the side of its block that faces +z.
const HOME_LOT: u32 = 2;

/// Radiance of the lamps at night, cd/m²: a street lamp of 5000 lm, room lamps of 1500 lm, stadium
/// lights of 1 Mlm each, the home's lamp of 900 lm.
const STREET_LAMP: Vec3 = Vec3::new(6500.0, 5400.0, 3900.0);
const ROOM_LAMP: Vec3 = Vec3::new(1600.0, 1300.0, 900.0);
const FLOODLIGHT: Vec3 = Vec3::new(9600.0, 10000.0, 10400.0);
const HOME_LAMP: Vec3 = Vec3::new(1100.0, 880.0, 560.0);
/// Radiance of the sky above a city at night, cd/m².
const NIGHT_SKY: Vec3 = Vec3::new(0.020, 0.022, 0.030);
/// The direction to the sun: 44 degrees high.
const TO_SUN: Vec3 = Vec3::new(0.55, 0.72, 0.48);

/// The city; viewed from within the home if `is_inside`.
pub(super) fn scene(is_night: bool, is_inside: bool) -> Result<Scene, SceneError> {
    let mut city = City::new(is_night);
    for (x, z) in (0..BLOCKS).flat_map(|x| (0..BLOCKS).map(move |z| (x, z))) {
        city.block([x, z]);
    }
    city.stadium();
    city.home();
    let mut scene = city.scene;
    if is_night {
        scene.environment = Environment { radiance: NIGHT_SKY, ..Environment::default() };
    } else {
        let day =
            sky(&SkySettings { sun_direction: TO_SUN, width: 128, ..SkySettings::default() })?;
        scene.environment = Environment {
            radiance: Vec3::ONE,
            map: Some(day.map.into()),
            ..Environment::default()
        };
        scene.lights.extend(day.sun);
    }
    cameras(&mut scene, is_inside);
    flight::install(&mut scene, &FLIGHT)?;
    Ok(scene)
}

/// Indices of a mesh and of the mesh of its emissive faces.
#[derive(Clone, Copy)]
struct Lit {
    body: usize,
    lamps: usize,
}

struct City {
    scene: Scene,
    /// Materials for meshes with vertex colours: white, then other tints.
    paints: Vec<usize>,
    street_lamps: usize,
    room_lamps: usize,
    floodlights: usize,
    home_lamp: usize,
    grounds: Vec<usize>,
    square: usize,
    /// Houses 16 m wide, from low to high.
    wide: Vec<Lit>,
    /// Houses 14 m wide, from low to high.
    narrow: Vec<Lit>,
    towers: Vec<Lit>,
    lamp: Lit,
    trees: Vec<usize>,
    cars: Vec<usize>,
}

fn add(scene: &mut Scene, name: &str, mut mesh: Mesh) -> usize {
    name.clone_into(&mut mesh.name);
    scene.meshes.push(mesh);
    scene.meshes.len() - 1
}

fn lit(scene: &mut Scene, name: &str, (body, lamps): (Paint, Mesh)) -> Lit {
    let body = add(scene, name, body.mesh);
    Lit { body, lamps: add(scene, &format!("{name}, lamps"), lamps) }
}

/// Houses of one width, from low to high, two of each height.
fn houses(scene: &mut Scene, width_m: f32) -> Vec<Lit> {
    let facades = [
        Vec3::new(0.62, 0.55, 0.44),
        Vec3::new(0.48, 0.22, 0.15),
        Vec3::new(0.68, 0.66, 0.62),
        Vec3::new(0.55, 0.46, 0.26),
        Vec3::new(0.40, 0.44, 0.47),
        Vec3::new(0.66, 0.48, 0.38),
    ];
    let mut kinds = Vec::new();
    for (number, storeys) in (0..).zip([2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 8, 8, 9, 11]) {
        let seed = number * 16 + width_m as u32;
        let kind = Kind {
            width_m,
            depth_m: 12.0,
            storeys,
            rooms: if number % 3 == 1 { 2 } else { 3 },
            glazing: if storeys > 6 { 0.66 } else { 0.34 },
            roof: if storeys < 6 && number % 3 != 0 { Roof::Gable } else { Roof::Flat },
            facade: pick(&facades, chance(seed, 1, 1)),
            has_balconies: number % 4 == 2,
            seed,
            empty_room: None,
        };
        kinds.push(lit(scene, &format!("house {width_m} m, {storeys} storeys"), house(&kind)));
    }
    kinds
}

impl City {
    fn new(is_night: bool) -> Self {
        let mut scene = Scene::default();
        let tints = [
            Vec3::ONE,
            Vec3::new(1.0, 0.94, 0.84),
            Vec3::new(0.90, 0.95, 1.0),
            Vec3::new(1.0, 0.88, 0.84),
            Vec3::new(0.88, 0.96, 0.86),
            Vec3::splat(0.85),
        ];
        let paints =
            (0..).zip(tints).map(|(i, tint)| diffuse(&mut scene, &format!("paint {i}"), tint));
        let paints = paints.collect();
        let mut shining = |name: &str, radiance: Vec3| {
            if is_night {
                glowing(&mut scene, name, radiance)
            } else {
                diffuse(&mut scene, name, Vec3::splat(0.8))
            }
        };
        let street_lamps = shining("street lamps", STREET_LAMP);
        let room_lamps = shining("lamps of rooms", ROOM_LAMP);
        let floodlights = shining("floodlights", FLOODLIGHT);
        let home_lamp = shining("lamp of the home", HOME_LAMP);
        let ground = |seed: u32| {
            let paint = street::ground(seed, false);
            (format!("ground {seed}"), paint.mesh)
        };
        let grounds = (0..4).map(ground).map(|(name, mesh)| add(&mut scene, &name, mesh)).collect();
        let square = add(&mut scene, "square", street::ground(9, true).mesh);
        let wide = houses(&mut scene, 16.0);
        let narrow = houses(&mut scene, 14.0);
        let towers = [16, 21, 28].map(|storeys| {
            let kind = Kind {
                width_m: 24.0,
                depth_m: 24.0,
                storeys,
                rooms: 3,
                glazing: 0.7,
                roof: Roof::Flat,
                facade: Vec3::new(0.50, 0.52, 0.54) * (0.6 + 0.02 * storeys as f32),
                has_balconies: false,
                seed: 1000 + storeys,
                empty_room: None,
            };
            lit(&mut scene, &format!("tower of {storeys} storeys"), house(&kind))
        });
        let lamp = lit(&mut scene, "street lamp", street::lamp());
        let trees =
            (0..5).map(|i| add(&mut scene, &format!("tree {i}"), street::tree(i).mesh)).collect();
        let cars =
            (0..6).map(|i| add(&mut scene, &format!("car {i}"), street::car(i).mesh)).collect();
        Self {
            scene,
            paints,
            street_lamps,
            room_lamps,
            floodlights,
            home_lamp,
            grounds,
            square,
            wide,
            narrow,
            towers: towers.to_vec(),
            lamp,
            trees,
            cars,
        }
    }

    fn put(&mut self, mesh: usize, material: usize, world_from_local: Mat4) {
        let name = self.scene.meshes[mesh].name.clone();
        let instance = Instance { name, mesh, material, world_from_local, ..Instance::default() };
        self.scene.instances.push(instance);
    }

    fn put_lit(&mut self, lit: Lit, paint: usize, lamps: usize, at: Mat4) {
        self.put(lit.body, self.paints[paint], at);
        if !self.scene.meshes[lit.lamps].indices.is_empty() {
            self.put(lit.lamps, lamps, at);
        }
    }

    fn block(&mut self, block: [u32; 2]) {
        let center = center(block);
        let [x, z] = block;
        let luck = |what: u32| chance(x, z, what);
        let within = |first: [u32; 2]| {
            (first[0]..first[0] + 2).contains(&x) && (first[1]..first[1] + 2).contains(&z)
        };
        if within(STADIUM) {
            self.put(self.square, self.paints[0], Mat4::from_translation(center));
            return;
        }
        let ground = pick(&self.grounds, luck(0));
        self.put(ground, self.paints[0], Mat4::from_translation(center));
        for side in 0..4 {
            self.side(block, side);
        }
        let trees = if block == PARK { 60 } else { 7 };
        let reach = if block == PARK { 37.0 } else { 22.0 };
        let has_tower = self.tower(block);
        for tree in 0..trees {
            let place = |axis: u32| 2.0 * chance(x * 64 + tree, z, 40 + axis) - 1.0;
            let at = Vec3::new(place(0), 0.0, place(1)) * reach;
            // No tree stands in a tower or too close to it.
            if at.abs().min_element() > 50.0 || (has_tower && at.abs().max_element() < 15.0) {
                continue;
            }
            self.tree(center + at + Vec3::Y * PAVEMENT_M, chance(x, z, 80 + tree));
        }
    }

    /// Adds a tower in the court to some blocks near the city's centre; returns `true` if it did.
    fn tower(&mut self, block: [u32; 2]) -> bool {
        let [x, z] = block;
        let is_tower = downtown(block) > 0.55 && block != HOME && chance(x, z, 7) < 0.7;
        if is_tower {
            let tower = pick(&self.towers, chance(x, z, 8));
            let at = center(block) + Vec3::new(0.0, PAVEMENT_M, 12.0);
            self.put_lit(tower, 0, self.room_lamps, Mat4::from_translation(at));
        }
        is_tower
    }

    fn tree(&mut self, foot: Vec3, chance: f32) {
        let tree = pick(&self.trees, chance);
        let at = Mat4::from_translation(foot)
            * Mat4::from_rotation_y(TAU * (chance * 97.0).fract())
            * Mat4::from_scale(Vec3::splat(0.75 + 0.5 * (chance * 31.0).fract()));
        self.put(tree, self.paints[0], at);
    }

    /// The houses along a side of a block, and the lamps, trees and cars before them.
    fn side(&mut self, block: [u32; 2], side: u32) {
        let [x, z] = block;
        // The sides along x have more lots than the sides along z.
        let is_long = side.is_multiple_of(2);
        let turn = Mat4::from_translation(center(block) + Vec3::Y * PAVEMENT_M)
            * Mat4::from_rotation_y(side as f32 * FRAC_PI_2);
        let (lots, width_m) = if is_long { (5, 16.0) } else { (4, 14.0) };
        for lot in 0..lots {
            let luck = |what: u32| chance(x * 16 + side, z * 16 + lot, what);
            let along = (lot as f32 + 0.5 - 0.5 * lots as f32) * width_m;
            let at = turn * Mat4::from_translation(Vec3::new(along, 0.0, street::FRONT_M));
            let is_home = block == HOME && side == 0 && lot == HOME_LOT;
            if block == PARK || is_home || luck(20) < 0.1 {
                continue;
            }
            let kinds = if is_long { &self.wide } else { &self.narrow };
            // Low houses are everywhere, high ones towards the centre.
            let high = 0.45 * luck(21) + 0.55 * downtown(block) * (0.6 + 0.4 * luck(22));
            let kind = pick(kinds, high);
            let paint = (luck(23) * self.paints.len() as f32) as usize;
            self.put_lit(kind, paint, self.room_lamps, at);
        }
        for lamp in 0..3 {
            let along = (lamp as f32 - 1.0) * 30.0;
            let at = turn * Mat4::from_translation(Vec3::new(along, 0.0, 43.3));
            self.put_lit(self.lamp, 0, self.street_lamps, at);
        }
        for tree in 0..4 {
            let along = tree as f32 * 15.0 - 22.5;
            let luck = chance(x * 16 + side, z * 16 + tree, 30);
            if tree % 3 == 0 && luck < 0.7 {
                self.tree(turn.transform_point3(Vec3::new(along, 0.0, 42.8)), luck);
            }
        }
        for car in 0..12 {
            let luck = |what: u32| chance(x * 16 + side, z * 16 + car, what);
            if luck(31) < 0.45 {
                let along = (car as f32 - 5.5) * 6.2 + luck(32);
                let at = turn
                    * Mat4::from_translation(Vec3::new(along, -PAVEMENT_M, 45.2))
                    * Mat4::from_rotation_y(if luck(33) < 0.5 { 0.0 } else { PI });
                self.put(pick(&self.cars, luck(34)), self.paints[0], at);
            }
        }
    }

    fn stadium(&mut self) {
        let [x, z] = STADIUM;
        let middle = 0.5 * (center([x, z]) + center([x + 1, z + 1]));
        let oval = Mat4::from_translation(middle) * Mat4::from_scale(Vec3::new(1.0, 1.0, 0.72));
        let stands = add(&mut self.scene, "stands", street::stands().mesh);
        for section in 0..street::SECTIONS {
            let turn = TAU * section as f32 / street::SECTIONS as f32;
            self.put(stands, self.paints[0], oval * Mat4::from_rotation_y(turn));
        }
        let lawn = add(&mut self.scene, "lawn", street::lawn().mesh);
        self.put(lawn, self.paints[0], Mat4::from_translation(middle));
        let mast = lit(&mut self.scene, "mast", street::mast());
        for corner in 0..4 {
            let turn = Mat4::from_rotation_y((corner as f32 + 0.5) * FRAC_PI_2);
            let at = Mat4::from_translation(middle) * turn;
            let at = at * Mat4::from_translation(Vec3::NEG_Z * 118.0);
            self.put_lit(mast, 0, self.floodlights, at);
        }
    }

    fn home(&mut self) {
        let kind = lit(&mut self.scene, "home", house(&home::KIND));
        let at = Mat4::from_translation(home_foot());
        self.put_lit(kind, 1, self.room_lamps, at);
        let room = lit(&mut self.scene, "living room", home::furniture());
        let at = at * Mat4::from_translation(home::middle());
        self.put_lit(room, 0, self.home_lamp, at);
    }
}

/// The centre of a block.
fn center([x, z]: [u32; 2]) -> Vec3 {
    let at = |number: u32| (number as f32 - 0.5 * (BLOCKS - 1) as f32) * BLOCK_M;
    Vec3::new(at(x), 0.0, at(z))
}

/// The foot of the home's front, in the middle.
fn home_foot() -> Vec3 {
    let along = (HOME_LOT as f32 - 2.0) * 16.0;
    center(HOME) + Vec3::new(along, PAVEMENT_M, street::FRONT_M)
}

/// How close a block is to the centre of the city, from 0 to 1.
fn downtown(block: [u32; 2]) -> f32 {
    let away = (center(block) - Vec3::new(-50.0, 0.0, -50.0)).length();
    (1.0 - away / 420.0).clamp(0.0, 1.0)
}

fn cameras(scene: &mut Scene, is_inside: bool) {
    let camera = |name: &str, eye: [f32; 3], target: [f32; 3]| Camera {
        name: name.to_owned(),
        near_m: 0.05,
        ..Camera::look_at(Vec3::from(eye), Vec3::from(target), 1.05)
    };
    let room = home_foot() + home::middle();
    let in_room = |name: &str, eye: [f32; 3], target: [f32; 3]| {
        let [eye, target] = [eye, target].map(|place| (room + Vec3::from(place)).to_array());
        camera(name, eye, target)
    };
    let city = [
        camera("street", [8.0, 1.75, 97.0], [62.0, 5.0, 101.0]),
        camera("court", [62.0, 1.75, 70.0], [38.0, 6.0, 34.0]),
        camera("roof", [52.0, 20.0, 86.0], [-60.0, 12.0, -40.0]),
        camera("above", [330.0, 190.0, 420.0], [40.0, 0.0, 20.0]),
        camera("stadium", [122.0, 13.0, -197.0], [215.0, 2.0, -205.0]),
    ];
    let inside = [
        in_room("to the window", [1.6, 1.6, -2.4], [-0.7, 1.15, 2.0]),
        in_room("from the window", [2.6, 1.7, 2.2], [-2.0, 0.9, -1.2]),
    ];
    if is_inside {
        scene.cameras.extend(inside.into_iter().chain(city));
    } else {
        scene.cameras.extend(city.into_iter().chain(inside));
    }
    scene.cameras.push(Camera { near_m: 0.05, ..flight::at(&FLIGHT, 0.0) });
}

/// The path of the flight: along the street of the home, up over the roofs, around the towers, and
/// down into the stadium.
const FLIGHT: [Stop; 9] = [
    Stop { time_s: 0.0, eye: [-60.0, 2.5, 100.0], target: [-20.0, 4.0, 100.0] },
    Stop { time_s: 6.0, eye: [10.0, 3.0, 100.0], target: [60.0, 6.0, 99.0] },
    Stop { time_s: 11.0, eye: [58.0, 8.0, 100.5], target: [100.0, 12.0, 90.0] },
    Stop { time_s: 15.0, eye: [98.0, 22.0, 88.0], target: [98.0, 26.0, 30.0] },
    Stop { time_s: 20.0, eye: [100.0, 52.0, 20.0], target: [60.0, 50.0, -60.0] },
    Stop { time_s: 26.0, eye: [100.0, 105.0, -90.0], target: [0.0, 30.0, -120.0] },
    Stop { time_s: 32.0, eye: [110.0, 80.0, -140.0], target: [200.0, 0.0, -200.0] },
    Stop { time_s: 37.0, eye: [150.0, 34.0, -185.0], target: [215.0, 6.0, -205.0] },
    Stop { time_s: 42.0, eye: [180.0, 6.0, -195.0], target: [230.0, 9.0, -212.0] },
];
