#!/usr/bin/env bash
# The library compiles for the MSP430: check.sh SOURCES INCLUDE... Compiled only: no package has a C library or the arithmetic's routines for it.
set -euo pipefail
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
sources=$1
shift
includes=()
for include; do
    includes+=(-isystem "$include")
done
object=$(mktemp)
trap 'rm -f "$object"' EXIT
count=0
while read -r source; do
    clang --target=msp430 -std=c99 -O1 -ffreestanding -Wall -Wextra -Werror -I"$folder/include" "${includes[@]}" -c "$source" -o "$object"
    count=$((count + 1))
done < <(find "$sources" -name '*.c' | sort)
[[ $count -gt 50 ]] || { echo "only $count sources in $sources" >&2; exit 1; }
echo "$count sources compile for the MSP430"
