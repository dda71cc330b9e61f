#!/usr/bin/env bash
#
# scripts/check_subjects.sh [BASE [HEAD]]: checks the first lines of the commits from BASE (main) to
# HEAD by the rules of CONTRIBUTING.md: at most 72 characters, no full stop, nothing unfinished.
# Reviewers check the imperative.

set -euo pipefail

# Characters, not bytes.
export LC_ALL=C.UTF-8

base=${1:-main} head=${2:-HEAD}
commits=$(git log --no-merges --format='%h %s' "$base..$head")
wrong=0

complain() {
    printf '%s: %s\n  %s\n' "$1" "$2" "$3" >&2
    wrong=1
}

while read -r commit subject; do
    if ((${#subject} > 72)); then complain "$commit" "the first line has ${#subject} characters, at most 72 are asked for" "$subject"; fi
    if [[ $subject == *. ]]; then complain "$commit" "the first line ends with a full stop" "$subject"; fi
    shopt -s nocasematch
    if [[ $subject =~ ^(wip([^[:alnum:]]|$)|fixup!|squash!|amend!) ]]; then
        complain "$commit" "the commit is unfinished by its own first line" "$subject"
    fi
    shopt -u nocasematch
done < <(if [[ -n $commits ]]; then printf '%s\n' "$commits"; fi)

exit "$wrong"
