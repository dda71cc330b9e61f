# shellcheck shell=bash
#
# Building the page: ./lumivox web and ./test use it. Sourced after setup.sh; the result is a folder
# of static files that any host can serve.
#
# The WASM target comes from rustup where rustup can fetch it, else from Debian's packages
# (rustc-web and its sources, of which the standard library is built as well).

: "${root:?set root to the repository root before sourcing web.sh}"

web_target=wasm32-unknown-unknown

# The cargo that compiles for browsers, and what it needs besides, in `web_cargo`.
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
        # Cargo finds the compiler on the PATH, and rustup's would come first.
        web_cargo=(env "PATH=/usr/bin:$PATH" RUSTC_BOOTSTRAP=1
            CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld-19 /usr/bin/cargo)
        web_build_std=(-Z "build-std=std,panic_abort")
        return 0
    fi
    die "Rust cannot compile for browsers here: its target $web_target is missing." \
        "With rustup: rustup target add $web_target" \
        "On Debian: apt-get install rustc-web cargo-web rust-web-src lld-19 (as root)"
}

# The version of a crate in the lock file.
locked_version() { sed -n "/^name = \"$1\"\$/{n;s/^version = \"\(.*\)\"\$/\1/p;q;}" "$root/Cargo.lock"; }

# wasm-bindgen's program must be of the very version of its library.
need_wasm_bindgen() {
    local version
    version=$(locked_version wasm-bindgen)
    : "${target_dir:?call set_target_dir first}"
    wasm_bindgen=$target_dir/tools/wasm-bindgen-$version/bin/wasm-bindgen
    [[ -x $wasm_bindgen ]] && return 0
    if have wasm-bindgen && [[ $(wasm-bindgen --version) == "wasm-bindgen $version" ]]; then
        wasm_bindgen=wasm-bindgen
        return 0
    fi
    if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
        die "wasm-bindgen $version is missing." "Install it: cargo install wasm-bindgen-cli --version $version"
    fi
    say "wasm-bindgen $version is missing. Installing it: cargo install wasm-bindgen-cli --version $version"
    (cd "$root" && cargo install --quiet wasm-bindgen-cli --version "$version" \
        --root "$target_dir/tools/wasm-bindgen-$version" --target-dir "$target_dir/tools/build" >&2) ||
        die "wasm-bindgen $version could not be installed (cargo's message is above)."
}

# build_web FOLDER: the page, with the npm package in its folder `lumivox`.
build_web() {
    local out=${1%/} web_cargo=() web_build_std=() wasm_bindgen staging
    # Only an older page is replaced: nothing of anybody's is lost.
    if [[ -e $out && ! -e $out/lumivox/lumivox_bg.wasm && -n $(ls -A -- "$out") ]]; then
        die "$out is there, and is no page of Lumivox: it would be replaced." \
            "Choose a folder that is empty or not there yet."
    fi
    find_web_cargo
    need_wasm_bindgen
    say "Compiling for browsers; the first time takes minutes."
    (cd "$root" && "${web_cargo[@]}" build ${web_build_std[@]+"${web_build_std[@]}"} --target "$web_target" \
        --profile web --locked -p lumivox-web --target-dir "$target_dir/web" >&2) ||
        die "The build for browsers failed (cargo's message is above)."
    # Whole or not at all: who looks meanwhile finds the old page.
    mkdir -p "$out"
    staging=$(mktemp -d "$out.XXXXXX")
    cp -R "$root/crates/lumivox-web/page/." "$staging/"
    mkdir -p "$staging/lumivox"
    "$wasm_bindgen" "$target_dir/web/$web_target/web/lumivox_web.wasm" --target web --out-name lumivox \
        --remove-name-section --remove-producers-section --out-dir "$staging/lumivox" || die "wasm-bindgen failed (its message is above)."
    cp -R "$root/crates/lumivox-web/npm/." "$staging/lumivox/"
    cp "$root/LICENSE-MIT" "$root/LICENSE-APACHE" "$staging/lumivox/"
    rm -rf "$out"
    mv "$staging" "$out"
    chmod 755 "$out"
    print_web_size "$out/lumivox/lumivox_bg.wasm"
}

# What a browser downloads.
print_web_size() {
    local bytes packed
    bytes=$(wc -c <"$1")
    packed=$(gzip -9 -c "$1" | wc -c)
    say "$(awk -v a="$bytes" -v b="$packed" 'BEGIN {
        printf "WASM: %.2f MB; %.2f MB as servers send it with gzip.", a / 1e6, b / 1e6 }')"
}

# The browser that the page is tested in, in `chromium`, and Node.js to drive it; fails without them.
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
    # Its runner takes lists of files from 20 on.
    version_at_least "$(node --version | tr -d v)" 20
}
