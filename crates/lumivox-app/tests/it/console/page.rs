//! The page of the console's commands in the docs.

use std::fs;

use super::session::project;
use crate::common::{folder, lumivox};

/// VXCT's commands, with all names.
const VXCT: &str = "objs objsW sfMode sf overlayW pos1 pos2 exit quit q load setmat translate rotate scale toggle vox dynamic \
                    voxs voxsW loclod vox_freq lod iLight phong phong_ambient phong_specular phong_diffuse front_cone \
                    side_cones intermediate_cones phong_only shadows_only specular_only diffuse_only all vox_diffuse vdiff \
                    vox_specular vspec vox_shadows vshad diffuse_offset do specular_offset so occlusion_offset oo \
                    diffuse_origin_offset doo diffuse_dist_factor ddf occlusion_dist_factor odf specular_dist_factor sdf \
                    diffuse_aperture da occlusion_aperture oa specular_aperture sa shadow_str ss shininess_falloff ray avgf \
                    clearf lastframes draw_block";

/// `LUMIVOX_BLESS=1` writes the page.
#[test]
fn console_md_matches_the_printed_commands() {
    let folder = folder();
    let printed = lumivox(folder.path(), "commands --markdown").expect_ok().stdout;
    let page = project("docs/generated").join("console.md");
    if std::env::var_os("LUMIVOX_BLESS").is_some() {
        fs::write(&page, &printed).unwrap();
    }
    let committed = fs::read_to_string(&page).unwrap_or_default();
    assert!(
        committed == printed,
        "docs/generated/console.md is not what `lumivox commands --markdown` prints; LUMIVOX_BLESS=1 writes it"
    );
}

#[test]
fn console_md_lists_all_vxct_commands() {
    let page = lumivox(folder().path(), "commands --markdown").expect_ok().stdout;
    let (_, table) = page.split_once("## Commands of VXCT").unwrap();
    let first = |line: &str| line.split('|').nth(1).unwrap_or_default().to_owned();
    let named: String = table.lines().filter(|line| line.starts_with("| `")).map(first).collect();
    for name in VXCT.split_whitespace() {
        assert!(named.contains(&format!("`{name}`")), "{name} is missing in\n{named}");
    }
}
