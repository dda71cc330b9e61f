# shellcheck shell=bash
#
# Lumivox for Bevy: a workspace of its own, with a newer Rust. Sourced by ./test after setup.sh.

: "${root:?set root to the repository root before sourcing bevy.sh}"

bevy_crate=integrations/bevy

# The Rust that its rust-toolchain.toml names.
bevy_rust() { sed -n 's/^channel *= *"\(.*\)"/\1/p' "$root/$bevy_crate/rust-toolchain.toml"; }

# That Rust, installed by rustup if it is missing.
need_bevy_rust() {
    local wanted
    wanted=$(bevy_rust)
    have rustup || die "rustup is missing: Lumivox for Bevy needs Rust $wanted beside the workspace's." \
        "Install it from https://rustup.rs, or leave that part out: ./test --only PART"
    rustup run "$wanted" cargo fmt --version >/dev/null 2>&1 && return 0
    if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
        die "Rust $wanted is missing for Lumivox for Bevy, and LUMIVOX_NO_INSTALL is set." \
            "Install it: rustup toolchain install $wanted --profile minimal -c rustfmt"
    fi
    say "Installing Rust $wanted for Lumivox for Bevy"
    rustup toolchain install "$wanted" --profile minimal -c rustfmt >&2 ||
        die "rustup could not install Rust $wanted."
}

# The files of its tests, by their names as modules.
bevy_test_files() { (cd "$root/$bevy_crate/tests/it" && grep -l '#\[test\]' -- *.rs | sed 's/\.rs$//'); }

# in_bevy COMMAND...: cargo in its folder, with that Rust and a target folder of its own.
in_bevy() (
    cd "$root/$bevy_crate" || exit
    unset CARGO_TARGET_DIR
    rustup run "$(bevy_rust)" cargo "$@"
)
