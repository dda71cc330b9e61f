#!/usr/bin/env bash
#
# scripts/timed_test.sh PROGRAM [ARGUMENT]...: runs a test program. ./test makes it cargo's runner, so that each test is printed
# with its seconds, and leaves what is printed in the folder LUMIVOX_TEST_TIMES for scripts/slowest_tests.py.

set -euo pipefail

# Programs of doc tests are in another folder and take no options. Each of their tests is a process that they start by their
# own path; with a runner, rustdoc does not set the variable for it.
if [[ $1 != */deps/* ]]; then RUSTDOC_DOCTEST_BIN_PATH=$1 exec "$@"; fi

colour=never
if [[ -t 1 ]]; then colour=always; fi
name=${1##*/}
log=$LUMIVOX_TEST_TIMES/$$.libtest
# The folder is that of the crate.
printf '# %s %s\n' "${PWD##*/}" "${name%-*}" >"$log"
# Stable test programs have the option --report-time too, and ask for this variable as they run. Cargo does not see it: it would
# compile dependencies again.
RUSTC_BOOTSTRAP=1 "$@" --color "$colour" -Z unstable-options --report-time | tee -a "$log"
