/** All settings by name. Ranges and defaults are in `parameters()`; settings that are left out keep their values. */
export interface Settings {
  /** Frames to average: a whole number from 1 to 65536, frames. Default: 16. */
  frames?: number;
  /** Radiance in cd/m2 times 2 to this power is shown; auto makes the average a middle grey: a number from -64 to 64, or auto, or auto-each, stops. Default: auto. */
  exposure?: number | "auto" | "auto-each";
  /** Curve from radiance to the screen's range: neutral, aces, linear or raw. Default: neutral. */
  tone_map?: "neutral" | "aces" | "linear" | "raw";
  /** What the picture shows: final, direct, indirect, diffuse, specular, occlusion, shadow, albedo, normal, depth, cost, history, disocclusion, voxels, lit, nodes, bricks, lod or wire-voxels. Default: final. */
  view?: "final" | "direct" | "indirect" | "diffuse" | "specular" | "occlusion" | "shadow" | "albedo" | "normal" | "depth" | "cost" | "history" | "disocclusion" | "voxels" | "lit" | "nodes" | "bricks" | "lod" | "wire-voxels";
  /** Level of the shown voxels; 0 is the finest: a whole number from 0 to 10. Default: 0. */
  level?: number;
  /** Edges of triangles over the picture: only visible ones, or all: off, over or through. Default: off. */
  wireframe?: "off" | "over" | "through";
  /** Voxels as wire cubes over the picture: only visible ones, or all: off, over or through. Default: off. */
  wire_voxels?: "off" | "over" | "through";
  /** The box of the voxel grid: on or off. Default: false. */
  show_grid?: boolean;
  /** A plain background instead of the picture under the overlay: on or off. Default: false. */
  hide_surfaces?: boolean;
  /** Voxels along the longest axis: a multiple of 8 from 16 to 1024, voxels. Default: 128. */
  resolution?: number;
  /** Shift of the grid against the scene: three numbers x,y,z, each from 0 to below 1, voxels. Default: 0,0,0. */
  grid_offset?: [number, number, number];
  /** A radiance for each of six directions, or one a cell: six_lobes or isotropic. Default: six_lobes. */
  directionality?: "six_lobes" | "isotropic";
  /** Where cells are stored, or cascades: dense, octree or cascades. Default: dense. */
  volume?: "dense" | "octree" | "cascades";
  /** How an octree's nodes are made; selects an octree: ranks or locks. Default: ranks. */
  octree_builder?: "ranks" | "locks";
  /** Boxes around the camera; selects cascades: a whole number from 1 to 16. Default: 8. */
  cascades?: number;
  /** Voxels along each axis of a cascade; selects cascades: a multiple of 8 from 32 to 256, voxels. Default: 64. */
  cascade_resolution?: number;
  /** Edge of the voxels of the finest cascade; selects cascades: a number from 0.001 to 1000, m. Default: 0.125. */
  cascade_voxel?: number;
  /** The most memory of the volume: a number from 0 to 1048576, or unlimited, MiB. Default: unlimited. */
  volume_memory?: number | "unlimited";
  /** The most memory on the GPU for vertices and indices: a number from 1 to 1048576, or unlimited, MiB. Default: unlimited. */
  geometry_budget?: number | "unlimited";
  /** How triangles become voxels: exact, dominant-axis, conservative or three-plane. Default: exact. */
  voxelizer?: "exact" | "dominant-axis" | "conservative" | "three-plane";
  /** How light comes into the voxels: direct or photons. Default: direct. */
  injection?: "direct" | "photons";
  /** Bounces of indirect light, including the one at the visible surface: a whole number from 0 to 64. Default: 16. */
  bounces?: number;
  /** How shadows of lamps and sun are found: map or cone. Default: map. */
  shadows?: "map" | "cone";
  /** Edge of a shadow map: a whole number from 16 to 32768, texels. Default: 1024. */
  shadow_resolution?: number;
  /** Diffuse cones of a pixel in a frame: 6, 9 or 12. Default: 9. */
  cones?: "6" | "9" | "12";
  /** Cones from every pixel, or from one of each 2x2 block: full or half. Default: full. */
  trace_resolution?: "full" | "half";
  /** Light of earlier frames, carried along with the surfaces that it is on: on or off. Default: false. */
  temporal?: boolean;
  /** Width of samples of the environment as a share of the cone's diameter: a number from 0.05 to 1, share. Default: 0.125. */
  voxel_per_diameter?: number;
  /** Greatest growth of the sampled voxels by metre and cosine; 0 is off: a number from 0.1 to 1, or 0, ratio. Default: 0.33333334. */
  clearance?: number;
  /** Start of the cones above the surface: a number from 0 to 4, voxels. Default: 0.5. */
  normal_offset?: number;
  /** Distance between samples as a share of the sampled voxel's edge: a number from 0.25 to 1, share. Default: 1. */
  step?: number;
  /** Share of light below which a cone ends: a number from 0 to 0.25, share. Default: 0.15. */
  min_transmittance?: number;
  /** Glossy reflections of indirect light: on or off. Default: true. */
  specular?: boolean;
  /** Width of a glossy cone as a share of the lobe's solid angle: a number from 0.02 to 1, share. Default: 0.25. */
  specular_share?: number;
  /** Reach of ambient occlusion; it never changes the light: a number from 0 to 1e9, or unlimited, m. Default: unlimited. */
  occlusion_distance?: number | "unlimited";
  /** Draw the cones' directions at random, in each frame others: on or off. Default: true. */
  jitter?: boolean;
  /** Start cones farther where a wall is felt at their start: on or off. Default: true. */
  clear_of_walls?: boolean;
  /** Radiance that is lost for the cone's width; 0 is the physics: a number from 0 to 64. Default: 0. */
  width_attenuation?: number;
  /** Radiance that is gained with each level; 1 is the physics: a number from 1 to 8, factor. Default: 1. */
  level_gain?: number;
  /** How the picture is made; preset vxct also sets what this look needs: physical or vxct. Default: physical. */
  look?: "physical" | "vxct";
  /** Cones; without them Phong's shader shows all of its terms, and no shadows: on or off. Default: true. */
  indirect_light?: boolean;
  /** Phong's terms: on or off. Default: true. */
  phong?: boolean;
  /** Phong's ambient term: on or off. Default: true. */
  phong_ambient?: boolean;
  /** Phong's diffuse term: on or off. Default: true. */
  phong_diffuse?: boolean;
  /** Phong's highlights: on or off. Default: false. */
  phong_specular?: boolean;
  /** Light by diffuse cones: on or off. Default: true. */
  vox_diffuse?: boolean;
  /** Reflections by specular cones: on or off. Default: true. */
  vox_specular?: boolean;
  /** Shadows by cones towards the lights: on or off. Default: true. */
  vox_shadows?: boolean;
  /** The diffuse cone along the normal: on or off. Default: true. */
  front_cone?: boolean;
  /** Four diffuse cones along the surface: on or off. Default: false. */
  side_cones?: boolean;
  /** Four diffuse cones half-way between normal and sides: on or off. Default: true. */
  intermediate_cones?: boolean;
  /** Angle of diffuse cones: a number from 0.001 to 2, rad. Default: 0.55. */
  diffuse_aperture?: number;
  /** Angle of shadow cones: a number from 0.001 to 2, rad. Default: 0.4. */
  occlusion_aperture?: number;
  /** Angle of specular cones: a number from 0.001 to 2, rad. Default: 0.02. */
  specular_aperture?: number;
  /** Start of diffuse cones: a number from 0 to 4, half edges. Default: 0.19. */
  diffuse_offset?: number;
  /** Start of shadow cones: a number from 0 to 4, half edges. Default: 0.08. */
  occlusion_offset?: number;
  /** Start of specular cones: a number from 0 to 4, half edges. Default: 0.15. */
  specular_offset?: number;
  /** Step of diffuse cones: a number from 0.001 to 4, diameters. Default: 0.01. */
  diffuse_dist_factor?: number;
  /** Step of shadow cones: a number from 0.001 to 4, diameters. Default: 0.35. */
  occlusion_dist_factor?: number;
  /** Step of specular cones: a number from 0.001 to 4, diameters. Default: 0.3. */
  specular_dist_factor?: number;
  /** Start of diffuse cones above the surface: a number from 0 to 1, half edges. Default: 0.05. */
  diffuse_origin_offset?: number;
  /** How fast what is in the way of light becomes a full shadow: a number from 0 to 16. Default: 1.5. */
  shadow_str?: number;
  /** How fast reflections fade where a light stands off the mirrored direction: a number from 0 to 16. Default: 3. */
  shininess_falloff?: number;
}
/** The kinds of light. */
export type LightKind = "point" | "spot" | "directional";
/** A light. Its source is invisible. Properties that its kind does not have are ignored. */
export interface Light {
  /** The name in lists and messages. Default: "light". */
  name?: string;
  /** The kind. Default: "point". */
  kind?: LightKind;
  /** Strength, luminous intensity; of a sun illuminance:
   * a number from 0 to 1e10, cd. Default: 100. */
  intensity?: number;
  /** Colour, linear red, green and blue:
   * three numbers R G B from 0 to 1e6. Default: 1 1 1. */
  color?: [number, number, number];
  /** Position, place in the world:
   * three numbers X Y Z from -1e9 to 1e9, m. Default: 0 0 0. */
  position?: [number, number, number];
  /** Direction, in which the light travels:
   * three numbers X Y Z, not all 0. Default: 0 -1 0. */
  direction?: [number, number, number];
  /** Radius, of the source, for soft shadows:
   * a number from 0 to 1e6, m. Default: 0. */
  radius_m?: number;
  /** Range, distance beyond which the light may be cut off:
   * a number above 0 to 1e9, m, or none. Default: none. */
  range_m?: number | null;
  /** Outer angle, from the axis to the end of the light:
   * an angle above 0 to 90 degrees. Default: 30. */
  outer_angle_deg?: number;
  /** Inner angle, from the axis to the fall-off:
   * an angle from 0 to outer, 30 degrees. Default: 20. */
  inner_angle_deg?: number;
  /** Angular radius, for soft shadows:
   * an angle from 0 to 90 degrees. Default: 0.26642538. */
  angular_radius_deg?: number;
  /** Attenuation, fall-off in the look vxct:
   * three numbers CONSTANT LINEAR QUADRATIC from 0 to 1e6, not all 0, or none. Default: none. */
  attenuation?: [number, number, number] | null;
}
