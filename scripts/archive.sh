#!/usr/bin/env bash
#
# scripts/archive.sh: packs the program for this machine, and the page as a folder for any host.
# .github/workflows/release.yml runs it on Linux, macOS and Windows.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

usage() {
    cat <<'TEXT'
Usage: scripts/archive.sh [--program FILE] [--page FOLDER] [--out FOLDER]

Writes lumivox-VERSION-TARGET.tar.gz (.zip on Windows) with the program, README and licences, and the
archive's SHA-256 beside it.

  --program FILE  take this program instead of building one in Cargo's profile `release`, with a window
  --page FOLDER   write lumivox-page-VERSION.tar.gz of a built page as well (./lumivox web --no-serve)
  --out FOLDER    where the archives go [default: target/archives]
  -h, --help      show this text
TEXT
}

program='' page='' out=''
while (($# > 0)); do
    case $1 in
    --program) program=${2:?--program needs a file} && shift ;;
    --page) page=${2:?--page needs a folder} && shift ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    -h | --help) usage && exit ;;
    *) usage >&2 && die "Unknown option '$1'." ;;
    esac
    shift
done

need_rust
set_target_dir
out=${out:-$target_dir/archives}
version=$(sed -n '/^\[workspace.package\]/,/^\[/ s/^version = "\(.*\)"$/\1/p' "$root/Cargo.toml")
target=$(rustc -vV | sed -n 's/^host: //p')
suffix=
case $target in *windows*) suffix=.exe ;; esac

# checksum FILE: writes FILE.sha256, which `sha256sum --check` reads.
checksum() (
    cd "$(dirname "$1")"
    if have sha256sum; then sha256sum "$(basename "$1")"; else shasum -a 256 "$(basename "$1")"; fi >"$(basename "$1").sha256"
)

# tidy_tar FILE FOLDER NAME: packs the folder NAME in FOLDER. With GNU tar, the archive's bytes
# depend only on its files.
tidy_tar() {
    local options=()
    if tar --version 2>/dev/null | grep -q GNU; then options=(--sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner); fi
    tar -C "$2" ${options[@]+"${options[@]}"} -cf - "$3" | gzip -9 -n >"$1"
    checksum "$1"
    say "$1"
}

if [[ -z $program ]]; then
    need_linker
    need_cxx_compiler # compiles nv-flip, which compares pictures
    (cd "$root" && cargo build --locked --release -p lumivox-app --features lumivox-app/window)
    program=$target_dir/release/lumivox$suffix
fi
[[ -f $program ]] || die "There is no program $program."
"$program" --version | grep -qF "$version" || die "$program is of another version than $version: $("$program" --version)"

staging=$(mktemp -d)
trap 'rm -rf "$staging"' EXIT
mkdir -p "$out"
name=lumivox-$version-$target
mkdir "$staging/$name"
cp "$program" "$staging/$name/lumivox$suffix"
cp "$root/README.md" "$root/CHANGELOG.md" "$root/LICENSE-MIT" "$root/LICENSE-APACHE" "$staging/$name/"
if [[ -n $suffix ]]; then
    (cd "$staging" && 7z a -bso0 "$name.zip" "$name")
    mv "$staging/$name.zip" "$out/"
    checksum "$out/$name.zip"
    say "$out/$name.zip"
else
    tidy_tar "$out/$name.tar.gz" "$staging" "$name"
fi
if [[ -n $page ]]; then
    [[ -f $page/lumivox/lumivox_bg.wasm ]] || die "$page is no page of Lumivox: build one by ./lumivox web --no-serve --out FOLDER."
    cp -R "$page" "$staging/lumivox-page-$version"
    tidy_tar "$out/lumivox-page-$version.tar.gz" "$staging" "lumivox-page-$version"
fi
