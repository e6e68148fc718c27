#!/bin/sh
# follow.sh SOURCE FOLDER HEADING PATTERN COUNT: does in FOLDER what the README says below "### HEADING", its blocks of shell commands; COUNT lines of
# what comes out match PATTERN. Skipped (77) where a compiler or emulator that they name is absent.
set -eu
source=$1 folder=$2 heading=$3
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
ln -s "$source" motehound
awk -v heading="### $heading" '/^##/ {here = $0 == heading} here && /^```sh$/ {on = 1; next} /^```$/ {on = 0} on' motehound/README.md >commands
test -s commands || { echo "the README has no commands below $heading"; exit 1; }
for tool in arm-none-eabi-gcc qemu-system-arm; do
    if grep -q cortex commands && ! command -v $tool >/dev/null; then
        echo "skipped: no $tool here"
        exit 77
    fi
done
unset CFLAGS LDFLAGS CC
HOME=$PWD CMAKE_BUILD_PARALLEL_LEVEL=2 CMAKE_GENERATOR=Ninja sh -eu commands >log 2>&1 </dev/null || { tail -30 log; exit 1; }
test $# -lt 5 || test "$(grep -cE "$4" log)" -eq "$5" || { tail -30 log; exit 1; }
