# shellcheck shell=bash
#
# Packs and checks what is published, without publishing: the crates, and the packages for npm and
# Python. ./test and scripts/release.sh source it after setup.sh and set_target_dir; ./test checks
# only the crates.
#
# Packed crates are not compiled: their sources have been compiled before. check_packages.py looks
# for missing files instead.

: "${root:?set root to the repository root before sourcing packages.sh}"

# pack_crates [OPTIONS]: packs all crates that are published, in the order of their dependencies.
pack_crates() {
    : "${target_dir:?call set_target_dir first}"
    rm -rf "$target_dir/package"
    # A tree with changes may be packed, though not published.
    (cd "$root" && cargo publish --workspace --dry-run --no-verify --allow-dirty "$@")
}

# check_packages [OPTIONS]: packs the crates, and checks what they contain.
check_packages() {
    pack_crates "$@" && look_at "$target_dir/package"
}

look_at() { python3 "$root/scripts/check_packages.py" "$1"; }

# The features of lumivox-scene, one for each family of formats.
scene_features() {
    sed -n '/^\[features\]/,/^\[dependencies\]/ s/^default = \[\(.*\)\]$/\1/p' "$root/crates/lumivox-scene/Cargo.toml" | tr -d '",'
}

# check_scene_features [OPTIONS]: lints lumivox-scene without features, and with each by itself.
check_scene_features() (
    cd "$root" || exit
    local feature names
    names=$(scene_features)
    [[ -n $names ]] || die "The features of lumivox-scene were not found."
    for feature in '' $names; do
        printf 'features: %s\n' "${feature:-none}"
        cargo clippy -q "$@" -p lumivox-scene --no-default-features --features "$feature" -- -D warnings || exit
    done
)

# --- the packages for npm and Python, for scripts/release.sh --------------------------------------

# check_npm_package FOLDER: builds the page, packs its npm package into FOLDER, checks it, tries
# `npm publish --dry-run`, and installs it in an empty folder.
check_npm_package() (
    : "${target_dir:?call set_target_dir first}"
    page=$target_dir/publish-page
    mkdir -p "$1"
    folder=$(cd "$1" && pwd) || exit
    rm -f "$folder"/*.tgz
    "$root/lumivox" web --no-serve --out "$page" || exit
    cd "$page/lumivox" || exit
    npm publish --dry-run && npm pack --loglevel=error --pack-destination "$folder" &&
        look_at "$folder" || exit
    empty=$(mktemp -d) && trap 'rm -rf "$empty"' EXIT && cd "$empty" || exit
    npm init -y >/dev/null && npm install --no-audit --no-fund "$folder"/lumivox-*.tgz || exit
    # Bundlers resolve what pages import as Node.js does.
    node --input-type=module -e '
        for (const name of ["lumivox", "lumivox/inlined", "lumivox/three", "lumivox/lumivox_bg.wasm"]) {
            console.log(name, "is", import.meta.resolve(name));
        }'
)

# check_python_package FOLDER: packs the sources for Python into FOLDER, builds a wheel from only
# these, checks both, and renders with the wheel in an empty environment.
check_python_package() (
    : "${target_dir:?call set_target_dir first}"
    tools=$target_dir/tools/pypi
    mkdir -p "$1"
    folder=$(cd "$1" && pwd) || exit
    rm -f "$folder"/*.whl "$folder"/*.tar.gz
    if [[ ! -x $tools/bin/twine || ! -x $tools/bin/maturin ]]; then
        python3 -m venv "$tools" &&
            "$tools/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.16,<2' 'twine==7.*' || exit
    fi
    cd "$root/crates/lumivox-python" || exit
    "$tools/bin/maturin" build --release --sdist -o "$folder" &&
        "$tools/bin/twine" check --strict "$folder"/* && look_at "$folder" || exit
    empty=$(mktemp -d) && trap 'rm -rf "$empty"' EXIT && cd "$empty" || exit
    python3 -m venv fresh && fresh/bin/pip install --quiet --disable-pip-version-check "$folder"/lumivox-*.whl || exit
    fresh/bin/python - <<'PYTHON' && fresh/bin/lumivox --version
import lumivox

scene = lumivox.Scene.builtin("cornell")
picture = lumivox.render(scene, size=(64, 64), frames=1, preset="fast", resolution=32)
assert picture.radiance.shape == (64, 64, 3) and picture.radiance.mean() > 0.0, picture.radiance.mean()
print(f"lumivox {lumivox.__version__}: a picture of {picture.radiance.mean():.1f} cd/m2")
PYTHON
)
