# shellcheck shell=bash
#
# Builds the page, for ./lumivox web and ./test. Sourced after setup.sh; the result is a folder of
# static files that any host can serve.
#
# The WASM target comes from rustup if possible, else from Debian's packages (rustc-web and its
# sources, from which the standard library is built).

: "${root:?set root to the repository root before sourcing web.sh}"

web_target=wasm32-unknown-unknown

# Sets `web_cargo` to a cargo that compiles for browsers, and `web_build_std` to its options.
find_web_cargo() {
    web_cargo=(cargo)
    local sysroot
    sysroot=$(cd "$root" && rustc --print sysroot 2>/dev/null) || sysroot=
    if [[ -d $sysroot/lib/rustlib/$web_target ]]; then return 0; fi
    if have rustup && [[ -z ${LUMIVOX_NO_INSTALL:-} ]]; then
        say "Rust's target for browsers is missing. Installing it: rustup target add $web_target"
        (cd "$root" && rustup target add "$web_target" >&2) && return 0
        say "rustup could not fetch it; trying Debian's packages."
    fi
    if [[ ! -d /usr/src || -z $(compgen -G '/usr/src/rustc-*/library/std/Cargo.toml') ]] ||
        [[ ! -x /usr/bin/cargo ]] || ! have wasm-ld-19; then
        install_debian_packages "Rust for browsers" rustc-web cargo-web rust-web-src lld-19 || true
    fi
    if [[ -n $(compgen -G '/usr/src/rustc-*/library/std/Cargo.toml') && -x /usr/bin/cargo ]] && have wasm-ld-19; then
        # Cargo finds the compiler on the PATH, where rustup's would come first.
        web_cargo=(env "PATH=/usr/bin:$PATH" RUSTC_BOOTSTRAP=1
            CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld-19 /usr/bin/cargo)
        web_build_std=(-Z "build-std=std,panic_abort")
        return 0
    fi
    die "Rust cannot compile for browsers here: its target $web_target is missing." \
        "With rustup: rustup target add $web_target" \
        "On Debian: apt-get install rustc-web cargo-web rust-web-src lld-19 (as root)"
}

# Builds the programs of lumivox-serve: one makes the page's module; the other, in `server`, serves
# the page. Debug builds are fast enough. Callers may set `web_tools` to cargo's arguments, for a
# build that includes them.
build_web_tools() {
    : "${target_dir:?call set_target_dir first}"
    local tools=(--locked -p lumivox-serve --features bindgen)
    if ((${#web_tools[@]} > 0)); then tools=("${web_tools[@]}"); fi
    (cd "$root" && show_build "Building the page's tools" cargo build "${tools[@]}") ||
        die "The build of the page's tools failed (cargo's message is above)."
    # shellcheck disable=SC2034 # for the caller of build_web
    server=$target_dir/debug/lumivox-serve
}

web_tools=()

# build_web FOLDER [PROFILE]: builds the page, with the npm package in its folder `lumivox`, in
# Cargo's profile `web`, or in `web-test`, which compiles faster. Sets `server` to the program that
# serves it.
build_web() {
    local out=${1%/} profile=${2:-web} web_cargo=() web_build_std=() staging
    # Replace only an older page, never other files.
    if [[ -e $out && ! -e $out/lumivox/lumivox_bg.wasm && -n $(ls -A -- "$out") ]]; then
        die "$out is there, and is no page of Lumivox: it would be replaced." \
            "Choose a folder that is empty or not there yet."
    fi
    find_web_cargo
    build_web_tools
    (cd "$root" && show_build "Building the page" "${web_cargo[@]}" build ${web_build_std[@]+"${web_build_std[@]}"} \
        --target "$web_target" --profile "$profile" --locked -p lumivox-web -p lumivox-three --target-dir "$target_dir/web") ||
        die "The build for browsers failed (cargo's message is above)."
    # Staged, so that the old page stays until the new one is whole.
    mkdir -p "$out"
    staging=$(mktemp -d "$out.XXXXXX")
    cp -R "$root/crates/lumivox-web/page/." "$staging/"
    cp -R "$root/docs/generated/images/gallery" "$staging/"
    make_module lumivox_web lumivox "$staging/lumivox"
    make_module lumivox_three lumivox_three "$staging/lumivox/three"
    cp -R "$root/crates/lumivox-web/npm/." "$staging/lumivox/"
    cp -R "$root/crates/lumivox-three/js/." "$staging/lumivox/three/"
    make_inlined "$staging/lumivox"
    cp "$root/LICENSE-MIT" "$root/LICENSE-APACHE" "$staging/lumivox/"
    rm -rf "$out"
    mv "$staging" "$out"
    chmod 755 "$out"
    print_web_size "$out/lumivox/lumivox_bg.wasm"
    print_web_size "$out/lumivox/three/lumivox_three_bg.wasm"
}

# make_module CRATE NAME FOLDER [OPTION]: makes a crate's module; needs build_web's variables.
make_module() {
    mkdir -p "$3"
    "$target_dir/debug/lumivox-bindgen" "$target_dir/web/$web_target/$profile/$1.wasm" "$3" --name "$2" "${@:4}" ||
        die "The module $2 could not be made (the message is above)."
}

# make_inlined PACKAGE: makes the module `lumivox/inlined`, which contains its WebAssembly,
# compressed; it needs no support from bundlers.
make_inlined() {
    make_module lumivox_web lumivox "$1/inlined" --no-default-path
    {
        cat "$root/crates/lumivox-web/npm/inlined.js"
        printf '\nconst packed = "'
        gzip -9 -n -c "$1/inlined/lumivox_bg.wasm" | base64 | tr -d '\n'
        printf '";\n'
    } >"$1/inlined.js.new"
    mv "$1/inlined.js.new" "$1/inlined.js"
    rm -f "$1/inlined/lumivox_bg.wasm" "$1/inlined/lumivox_bg.wasm.d.ts"
}

# Prints the download size.
print_web_size() {
    local bytes packed
    bytes=$(wc -c <"$1")
    packed=$(gzip -9 -c "$1" | wc -c)
    say "$(awk -v a="$bytes" -v b="$packed" -v name="$(basename "$1")" 'BEGIN {
        printf name ": %.2f MB; %.2f MB as servers send it with gzip.", a / 1e6, b / 1e6 }')"
}

# Sets `chromium` to the browser that tests the page; fails without it or Node.js.
need_browser() {
    local name
    for name in "${CHROMIUM:-}" chromium chromium-browser google-chrome google-chrome-stable; do
        if [[ -n $name ]] && have "$name"; then chromium=$(command -v "$name") && break; fi
    done
    if [[ -z ${chromium:-} ]]; then
        install_debian_packages "Chromium, which tests the page," chromium || return 1
        chromium=$(command -v chromium) || return 1
    fi
    have npm || install_debian_packages "Node.js, which drives the browser," nodejs npm || return 1
    # Its runner accepts lists of files since version 20.
    version_at_least "$(node --version | tr -d v)" 20
}
