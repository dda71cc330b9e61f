#!/usr/bin/env bash
#
# scripts/repeat_test.sh: runs tests many times in parallel, to find rare failures on busy cores.

set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

usage() {
    cat <<'TEXT'
Usage: scripts/repeat_test.sh [--times N] [--beside N] [--out FOLDER] [CARGO OPTIONS] [NAME...]

Builds tests once, and runs them N times, some runs beside each other, so that they load all cores. Says how many runs passed,
and exits with 1 if one failed. It works in the current folder's workspace: for Lumivox for Bevy, call it in integrations/bevy.

  --times N       the number of runs [default: 200]
  --beside N      the number of runs beside each other [default: two for each core]
  --out FOLDER    the folder for what failed runs have said [default: repeated-tests in the target folder]
  CARGO OPTIONS   as for 'cargo test': -p, --features, --test, --lib, --release, --locked and so on
  NAME            a part of the tests' names; without one, all tests of the packages run, ignored ones, too
  -h, --help      show this text

Example:
  scripts/repeat_test.sh --times 200 -p lumivox-classics locks::moves::moves_within_frames_give_equal_bits_with_both_builders
TEXT
}

times=200 beside=$((2 * $(getconf _NPROCESSORS_ONLN))) out='' options=() names=()
while (($# > 0)); do
    case $1 in
    --times) times=${2:?--times needs a number} && shift ;;
    --beside) beside=${2:?--beside needs a number} && shift ;;
    --out) out=${2:?--out needs a folder} && shift ;;
    -p | --package | -F | --features | --test | --bin | --profile) options+=("$1" "${2:?$1 needs a value}") && shift ;;
    -h | --help) usage && exit ;;
    -*) options+=("$1") ;;
    *) names+=("$1") ;;
    esac
    shift
done
[[ $times =~ ^[1-9][0-9]*$ ]] || die "--times is '$times', but must be a whole number of at least 1."
[[ $beside =~ ^[1-9][0-9]*$ ]] || die "--beside is '$beside', but must be a whole number of at least 1."

if on_linux && [[ -z ${LUMIVOX_TEST_ANY_ADAPTER:-} ]] && manifest=$(unset VK_DRIVER_FILES VK_ICD_FILENAMES && software_manifest); then
    export VK_DRIVER_FILES=$manifest VK_ICD_FILENAMES=$manifest
fi

which=(--include-ignored ${names[@]+"${names[@]}"})

# A line for each test program: the folder of its package, and its file.
built=$(cargo test --no-run --message-format=json-render-diagnostics ${options[@]+"${options[@]}"} |
    sed -nE 's|.*"manifest_path":"([^"]*)/Cargo.toml".*"test":true\}.*"executable":"([^"]+)".*|\1\t\2|p')
programs=()
while IFS=$'\t' read -r folder program; do
    if [[ -n $program && $("$program" --list "${which[@]}") == *': test'* ]]; then
        programs+=("$folder" "$program")
        out=${out:-$(dirname -- "$(dirname -- "$(dirname -- "$program")")")/repeated-tests}
    fi
done <<<"$built"
((${#programs[@]} > 0)) || die "No test has such a name: ${names[*]-}"
mkdir -p "$out"
out=$(readlink -f -- "$out")

results=$out/results
: >"$results"
trap 'rm -f "$results" "$out"/running-*.log' EXIT
# The runs end with this script: background jobs ignore Ctrl+C.
trap 'trap - TERM; kill -TERM 0' INT TERM

count() { grep -c "^$1$" "$results" || true; }

# Runs the programs once. Their output is kept if one fails.
run_once() {
    local log=$out/running-$1.log result=passed
    for ((i = 0; i < ${#programs[@]}; i += 2)); do
        (cd "${programs[i]}" && "${programs[i + 1]}" "${which[@]}") || result=failed
    done >"$log" 2>&1
    echo "$result" >>"$results"
    if [[ $result == failed ]]; then
        mv "$log" "$out/run-$1.log"
        say "run $1 failed: $out/run-$1.log"
    fi
    say "$(count passed) passed, $(count failed) failed of $times, $SECONDS s"
}

for ((place = 1; place <= beside; place++)); do
    for ((run = place; run <= times; run += beside)); do run_once "$run"; done &
done
wait
printf '%s passed, %s failed\n' "$(count passed)" "$(count failed)"
(($(count failed) == 0))
