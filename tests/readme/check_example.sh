#!/bin/sh
# check_example.sh README EXAMPLE: the program in the README, its first fenced block of C, is the file EXAMPLE, to the letter.
# Skipped (77) while there is no README or no program in it.
if [ ! -f "$1" ] || ! grep -q '^```c$' "$1"; then
    echo "skipped: $1 has no program in it"
    exit 77
fi
awk '/^```c$/ {on = 1; next} /^```$/ && on {exit} on' "$1" | diff - "$2" && echo "the README's program is $2"
