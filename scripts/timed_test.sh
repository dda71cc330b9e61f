#!/usr/bin/env bash
#
# scripts/timed_test.sh PROGRAM [ARGUMENT]...: runs a test program. ./test makes it cargo's runner.
# It prints the seconds of each test, and writes all output into the folder LUMIVOX_TEST_TIMES for
# scripts/slowest_tests.py.

set -euo pipefail

# Doc test programs are in another folder and take no options. They start each test as a process, by
# the path in this variable, which rustdoc does not set if there is a runner.
if [[ $1 != */deps/* ]]; then RUSTDOC_DOCTEST_BIN_PATH=$1 exec "$@"; fi

colour=never
if [[ -t 1 ]]; then colour=always; fi
name=${1##*/}
log=$LUMIVOX_TEST_TIMES/$$.libtest
# Cargo runs tests in the crate's folder.
printf '# %s %s\n' "${PWD##*/}" "${name%-*}" >"$log"
# Stable test programs accept --report-time, too, if this variable is set as they run. It is not set
# for Cargo, which would compile dependencies again.
RUSTC_BOOTSTRAP=1 "$@" --color "$colour" -Z unstable-options --report-time | tee -a "$log"
