# shellcheck shell=bash
#
# Lumivox for Blender: its tests, in Blender as a Python module, with the extension of Python that
# build_python makes. Sourced by ./test after setup.sh and python.sh.

: "${root:?set root to the repository root before sourcing blender.sh}"

blender_extension=integrations/blender
# Blender as a module exists for one version of Python.
blender_python=3.11
blender_tools=(bpy==5.0.1 pytest==9.* OpenEXR==3.*)

# Sets `blender_base` to a Python of that version.
need_blender_python() {
    local known
    for known in "python$blender_python" python3; do
        if have "$known" && [[ $("$known" -c 'import sys; print("%d.%d" % sys.version_info[:2])') == "$blender_python" ]] &&
            "$known" -c 'import ensurepip, venv' 2>/dev/null; then
            blender_base=$known
            return 0
        fi
    done
    if install_debian_packages "Python $blender_python, which Blender runs in," "python$blender_python" "python$blender_python-venv" &&
        have "python$blender_python"; then
        blender_base=python$blender_python
        return 0
    fi
    die "Python $blender_python is missing: Blender 5.0 as a module runs in no other." \
        "Install it with its modules venv and ensurepip, or leave that part out: ./test --only PART"
}

# Libraries of X that Blender is linked with, though it opens no window.
need_blender_libraries() {
    on_linux || return 0
    local library missing=()
    while read -r library; do
        case $library in
        libXrender.so.1) missing+=(libxrender1) ;;
        libXxf86vm.so.1) missing+=(libxxf86vm1) ;;
        libXfixes.so.3) missing+=(libxfixes3) ;;
        libXi.so.6) missing+=(libxi6) ;;
        libxkbcommon.so.0) missing+=(libxkbcommon0) ;;
        libSM.so.6) missing+=(libsm6) ;;
        libICE.so.6) missing+=(libice6) ;;
        libGL.so.1) missing+=(libgl1) ;;
        libEGL.so.1) missing+=(libegl1) ;;
        esac
    done < <(ldd "$blender_env"/lib/python*/site-packages/bpy/__init__*.so 2>/dev/null | sed -n 's/^[[:space:]]*\([^ ]*\) => not found/\1/p')
    if ((${#missing[@]} == 0)); then return 0; fi
    install_debian_packages "Libraries that Blender is linked with" "${missing[@]}" ||
        die "Blender needs libraries that are missing: ${missing[*]} (names of Debian's packages)."
}

# Sets `blender_env`; made again if the tools change, or the Python that it was made with is gone.
need_blender_env() {
    : "${target_dir:?call set_target_dir first}"
    blender_env=$target_dir/tools/blender
    local list="${blender_tools[*]}"
    if [[ ! -f $blender_env/tools || $(<"$blender_env/tools") != "$list" ]] ||
        ! "$blender_env/bin/python" -c '' 2>/dev/null; then
        if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
            die "The environment of the tests in Blender is missing, and LUMIVOX_NO_INSTALL is set." \
                "Unset it: $blender_env is made with pip."
        fi
        say "Making $blender_env, with $list"
        rm -rf "$blender_env"
        "$blender_base" -m venv "$blender_env" >&2 || die "Python could not make $blender_env."
        "$blender_env/bin/pip" install --quiet --disable-pip-version-check "${blender_tools[@]}" >&2 ||
            die "pip could not install Blender and the tools of its tests."
        printf '%s\n' "$list" >"$blender_env/tools"
    fi
    need_blender_libraries
    "$blender_env/bin/python" -c 'import bpy' || die "Blender as a Python module does not start; the message is above."
}

run_blender_tests() (
    cd "$root/$blender_extension" || exit
    "$blender_env/bin/python" -m pytest -q -p no:cacheprovider --junit-xml="$LUMIVOX_TEST_TIMES/blender.xml" tests
)
