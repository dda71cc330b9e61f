# shellcheck shell=bash
#
# Checks what ./lumivox and ./test need from the machine.
# Sourced, with `root` set to the repository root; runs in bash 3.2 and later.
#
# Each `need_*` function returns if the thing is available. If it is missing, the function installs
# it if that needs no decision of yours (distribution packages on Debian and Ubuntu), with a message
# first; otherwise it stops and says what to do. All of its messages go to stderr.
#
# Environment:
#   LUMIVOX_NO_INSTALL=1         install nothing: only name what is missing
#   LUMIVOX_SKIP_DRIVER_CHECK=1  go on without looking for a Vulkan driver

: "${root:?set root to the repository root before sourcing setup.sh}"

# If stderr is closed, continue without messages.
if ! true >&2; then exec 2>/dev/null; fi
say() { printf '%s\n' "$*" >&2 || true; }

die() {
    say "error: $1"
    shift
    local line
    for line in "$@"; do say "       $line"; done
    exit 1
}

have() { command -v "$1" >/dev/null 2>&1; }

on_linux() { [[ $(uname -s) == Linux ]]; }

# --- packages ---------------------------------------------------------------------------------

# Sets `as_root` to the prefix that runs apt-get as root; fails if there is none.
find_root_rights() {
    as_root=()
    [[ $(id -u) -eq 0 ]] && return 0
    have sudo || return 1
    as_root=(sudo)
    # Without a terminal no password can be typed, so sudo must work without one.
    if [[ ! -t 0 ]]; then
        as_root=(sudo -n)
        sudo -n true 2>/dev/null || return 1
    fi
}

package_lists_are_fresh=

# install_debian_packages WHAT PACKAGE...: fails if it cannot install; says why if apt-get exists.
install_debian_packages() {
    local what=$1 as_root
    shift
    have apt-get || return 1
    if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
        say "$what is missing, and LUMIVOX_NO_INSTALL is set: installing nothing."
        return 1
    fi
    if ! find_root_rights; then
        say "$what is missing, and installing it takes root or a sudo that asks for no password."
        return 1
    fi
    # `${a[@]+...}`: an empty array counts as unset in bash before 4.4.
    local apt=(${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive
        apt-get -qq -o DPkg::Lock::Timeout=120 -o Dpkg::Use-Pty=0)
    say "$what is missing. Installing $*:"
    say "  ${as_root[*]+${as_root[*]} }apt-get update && apt-get install --no-install-recommends $*"
    if [[ -z $package_lists_are_fresh ]]; then
        # A broken third-party source must not stop installation from the others.
        "${apt[@]}" update >&2 </dev/null ||
            say "warning: apt-get update failed; trying to install anyway"
        package_lists_are_fresh=1
    fi
    "${apt[@]}" install -y --no-install-recommends "$@" >&2 </dev/null
}

# need_package_for COMMAND WHAT PACKAGE...: a command that a Debian package provides.
need_package_for() {
    local command=$1 what=$2
    shift 2
    have "$command" && return 0
    if install_debian_packages "$what" "$@" && have "$command"; then return 0; fi
    local advice="Install it with your system's package manager."
    if have apt-get; then
        advice="Install it: apt-get install $* (as root)"
    elif [[ $(uname -s) == Darwin ]]; then
        advice="Install Apple's command line tools: xcode-select --install"
    fi
    die "$what is missing: there is no '$command' on the PATH." "$advice"
}

# --- Rust and compilers -----------------------------------------------------------------------

# Whether version $1 is at least version $2, numbers separated by dots.
version_at_least() {
    local IFS=. i
    # shellcheck disable=SC2206 # splitting at the dots is the point
    local have_parts=($1) want_parts=($2)
    for ((i = 0; i < ${#want_parts[@]}; i++)); do
        local h=${have_parts[i]:-0} w=${want_parts[i]}
        ((10#$h > 10#$w)) && return 0
        ((10#$h < 10#$w)) && return 1
    done
    return 0
}

need_rust() {
    # rustup's directory is on the PATH only of shells that started after it was installed.
    local cargo_bin=${CARGO_HOME:-${HOME:-}/.cargo}/bin
    if ! have cargo && [[ -x $cargo_bin/cargo ]]; then PATH=$cargo_bin:$PATH; fi

    local wanted found
    wanted=$(sed -n 's/^rust-version *= *"\([0-9.]*\)".*/\1/p' "$root/Cargo.toml")
    have cargo || die "Rust is missing: there is no 'cargo' on the PATH." \
        "Lumivox needs Rust $wanted or newer. Install it from https://rustup.rs:" \
        "  curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh" \
        "then run this command again."

    if ! found=$(cd "$root" && cargo --version); then
        die "'cargo --version' failed (its message is above)." \
            "If rustup has no toolchain yet: rustup default stable"
    fi
    found=${found#cargo }
    found=${found%%[!0-9.]*}
    version_at_least "$found" "$wanted" && return 0
    if have rustup; then
        die "Lumivox needs Rust $wanted or newer; this is $found." "Update it: rustup update stable"
    fi
    die "Lumivox needs Rust $wanted or newer; this is $found, and rustup does not manage it." \
        "Install a newer one from https://rustup.rs, and let its cargo come first on the PATH."
}

# need_rust_component COMPONENT SUBCOMMAND: a part that rustup's minimal profile leaves out.
need_rust_component() {
    local component=$1 subcommand=$2
    (cd "$root" && cargo "$subcommand" --version >/dev/null 2>&1) && return 0
    if have rustup && [[ -z ${LUMIVOX_NO_INSTALL:-} ]]; then
        say "'cargo $subcommand' is missing. Installing it: rustup component add $component"
        (cd "$root" && rustup component add "$component" >&2) && return 0
    fi
    die "'cargo $subcommand' is missing." "With rustup: rustup component add $component" \
        "Otherwise install your distribution's package of $component."
}

# On Windows, cargo finds Microsoft's or MinGW's linker by itself.
on_windows() { case $(uname -s) in MINGW* | MSYS* | CYGWIN*) ;; *) return 1 ;; esac }

need_linker() { on_windows || need_package_for cc "A C linker, which Rust needs," gcc libc6-dev; }

need_cxx_compiler() { on_windows || need_package_for c++ "A C++ compiler" g++; }

# Sets `target_dir` to cargo's target folder. A relative CARGO_TARGET_DIR is relative to the
# caller's directory, as for cargo, so it becomes absolute before anything changes directory.
# Exported, so that a `target-dir` in the user's cargo settings has no effect.
set_target_dir() {
    target_dir=${CARGO_TARGET_DIR:-$root/target}
    case $target_dir in
    /* | [A-Za-z]:*) ;;
    *) target_dir=$PWD/$target_dir ;;
    esac
    export CARGO_TARGET_DIR=$target_dir
}

# --- building ---------------------------------------------------------------------------------

# show_build TITLE CARGO...: runs a cargo build, and shows its progress on stderr: crates done and
# in total, elapsed time, and about how long the rest takes. On a terminal one line is redrawn; a
# log gets a line every 20 seconds. Cargo's warnings and errors are shown as they come. A build with
# nothing to do prints nothing.
show_build() {
    local title=$1 colour=never
    shift
    if [[ -t 2 ]]; then colour=always; fi
    # Makes cargo write its progress even to a pipe; read_progress reads the numbers from it.
    CARGO_TERM_PROGRESS_WHEN=always CARGO_TERM_PROGRESS_WIDTH=120 CARGO_TERM_COLOR=$colour "$@" 2>&1 >/dev/null |
        read_progress "$title" >&2
}

# Cargo ends each state of its progress by a carriage return, and each message by a line feed.
read_progress() {
    local title=$1 start=$SECONDS first='' next=0 is_built='' chunk line escape=$'\e'
    local status="^ *$escape*[^ ]* *(Adding|Blocking|Building|Checking|Compiling|Documenting|Downloaded|Downloading|Finished|Fresh|Installed|Installing|Locking|Replacing|Updating|Upgrading)"
    local numbers='\] ([0-9]+)/([0-9]+)'
    while IFS= read -r -d $'\r' chunk || [[ -n $chunk ]]; do
        while IFS= read -r line; do
            line=${line#"${escape}[K"}
            if [[ $line =~ $numbers ]]; then
                print_progress "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
            elif [[ $line =~ $status ]]; then
                if [[ $line == *Finished* ]]; then is_built=1; fi
            elif [[ -n ${line// /} ]]; then
                erase_progress
                tell '%s\n' "$line"
            fi
        done <<<"$chunk"
    done
    erase_progress
    if [[ -n $first && -n $is_built ]]; then tell '%s: done in %s.\n' "$title" "$(clock $((SECONDS - start)))"; fi
}

# printf that ignores write errors.
tell() {
    # shellcheck disable=SC2059 # the format is the caller's
    printf "$@" || true
}

erase_progress() { if [[ -t 2 ]]; then tell '\r\e[K'; fi; }

# print_progress DONE TOTAL: one line of `read_progress`, whose variables it uses.
print_progress() {
    local done=$1 total=$2 now=$((SECONDS - start)) left=''
    if [[ -z $first ]]; then
        first=$done
        tell '%s (crates to build: %s).\n' "$title" "$((total - done))"
    fi
    # Small crates come first and the largest last: time grows about as the square of the share.
    local share=$((1000 * (done - first) / (total - first + 1)))
    if ((now >= 10 && share >= 100)); then
        left=$((now * 1000000 / (share * share) - now))
        left=", about $(clock "$left") left"
    fi
    if [[ -t 2 ]]; then
        tell '\r\e[K%s: %s of %s crates, %s%s' "$title" "$done" "$total" "$(clock "$now")" "$left"
    elif ((now >= next)); then
        if ((now > 0)); then tell '%s: %s of %s crates, %s%s\n' "$title" "$done" "$total" "$(clock "$now")" "$left"; fi
        next=$((now + 20))
    fi
}

# clock SECONDS: m:ss.
clock() { printf '%d:%02d' "$(($1 / 60))" "$(($1 % 60))"; }

# --- Vulkan (Linux only: macOS has Metal, Windows has DirectX 12) -------------------------------

# The driver manifests that the Vulkan loader would read, one path a line. The order of places is
# that of "Driver Discovery on Linux" in the Vulkan loader's LoaderDriverInterface document.
vulkan_manifests() {
    local chosen=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}} places=() place file folder
    local data_dirs=${XDG_DATA_DIRS:-/usr/local/share:/usr/share}
    local config_dirs=${XDG_CONFIG_DIRS:-/etc/xdg}
    if [[ -n $chosen ]]; then
        IFS=: read -r -a places <<<"$chosen"
    else
        local parents=()
        IFS=: read -r -a parents <<<"${XDG_CONFIG_HOME:-${HOME:-}/.config}:$config_dirs:/etc:${XDG_DATA_HOME:-${HOME:-}/.local/share}:$data_dirs:/run/opengl-driver/share"
        IFS=: read -r -a places <<<"${VK_ADD_DRIVER_FILES:-}"
        for folder in "${parents[@]}"; do places+=("$folder/vulkan/icd.d"); done
    fi
    for place in "${places[@]}"; do
        if [[ -d $place ]]; then
            for file in "$place"/*.json; do [[ -f $file ]] && printf '%s\n' "$file"; done
        elif [[ -f $place ]]; then
            printf '%s\n' "$place"
        fi
    done
    return 0
}

# The manifest of Mesa's software driver (lavapipe) for this processor; fails without one.
software_manifest() {
    local file found=
    while read -r file; do
        case ${file##*/} in
        lvp_icd."$(uname -m)".json | lvp_icd.json)
            printf '%s\n' "$file"
            return 0
            ;;
        # Distributions name processors differently: fall back to the first.
        lvp_icd.*.json) [[ -n $found ]] || found=$file ;;
        esac
    done < <(vulkan_manifests)
    [[ -n $found ]] && printf '%s\n' "$found"
}

# One driver for everyone makes results comparable, and it needs no GPU.
pin_software_driver() {
    local manifest
    manifest=$(unset VK_DRIVER_FILES VK_ICD_FILENAMES && software_manifest) || return 1
    # Loaders before 1.3.207 know only the second name.
    export VK_DRIVER_FILES=$manifest VK_ICD_FILENAMES=$manifest
    # shellcheck disable=SC2034 # for the caller
    pinned="VK_DRIVER_FILES=$manifest "
}

have_vulkan_loader() {
    local cache file
    # Debian keeps ldconfig off the PATH of ordinary users.
    cache=$(PATH=$PATH:/usr/sbin:/sbin ldconfig -p 2>/dev/null) || cache=
    [[ $cache == *libvulkan.so.1* ]] && return 0
    local folders=()
    IFS=: read -r -a folders <<<"${LD_LIBRARY_PATH:-}:/usr/lib:/usr/lib64:/usr/local/lib"
    for file in "${folders[@]/%//libvulkan.so.1}"; do [[ -e $file ]] && return 0; done
    return 1
}

# Whether one of the device nodes exists and may be opened by this user.
can_open_any() {
    local node
    for node in "$@"; do [[ -r $node && -w $node ]] && return 0; done
    return 1
}

# Whether there is a Vulkan device to run on. A driver does not prove one: a desktop's package
# installs Intel's and AMD's drivers on every machine.
have_vulkan_device() {
    local file summary
    have_vulkan_loader || return 1
    # Prefer the answer of the loader's own tool, if it is installed.
    if have vulkaninfo; then
        summary=$(timeout 30 vulkaninfo --summary 2>/dev/null </dev/null) || true
        [[ $summary == *deviceName* ]]
        return
    fi
    while read -r file; do
        case ${file##*/} in
        lvp_icd*.json | *swiftshader*.json) return 0 ;;
        nvidia*.json) can_open_any /dev/nvidia[0-9]* && return 0 ;;
        dzn_icd*.json) can_open_any /dev/dxg && return 0 ;;
        *) can_open_any /dev/dri/renderD* && return 0 ;;
        esac
    done < <(vulkan_manifests)
    return 1
}

need_vulkan_device() {
    on_linux || return 0
    # Without a desktop, Mesa's layer that asks it for its favourite GPU makes libwayland print a
    # harmless "error:".
    if [[ -z ${XDG_RUNTIME_DIR:-} ]]; then export NODEVICE_SELECT=1; fi
    [[ -n ${LUMIVOX_SKIP_DRIVER_CHECK:-} ]] && return 0
    have_vulkan_device && return 0

    local chosen=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}
    if [[ -n $chosen ]] && (unset VK_DRIVER_FILES VK_ICD_FILENAMES && have_vulkan_device); then
        die "No Vulkan driver works among those that VK_DRIVER_FILES (or VK_ICD_FILENAMES) names:" \
            "  $chosen" "Without that variable one does: unset it, or correct the path."
    fi
    # Mesa's package contains the software driver as well, which needs no graphics hardware.
    if install_debian_packages "A Vulkan driver" mesa-vulkan-drivers libvulkan1; then
        have_vulkan_device && return 0
        [[ -n $chosen ]] && die "A Vulkan driver is installed, but VK_DRIVER_FILES (or" \
            "VK_ICD_FILENAMES) names others: $chosen" "Unset it, or correct the path."
    fi
    die "There is no Vulkan device: a driver is missing, or its hardware is." \
        "Install your GPU's Vulkan driver, or Mesa's software driver, which needs no GPU:" \
        "  Debian, Ubuntu:  sudo apt-get install mesa-vulkan-drivers libvulkan1" \
        "  Fedora:          sudo dnf install mesa-vulkan-drivers vulkan-loader" \
        "  Arch:            sudo pacman -S vulkan-swrast vulkan-icd-loader" \
        "  openSUSE:        sudo zypper install libvulkan_lvp libvulkan1" \
        "  Alpine:          apk add mesa-vulkan-swrast vulkan-loader" \
        "If a driver is there and this check is wrong, set LUMIVOX_SKIP_DRIVER_CHECK=1."
}
