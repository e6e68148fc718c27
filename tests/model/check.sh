#!/usr/bin/env bash
# Checks prince.pml: that it holds with all guards, and that what each of three guards is for is found out when it is missing.
#
#   tests/model/check.sh FOLDER [losses]     works in FOLDER; at most `losses` (1) receptions fail
set -euo pipefail
model=$(cd "$(dirname "$0")" && pwd)/prince.pml
folder=$1
losses=${2:-1}

command -v spin >/dev/null || { echo "skipped: spin is not installed (tools/setup test)"; exit 77; }

# explore NAME DEFINITION...: prints what the verifier says
explore() {
    rm -rf "${folder:?}/$1"
    mkdir -p "$folder/$1"
    (
        cd "$folder/$1"
        shift
        spin "$@" -a "$model"
        "${CC:-gcc}" -std=gnu99 -w -O1 -DSAFETY -DHC4 -DMEMLIM=2000 -o pan pan.c
        ./pan -m400000 -n
    )
}

failed=0
said=$(explore holds -DLOSSES="$losses")
states=$(sed -n 's/^ *\([0-9.e+]*\) states, stored.*/\1/p' <<<"$said")
if grep -q 'errors: 0' <<<"$said" && ! grep -Eq 'max search depth too small|Search not completed|out of memory' <<<"$said"; then
    echo "holds with $losses lost receptions: $states states"
else
    printf 'fails with %s lost receptions, in %s/holds:\n%s\n' "$losses" "$folder" "$said"
    failed=1
fi

while read -r guard needs; do
    said=$(explore "no_$guard" -DLOSSES="$needs" -DNO_"$guard")
    if grep -q 'assertion violated' <<<"$said"; then
        echo "without $guard: $(sed -n 's/.*assertion violated \(.*\) (at depth.*/\1/p' <<<"$said") does not hold, with $needs lost receptions"
    else
        printf 'without %s nothing is wrong:\n%s\n' "$guard" "$said"
        failed=1
    fi
done <<'GUARDS'
WATCHDOG 0
RELAY 2
LINGER 2
GUARDS
exit $failed
