# shellcheck shell=bash
#
# The Python package: its tests, in an environment of their own, with the extension of a debug
# build. Sourced by ./test after setup.sh and set_target_dir; the times of tests go to the folder
# LUMIVOX_TEST_TIMES.

: "${root:?set root to the repository root before sourcing python.sh}"

python_package=crates/lumivox-python
# Packages that the tests need besides this one.
python_tools=(numpy==2.* pytest==9.* mypy==2.* trimesh==5.* ray==2.* mitsuba==3.*
    nbclient==0.* nbformat==5.* ipykernel==7.* matplotlib==3.*)
# PyVista needs VTK, which is larger than all other packages.
if [[ -n ${LUMIVOX_RELEASE:-} ]]; then python_tools+=(pyvista==0.*); fi

# Python with the module venv, which is a separate package on Debian and Ubuntu.
need_python() {
    need_package_for python3 "Python 3, for its package," python3 python3-venv
    python3 -c 'import ensurepip, venv' 2>/dev/null && return 0
    if install_debian_packages "Python's environments" python3-venv &&
        python3 -c 'import ensurepip, venv' 2>/dev/null; then return 0; fi
    die "Python cannot make environments." "Install its modules venv and ensurepip (on Debian and Ubuntu: apt install python3-venv)."
}

# Sets `python_env`; made again if the tools change.
need_python_env() {
    : "${target_dir:?call set_target_dir first}"
    python_env=$target_dir/tools/python
    local list="${python_tools[*]}"
    [[ -f $python_env/tools && $(<"$python_env/tools") == "$list" ]] && return 0
    if [[ -n ${LUMIVOX_NO_INSTALL:-} ]]; then
        die "The environment of the Python tests is missing, and LUMIVOX_NO_INSTALL is set." \
            "Unset it: $python_env is made with pip."
    fi
    say "Making $python_env, with $list"
    rm -rf "$python_env"
    python3 -m venv "$python_env" >&2 || die "Python could not make $python_env."
    "$python_env/bin/pip" install --quiet --disable-pip-version-check "${python_tools[@]}" >&2 ||
        die "pip could not install the tools of the Python tests."
    printf '%s\n' "$list" >"$python_env/tools"
}

# build_python OPTIONS...: builds the extension with cargo's options, and puts it into the package.
build_python() {
    cargo build "$@"
    local built=$target_dir/debug/lib_lumivox.so
    on_linux || built=$target_dir/debug/lib_lumivox.dylib
    cp "$built" "$root/$python_package/python/lumivox/_lumivox.abi3.so"
}

check_python_types() (cd "$root/$python_package" && "$python_env/bin/mypy")

run_python_tests() (
    cd "$root/$python_package" || exit
    export PYTHONPATH=$PWD/python
    "$python_env/bin/python" -m pytest -q -p no:cacheprovider --junit-xml="$LUMIVOX_TEST_TIMES/python.xml"
)
