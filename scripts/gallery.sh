#!/usr/bin/env bash
#
# scripts/gallery.sh: makes the pictures and texts of the gallery. The table below is the only
# source of a picture's name, title, caption and command; the README, docs/generated/gallery.md and the page's
# gallery.html are written from it.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

usage() {
    cat <<'TEXT'
Usage: scripts/gallery.sh [--program FILE] [--only NAME] [--out FOLDER]
       scripts/gallery.sh --texts | --check | --list

Makes the pictures of the gallery by the commands that stand below them, and writes docs/generated/gallery.md, the page's
gallery.html and the pictures' place in README.md. Pictures are replaced when all of them are there, or not at all.
scripts/figures.sh calls it for one picture after the other, so that work can go on where it stopped.

  --program FILE  the program [default: ./lumivox, which builds it first]
  --only NAME     make one picture again, and keep the others
  --out FOLDER    put the pictures there, and write no texts [default: docs/generated/images/gallery]
  --texts         write only the texts
  --check         whether the texts follow the table and all pictures are there; makes nothing
  --list          print the names
  -h, --help      show this text

It needs the program, and cwebp and img2webp, which pack the pictures (Debian's package webp).
TEXT
}

# --- the pictures -------------------------------------------------------------------------------

names=() titles=() captions=() links=() commands=() paces=()

# picture NAME TITLE LINK [MS] <<COMMAND: the input's first line is the caption; the rest is the
# command, which writes NAME.png. With MS it writes NAME-100.png and so on: an animated picture,
# each frame for MS milliseconds. LINK, after the page's '#', opens a similar view.
picture() {
    local caption command
    IFS= read -r caption
    command=$(cat)
    names+=("$1") titles+=("$2") links+=("$3") paces+=("${4:-}") captions+=("$caption") commands+=("$command")
}

picture sun "The sun crosses an atrium" "scene=builtin:atrium&camera=-4.5,2.2,0,2,2.4,0,60" 120 <<'END'
Shadows, sky and all bounces follow the sun. The floor and the cloths that it reaches light the rest of the hall in their colours.
{
    echo 'load builtin:atrium; remove_light all; camera -4.5,2.2,0,2,2.4,0,60; size 400x225; preset realtime; frames 16'
    echo 'resolution 80; shadow_resolution 4096; exposure -12.1'
    for i in {-8..8}; do echo "sky 2,6,$i; screenshot sun-$((i + 120)).png"; done
} | ./lumivox run -
END

picture blocks "Two blocks turn" "scene=builtin:cornell&camera=0,0.75,2.9,0,0.68,0,36" 120 <<'END'
Voxels and light follow what moves: watch the red and the green on the blocks, and in their shadows.
{
    echo 'load builtin:cornell; camera 0,0.75,2.9,0,0.68,0,36; size 400x225; preset realtime; frames 16; resolution 64; exposure -1.7'
    for i in {0..17}; do
        echo "place 'tall block' -0.33 0 -0.25 0 $((17 + 5 * i)) 0 1; place 'short block' 0.33 0 0.4 0 $((-17 - 5 * i)) 0 1"
        echo "screenshot blocks-$((i + 100)).png"
    done
} | ./lumivox run -
END

picture direct "Direct light" "scene=builtin:atrium&view=direct" <<'END'
The sun alone: what it does not reach is black.
./lumivox render builtin:atrium -o direct.png --view direct --exposure -12 --shadow-resolution 4096
END

picture atrium "All light" "scene=builtin:atrium" <<'END'
The same hall at the same exposure with the light of the sky, and all bounces of both.
./lumivox render builtin:atrium -o atrium.png --exposure -12 --shadow-resolution 4096 --frames 64
END

picture voxels "What the light is computed on" "scene=builtin:atrium&view=voxels&level=1" <<'END'
The voxels of the hall in the light that they hold, here those of the second level.
./lumivox render builtin:atrium -o voxels.png --view voxels --level 1 --exposure -12 --shadow-resolution 4096
END

picture octree "Bricks of an octree" "scene=builtin:cornell&volume=octree&view=bricks&level=2" <<'END'
The Cornell box in a sparse octree: only where something is there are bricks, whose texels are pulled apart here.
./lumivox render builtin:cornell -o octree.png --volume octree --view bricks --level 2 --camera 0,1,2.9,0,1,0,40
END

picture glow "A room without lamps" "scene=builtin:glow" <<'END'
A tube, a ball and a screen are all that shines: emissive surfaces light the room. The panel at the ceiling is hidden.
./lumivox run -c 'load builtin:glow; hide panel; hide "back of the panel"; size 640x360; frames 96; screenshot glow.png'
END

picture lacquer "Lacquer" "scene=builtin:lacquer&camera=0.6,0.8,1.6,0.1,0.35,-0.5,50" <<'END'
Walls, ball and block mirror more than they scatter: glossy cones, drawn anew in each frame.
./lumivox render builtin:lacquer -o lacquer.png --camera 0.6,0.8,1.6,0.1,0.35,-0.5,50 --preset high --resolution 192 --frames 96
END

picture mirrors "Mirrors" "scene=builtin:mirrors" <<'END'
A mirror, a chrome ball, polished stone, water: rays meet planes in voxels, and lights and textures are those of the point they meet.
./lumivox render builtin:mirrors -o mirrors.png --frames 64
END

picture clutter "Three hundred small things" "scene=builtin:clutter&camera=1.2,0.5,1.3,0,0.2,0,50" <<'END'
A lamp and an even sky: each thing shades and colours its neighbours.
./lumivox render builtin:clutter -o clutter.png --camera 1.2,0.5,1.3,0,0.2,0,50 --frames 96
END

picture city "A city of a kilometre" "scene=builtin:city&camera=52,20,86,45.36,19.53,78.53,60.2&volume=cascades" <<'END'
3.7 million triangles in the evening sun, in cascades: boxes of voxels around the camera, fine near it and coarse far away.
./lumivox run -c 'volume cascades; shadow_resolution 8192; bounces 4; frames 16; size 640x360' \
    -c 'load builtin:city; camera roof; remove_light all; sky 16,215; screenshot city.png'
END

# --- the command line ---------------------------------------------------------------------------

program='' out='' only='' task=make
while (($# > 0)); do
    case $1 in
    --program) program=${2:?--program needs a file} && shift ;;
    --only) only=${2:?--only needs a name} && shift ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    --texts | --check | --list) task=${1#--} ;;
    -h | --help) usage && exit ;;
    *) usage >&2 && die "Unknown option '$1'." ;;
    esac
    shift
done

images=$root/docs/generated/images/gallery
page=crates/lumivox-web/page/gallery.html

# --- the texts ----------------------------------------------------------------------------------

# html: escapes the input for HTML.
html() { sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g; s/"/\&quot;/g'; }

# size_of I: the picture's size, from its command; the program's default is 640x360.
size_of() {
    local size=640x360
    if [[ ${commands[$1]} =~ size\ ([0-9]+x[0-9]+) ]]; then size=${BASH_REMATCH[1]}; fi
    printf '%s' "$size"
}

print_document() {
    local i
    printf '# Gallery\n\n%s\n\n' "$(grep -m1 '^Made of commit ' "$root/docs/generated/gallery.md")"
    cat <<'TEXT'
Each picture is made by the command below it, from scenes that the program has built in. `scripts/figures.sh gallery` runs all
of them, packs the pictures as WebP, and writes this page.
TEXT
    for i in "${!names[@]}"; do
        printf '\n## %s\n\n' "${titles[i]}"
        printf '![%s](images/gallery/%s.webp)\n\n%s\n\n' "${titles[i]}" "${names[i]}" "${captions[i]}"
        printf "%s\n" "\`\`\`sh" "${commands[i]}" "\`\`\`"
    done
}

print_page() {
    local i size
    cat <<'TEXT'
<!doctype html>
<!-- Written by scripts/gallery.sh. -->
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark">
<meta name="theme-color" content="#202226">
<meta name="description" content="Pictures of global illumination by voxel cone tracing, and the commands that made them.">
<meta http-equiv="Content-Security-Policy" content="default-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'">
<title>Lumivox: gallery</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="gallery.css">
</head>
<body>
<header>
<h1>Gallery</h1>
<p>Choose a picture to open its scene in the <a href="viewer.html">viewer</a>, if your browser has WebGPU. Each was made by the
command below it.</p>
</header>
<main>
TEXT
    for i in "${!names[@]}"; do
        size=$(size_of "$i")
        printf '<figure id="%s"%s>\n' "${names[i]}" "${paces[i]:+ class=\"moving\"}"
        printf '<a href="viewer.html#%s"><img src="gallery/%s.webp" width="%s" height="%s" alt="%s" loading="lazy"></a>\n' \
            "$(html <<<"${links[i]}")" "${names[i]}" "${size%x*}" "${size#*x}" "$(html <<<"${titles[i]}")"
        printf '<figcaption><h2>%s</h2><p>%s</p></figcaption>\n' "$(html <<<"${titles[i]}")" "$(html <<<"${captions[i]}")"
        printf '<details><summary>Command</summary><pre tabindex="0">%s</pre></details>\n</figure>\n' "$(html <<<"${commands[i]}")"
    done
    printf '</main>\n</body>\n</html>\n'
}

# heading_of TITLE: GitHub's anchor for this heading.
heading_of() { tr '[:upper:] ' '[:lower:]-' <<<"$1" | tr -cd 'a-z0-9-'; }

# Prints the README with the pictures between its two marks: two animations, then three in a row.
print_readme() {
    local i width end rows='' stills=0
    for i in "${!names[@]}"; do
        width=32% end=' '
        if [[ -n ${paces[i]} ]]; then width=49%; else stills=$((stills + 1)); fi
        # Each row is one line of the file.
        if ((i == 1 || (stills > 0 && stills % 3 == 0))); then end=$'\n'; fi
        printf -v rows '%s<a href="docs/generated/gallery.md#%s"><img src="docs/generated/images/gallery/%s.webp" width="%s" alt="%s"></a>%s' \
            "$rows" "$(heading_of "${titles[i]}")" "${names[i]}" "$width" "${titles[i]}" "$end"
    done
    awk -v rows="${rows% }" '
        /^<!-- gallery/ { print; print rows; skip = 1; next }
        /^<!-- end of the gallery/ { skip = 0 }
        !skip { print }' "$root/README.md"
}

# each_text DO: calls DO FILE PRINTER for each text.
each_text() {
    "$1" docs/generated/gallery.md print_document
    "$1" "$page" print_page
    "$1" README.md print_readme
}

write_text() {
    local new
    new=$("$2")
    printf '%s\n' "$new" >"$root/$1"
}

stale=()
check_text() { if [[ "$("$2")" != "$(cat "$root/$1")" ]]; then stale+=("$1"); fi; }

check_all() {
    local name reasons=()
    each_text check_text
    if ((${#stale[@]} > 0)); then reasons+=("These do not follow the table in scripts/gallery.sh: ${stale[*]}. To write them: scripts/gallery.sh --texts"); fi
    for name in "${names[@]}"; do
        [[ -s $images/$name.webp ]] || reasons+=("docs/generated/images/gallery/$name.webp is missing. To make it: scripts/gallery.sh --only $name")
    done
    if ((${#reasons[@]} > 0)); then die "${reasons[@]}"; fi
}

case $task in
list) printf '%s\n' "${names[@]}" && exit ;;
texts) each_text write_text && exit ;;
check) check_all && exit ;;
esac

# --- making them --------------------------------------------------------------------------------

if [[ -n $only ]]; then
    found=
    for name in "${names[@]}"; do if [[ $name == "$only" ]]; then found=1; fi; done
    [[ -n $found ]] || die "There is no picture '$only'." "There are: ${names[*]}"
fi
texts=
if [[ -z $out ]]; then texts=1 out=$images; fi
# Replace only an older gallery, never other files.
if [[ -e $out && -n $(find "$out" -mindepth 1 ! -name '*.webp' -print -quit) ]]; then
    die "$out is there, and is no gallery: it would be replaced." "Choose a folder that is empty or not there yet."
fi
program=$(readlink -f -- "${program:-$root/lumivox}")
[[ -x $program ]] || die "$program is no program."
need_package_for img2webp "webp, which packs the pictures," webp
have cwebp || die "cwebp is missing beside img2webp: it is in the same package, webp."

# In the same folder as the old gallery, so that one rename puts the new one there.
mkdir -p "$(dirname -- "$out")"
work=$(mktemp -d)
fresh=$(mktemp -d "${out%/}.XXXXXX")
trap 'rm -rf "$work" "$fresh"' EXIT
chmod 755 "$fresh"
if [[ -n $only && -d $out ]]; then cp -Rp "$out/." "$fresh/"; fi

# The commands call `./lumivox`, as readers do.
ln -s "$program" "$work/lumivox"

# make I: makes one picture, packed, in `fresh`.
make() {
    local name=${names[$1]} command=${commands[$1]} pace=${paces[$1]} start=$SECONDS frames
    say "[$(($1 + 1))/${#names[@]}] $name"
    (cd "$work" && bash -euo pipefail -c "$command") >"$work/log" 2>&1 </dev/null ||
        die "$name was not made, and nothing is replaced. The command:" "$command" "It said:" "$(tail -n 20 "$work/log")"
    if [[ -n $pace ]]; then
        frames=("$work/$name"-*.png)
        img2webp -loop 0 -lossy -q 92 -m 6 -d "$pace" "${frames[@]}" -o "$fresh/$name.webp" >"$work/log" 2>&1
    else
        cwebp -quiet -q 90 -m 6 -sharp_yuv "$work/$name.png" -o "$fresh/$name.webp" >"$work/log" 2>&1
    fi || die "$name could not be packed, and nothing is replaced." "$(tail -n 20 "$work/log")"
    say "      $((SECONDS - start)) s, $(($(wc -c <"$fresh/$name.webp") / 1000)) kB"
}

SECONDS=0
for i in "${!names[@]}"; do
    if [[ -z $only || ${names[i]} == "$only" ]]; then make "$i"; fi
done
rm -rf "$out"
mv "$fresh" "$out"
if [[ -n $texts ]]; then each_text write_text; fi
say "$out: ${only:-all pictures}, $SECONDS s"
