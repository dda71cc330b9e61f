# shellcheck shell=bash
#
# Lumivox for Bevy: its own workspace, with a newer Rust. Sourced by ./test after setup.sh.

: "${root:?set root to the repository root before sourcing bevy.sh}"

bevy_crate=integrations/bevy

# The Rust that its rust-toolchain.toml names.
bevy_rust() { sed -n 's/^channel *= *"\(.*\)"/\1/p' "$root/$bevy_crate/rust-toolchain.toml"; }

# Installs that Rust with rustup if it is missing.
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

# Prints the names of its test modules, one line per process. Mesa 22.3's software driver leaks
# 3.4 MB per frame of Bevy: 5 GB for the 1400 frames of a process. Tests that compare with the same
# pictures share a process.
bevy_test_groups() {
    local file others=()
    for file in $(cd "$root/$bevy_crate/tests/it" && grep -l '#\[test\]' -- *.rs); do
        case $file in changes.rs | deforming.rs) ;; *) others+=("${file%.rs}") ;; esac
    done
    printf '%s\n' "${others[*]}" "changes deforming"
}

# run_bevy_tests CARGO_ARGUMENTS... -- TEST_ARGUMENTS...: runs the groups, two at a time if there is
# memory for two, since each process uses little more than one core. Lines begin with the group's
# first file.
run_bevy_tests() {
    local cargo=() files most=1 running=0 status=0 free_kib
    while (($# > 0)) && [[ $1 != -- ]]; do cargo+=("$1") && shift; done
    shift
    free_kib=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' /proc/meminfo 2>/dev/null || true)
    if ((${free_kib:-0} > 12 << 20)); then most=2; fi
    while read -r -a files <&3; do
        if ((running == most)); then
            # macOS has an old bash, but there `most` is 1.
            if ((most > 1)); then wait -n || status=1; else wait "$!" || status=1; fi
            running=$((running - 1))
        fi
        in_bevy test ${cargo[@]+"${cargo[@]}"} --test it -- "${files[@]/%/::}" "$@" 2>&1 | sed "s/^/${files[0]}| /" &
        running=$((running + 1))
    done 3< <(bevy_test_groups)
    while ((running > 0)); do
        if ((most > 1)); then wait -n || status=1; else wait "$!" || status=1; fi
        running=$((running - 1))
    done
    return "$status"
}

# in_bevy COMMAND...: runs cargo in its folder, with that Rust and its own target folder.
in_bevy() (
    cd "$root/$bevy_crate" || exit
    unset CARGO_TARGET_DIR
    rustup run "$(bevy_rust)" cargo "$@"
)
