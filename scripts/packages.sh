# shellcheck shell=bash
#
# What is published, tried without publishing: the crates of the workspace as cargo packs them. ./test and
# scripts/release.sh source it after setup.sh and set_target_dir.
#
# Nothing is compiled here: the same sources have been, and from the packages it would take as long once more. What a
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
    pack_crates "$@" && python3 "$root/scripts/check_packages.py" "$target_dir/package"
}
