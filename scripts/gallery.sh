#!/usr/bin/env bash
#
# scripts/gallery.sh [PROGRAM]: makes the pictures of docs/gallery.md, and that page with the command of each. They are made by
# the program alone; ImageMagick packs them into small files.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

program=${1:-}
if [[ -z $program ]]; then
    need_rust
    set_target_dir
    (cd "$root" && cargo build --locked --release -p lumivox-app)
    program=$target_dir/release/lumivox
fi
need_package_for convert "ImageMagick, which packs pictures," imagemagick

images=$root/docs/images/gallery
page=$root/docs/gallery.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$images"
rows=()

# run NAME SCENE OPTIONS...: renders, and keeps the command for the page.
run() {
    local output=$1
    say "lumivox render ${*:2} -o $output"
    (cd "$work" && "$program" render "${@:2}" -o "$output" >/dev/null)
    command="lumivox render ${*:2} -o $output"
}

# picture NAME TEXT SCENE OPTIONS...
picture() {
    run "$1.png" "${@:3}" --size 400x225 --frames 8
    convert "$work/$1.png" -strip -sampling-factor 4:2:0 -quality 82 -interlace JPEG "$images/$1.jpg"
    rows+=("![$2](images/gallery/$1.jpg)" "" "*$2*" "" '```sh' "$command" '```' "")
}

# film NAME TEXT SCENE OPTIONS...: an animated picture of a sequence.
film() {
    run "$1" "${@:3}" --size 240x136
    convert -delay 10 -loop 0 "$work/$1"/*.png -strip -layers OptimizeTransparency "$images/$1.gif"
    rows+=("![$2](images/gallery/$1.gif)" "" "*$2*" "" '```sh' "$command" '```' "")
}

picture cornell "The Cornell box: all light from one lamp, many bounces" builtin:cornell
picture atrium "A hall under sun and sky" builtin:atrium
picture window "A low sun through one window" builtin:window
picture furnished "A room with things thinner than a voxel" builtin:furnished
picture spheres "Roughness from 0.05 to 1, metal and dielectric" builtin:spheres
picture lacquer "Deep colours, and black that mirrors" builtin:lacquer
picture clutter "Three hundred small things under a lamp and a sky" builtin:clutter
picture voxels "What cones see: the voxels of the hall, lit" builtin:atrium --view voxels --level 1
film orbit "Around the spheres, with light of earlier frames" builtin:spheres --orbit 360 --time 0..3 --fps 8 --preset realtime --frames 4
film voxels-orbit "The same, as the voxels that carry its light" builtin:spheres --view voxels --orbit 360 --time 0..3 --fps 8 --frames 2

{
    printf '%s\n' "# Gallery" "" "All pictures are the program's own; \`scripts/gallery.sh\` makes them again, and this page." ""
    printf '%s\n' "${rows[@]}"
} | sed '${/^$/d}' >"$page"
say "$page"
