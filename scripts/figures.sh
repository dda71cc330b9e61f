#!/usr/bin/env bash
#
# scripts/figures.sh: remakes the pages of measurements, and copies their numbers into other pages.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"
# shellcheck source=scripts/web.sh
source "$root/scripts/web.sh"

usage() {
    cat <<'TEXT'
Usage: scripts/figures.sh [--program FILE] [PAGE...]

Makes pages of measurements in docs/: bench, quality, motion, three, gallery [default: those that are older than what they
measure]. At the end it writes the numbers that other documents copy (scripts/figures.py). For all pages an idle machine with
two cores and no GPU takes about 90 minutes, and some more to build first. Stopped by Ctrl+C it loses one case at most: the
same command goes on. Results of each state of the sources are kept in target/figures.

  --program FILE  the program, built of this commit, with lumivox-lab beside it [default: both are built first]
  -h, --help      show this text
TEXT
}

program='' pages=()
while (($# > 0)); do
    case $1 in
    --program) program=$(readlink -f -- "${2:?--program needs a file}") && shift ;;
    -h | --help) usage && exit ;;
    bench | quality | motion | three | gallery) pages+=("$1") ;;
    *) usage >&2 && die "There is no option and no page '$1'." ;;
    esac
    shift
done
if on_linux; then
    pin_software_driver || die "Mesa's software driver, on which the pages are measured, is missing (Debian: mesa-vulkan-drivers)."
fi
set_target_dir
cd "$root"
if [[ -z $program ]]; then
    ./lumivox --version >/dev/null # builds it, which is not measured
    cargo build --release -p lumivox-lab
    program=$target_dir/release/lumivox
fi
lab=$(dirname "$program")/lumivox-lab
for file in "$program" "$lab"; do [[ -x $file ]] || die "$file is no program."; done
figures() { python3 scripts/figures.py "$@"; }
if ((${#pages[@]} == 0)); then
    for page in bench quality motion three gallery; do figures --old "$page" >/dev/null || pages+=("$page"); done
fi
work=$target_dir/figures/$(figures --key)
mkdir -p "$work"

# Each page has a make_PAGE, which stores results in $work/PAGE and resumes from there.

make_bench() {
    "$program" bench --resolutions 64,128 --cache "$work/bench" --json "$work/bench.json" -o "$work/bench.md"
    cp "$work/bench.json" crates/lumivox-app/src/commands/bench/published.json
    figures --take bench "$work/bench.md"
}

# take_pictures PAGE: replaces the page and its pictures by the new ones.
take_pictures() {
    rm -rf "docs/generated/images/$1"
    cp -R "$work/$1/docs/images/$1" docs/generated/images/
    figures --take "$1" "$work/$1/docs/$1.md"
}

make_quality() {
    "$lab" quality "$work/quality/docs" --cache "$work/quality"
    take_pictures quality
}

make_motion() {
    "$lab" motion --doc "$work/motion/docs" --cache "$work/motion"
    take_pictures motion
}

make_three() {
    need_browser || die "The comparison with three.js needs Chromium and Node.js 20."
    build_web "$work/page"
    (cd crates/lumivox-web/tests/browser && npm ci --no-audit --no-fund --loglevel=error)
    LUMIVOX=$program LUMIVOX_SERVE=$server LUMIVOX_PAGE=$work/page CHROMIUM=$chromium \
        node crates/lumivox-web/tests/browser/compare.by_hand.mjs >"$work/three.md"
    figures --take three "$work/three.md"
}

make_gallery() {
    local name
    while read -r name; do
        [[ -e $work/gallery/$name.webp ]] || scripts/gallery.sh --program "$program" --only "$name" --out "$work/gallery" </dev/null
    done < <(scripts/gallery.sh --list)
    rm -rf docs/generated/images/gallery
    cp -R "$work/gallery" docs/generated/images/
    figures --take gallery docs/generated/gallery.md
    scripts/gallery.sh --texts
}

for page in ${pages[@]+"${pages[@]}"}; do
    say "== $page =="
    SECONDS=0
    "make_$page"
    say "== $page: $((SECONDS / 60)) minutes =="
done
figures --fill
