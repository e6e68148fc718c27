#!/bin/sh
# porting.sh SOURCE FOLDER FILES: the sizes in docs/porting.md are those that the compilers for the boards make of the two files, within 10 %.
set -eu
source=$1 folder=$2 files=$3
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
sed -n 's/^| `struct \(mh_[a-z_]*\)` | \([0-9]*\) | \([0-9]*\) |.*/\1 \2 \3/p' "$source/docs/porting.md" >table
test "$(wc -l <table)" -ge 10
{
    echo '#include "motehound.h"'
    awk '{print "char size_" $1 "[sizeof(struct " $1 ")];"}' table
} >sizes.c
column=2
for compiler in "avr-gcc -mmcu=atmega128" "arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb"; do
    command -v "${compiler%% *}" >/dev/null || { echo "skipped: no ${compiler%% *} here"; exit 77; }
    $compiler -std=c99 -I"$files" -c sizes.c -o sizes.o
    tool=${compiler%% *}
    "${tool%gcc}nm" -S -t d sizes.o | awk -v column=$column '
        NR == FNR {told[$1] = $column; next}
        {name = substr($4, 6); size = $2 + 0; seen++
         if (told[name] < 0.9 * size || told[name] > 1.1 * size) {print name ": " size ", docs/porting.md says " told[name]; bad = 1}}
        END {exit bad || seen == 0}' table -
    column=3
done
