# shellcheck shell=bash
#
# What is published, tried without publishing: the crates of the workspace as cargo packs them, and the packages for npm
# and Python. ./test and scripts/release.sh source it after setup.sh and set_target_dir; ./test looks at the crates alone.
#
# Crates are not compiled here: the same sources have been, and from the packages it would take as long once more. What a
# package may lack, files, is looked for instead (check_packages.py).

: "${root:?set root to the repository root before sourcing packages.sh}"

# pack_crates [OPTIONS]: packs all crates that are published, in the order in which they depend on each other.
pack_crates() {
    : "${target_dir:?call set_target_dir first}"
    rm -rf "$target_dir/package"
    # A package of a tree with changes is fine to look at, though not to publish.
    (cd "$root" && cargo publish --workspace --dry-run --no-verify --allow-dirty "$@")
}

# check_packages [OPTIONS]: packs them, and looks at what is in them.
check_packages() {
    pack_crates "$@" && look_at "$target_dir/package"
}

look_at() { python3 "$root/scripts/check_packages.py" "$1"; }

# The features of lumivox-scene, one for each family of formats.
scene_features() {
    sed -n '/^\[features\]/,/^\[dependencies\]/ s/^default = \[\(.*\)\]$/\1/p' "$root/crates/lumivox-scene/Cargo.toml" | tr -d '",'
}

# check_scene_features [OPTIONS]: lumivox-scene without a feature and with each of them compiles without a warning.
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

# --- the packages for npm and Python, for scripts/release.sh --------------------------------------------

# check_npm_package FOLDER: builds the page, packs its npm package into FOLDER, looks at it, asks npm to publish it without
# doing so, and installs it in an empty folder.
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

# check_python_package FOLDER: packs the sources for Python into FOLDER, builds a wheel from these alone, looks at both, and
# installs the wheel in an empty environment, where it renders.
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
