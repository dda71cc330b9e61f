#!/usr/bin/env bash
#
# scripts/tour.sh [--program FILE]: makes the pictures of the page's first page, which are there
# before the renderer has started. Scenes, cameras, settings and exposures are those of
# crates/lumivox-web/page/chapters.js, with finer voxels. It needs cwebp (Debian's package webp).

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
program=$root/lumivox
if [[ ${1:-} == --program ]]; then program=${2:?--program needs a file}; fi
out=$root/crates/lumivox-web/page/tour
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$program" run - <<'END'
size 960x540; preset realtime; frames 16; resolution 96; bounces 8; shadow_resolution 2048
load builtin:atrium; camera -5.6,1.65,-0.6,3,2.3,0.4,60.2; exposure -12
light sun direction 0.3 -1 0.36
screenshot room.png
view direct; wireframe over; screenshot triangles.png
wireframe off; view indirect; screenshot cones.png
view final; resolution 48; view voxels; screenshot voxels.png
view lit; screenshot light.png
view final; resolution 96
load builtin:furnished; camera 2.3,1.7,1.8,-0.8,0.75,-0.6,57.3; exposure -4.2; screenshot lamp.png
load builtin:two-rooms-closed; camera 1.85,1.3,-0.8,0,0.85,0.3,60.2; exposure -1.4
place 'dividing wall' 0 0 -0.5 0 0 0 1; screenshot wall.png
load builtin:cornell; exposure -2; screenshot measure.png
END
mkdir -p "$out"
for picture in *.png; do cwebp -quiet -q 82 -m 6 "$picture" -o "$out/${picture%.png}.webp"; done
