#!/usr/bin/env bash
#
# scripts/release.sh VERSION: checks everything that must be true before a release is published, and
# refuses it otherwise. docs/releasing.md has the steps around it. It publishes nothing itself.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/python.sh
source "$root/scripts/python.sh"

usage() {
    cat <<'TEXT'
Usage: scripts/release.sh [--quick] VERSION
       scripts/release.sh --packages

Refuses, with all reasons at once, unless the tree is ready to be released as VERSION: versions, changelog,
address of the source, pages of measurements, toolchain. Then it packs the crates, the npm package and the
Python package, looks at them, asks npm and twine what they think of them, installs the last two in empty folders,
and runs ./test --full with what only a release needs (LUMIVOX_RELEASE=1). At the end it prints the commands that publish.

  --quick     only what takes seconds: not the packages, and not the tests
  --packages  only the packages, of any tree: what they lack is seen before a release
  -h, --help  show this text
TEXT
}

quick='' only_packages='' version=''
while (($# > 0)); do
    case $1 in
    --quick) quick=1 ;;
    --packages) only_packages=1 ;;
    -h | --help) usage && exit ;;
    -*) usage >&2 && die "Unknown option '$1'." ;;
    *) version=$1 ;;
    esac
    shift
done
cd "$root"

# try_packages: packs and checks all packages. Those for npm and Python stay in $publish.
try_packages() {
    need_rust
    need_linker
    need_cxx_compiler
    need_python
    have npm || die "npm is missing: it packs the page's package. Install Node.js 20 or newer."
    set_target_dir
    publish=$target_dir/publish
    check_packages "$@" || die "The crates are not fit to be published (the reasons are above)."
    check_npm_package "$publish/npm" || die "The npm package is not fit to be published (the reasons are above)."
    check_python_package "$publish/python" || die "The Python package is not fit to be published (the reasons are above)."
}

if [[ -n $only_packages ]]; then
    [[ -z $version$quick ]] || { usage >&2 && die "--packages takes no version and no --quick."; }
    try_packages
    say "The packages are fit to be published. Those for npm and Python are in $publish."
    exit
fi
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || { usage >&2 && die "VERSION is three numbers, such as 0.2.0; got '$version'."; }

reasons=()
refuse() { reasons+=("$1"); }

# workspace_field NAME: a text of [workspace.package] in Cargo.toml.
workspace_field() { sed -n '/^\[workspace.package\]/,/^\[/ s/^'"$1"' = "\(.*\)"$/\1/p' Cargo.toml; }

# --- the versions -------------------------------------------------------------------------------

same_version() { [[ $1 == "$version" ]] || refuse "$2 has version '$1', not $version"; }
same_version "$(workspace_field version)" "[workspace.package] of Cargo.toml"
while read -r line; do
    own=${line#*version = \"}
    same_version "${own%%\"*}" "the dependency ${line%% *} in Cargo.toml"
done < <(grep -E '^lumivox[a-z-]* = \{ path = ' Cargo.toml)
same_version "$(sed -n 's/^ *"version": "\(.*\)",$/\1/p' crates/lumivox-web/npm/package.json)" "the npm package"
grep -q "\"lumivox\": \"^$version\"" crates/lumivox-three/example/package.json ||
    refuse "crates/lumivox-three/example/package.json asks for another version of lumivox than ^$version"
git rev-parse -q --verify "refs/tags/v$version" >/dev/null && refuse "the tag v$version is there already"

# --- changelog, metadata, measurements ------------------------------------------------------------

grep -qE "^## \[${version//./\\.}\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md ||
    refuse "CHANGELOG.md has no section '## [$version] - YYYY-MM-DD'"
unreleased=$(sed -n '/^## \[Unreleased\]/,/^## \[[0-9]/p' CHANGELOG.md | grep -c '^- ' || true)
((unreleased == 0)) || refuse "CHANGELOG.md has $unreleased changes under Unreleased: they belong to a version"
[[ -n $(workspace_field repository) ]] ||
    refuse "[workspace.package] of Cargo.toml has an empty repository: registries and cargo binstall need its address"
grep -q '"repository"' crates/lumivox-web/npm/package.json || refuse "the npm package.json has no repository"
grep -qi '^repository *=' crates/lumivox-python/pyproject.toml || refuse "[project.urls] of pyproject.toml has no Repository"

if ! old=$(python3 scripts/figures.py --old); then
    while read -r reason; do refuse "$reason"; done <<<"${old:-scripts/figures.py --old failed (its message is above)}"
fi

# --- the tree and the tools -----------------------------------------------------------------------

[[ -z $(git status --porcelain) ]] || refuse "the tree has changes: commit them, or take them back"
need_rust
minimum=$(workspace_field rust-version)
[[ $(rustc --version) == "rustc $minimum."* ]] ||
    refuse "the tests must run with the oldest Rust that Cargo.toml admits: RUSTUP_TOOLCHAIN=$minimum (this is $(rustc --version))"

if ((${#reasons[@]} > 0)); then
    printf '\nNot ready to be released as %s:\n' "$version" >&2
    printf '  - %s\n' "${reasons[@]}" >&2
    exit 1
fi
say "What can be seen at once is ready for $version."
[[ -z $quick ]] || exit 0

try_packages --locked
# With these, tests would write their expectations, or run on a device that has other tolerances.
unset LUMIVOX_BLESS LUMIVOX_TEST_ANY_ADAPTER
commit=$(git rev-parse HEAD)
LUMIVOX_NEED_ADVISORIES=1 LUMIVOX_RELEASE=1 CI=true ./test --full || die "A check failed (its message is above)."
[[ $(git rev-parse HEAD) == "$commit" && -z $(git status --porcelain) ]] ||
    die "The tree is not what was tested any more: commit its changes, or take them back, and begin again."

cat <<TEXT

Ready. These publish it (docs/releasing.md):
  git tag -s v$version -m "Lumivox $version" && git push origin v$version
  cargo publish --workspace --locked
  npm publish $(compgen -G "$publish/npm/*.tgz")
  $target_dir/tools/pypi/bin/twine upload $publish/python/*
TEXT
