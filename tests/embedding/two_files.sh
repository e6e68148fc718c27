#!/bin/sh
# two_files.sh SOURCE FOLDER FILES: a second making of the two files gives the same bytes, whatever the environment; and every compiler here takes them
# without a warning, the header also as C++.
set -eu
source=$1 folder=$2 files=$3
rm -rf "$folder"
PYTHONHASHSEED=1 "$source/tools/amalgamate" "$folder" >/dev/null
cmp "$files/motehound.h" "$folder/motehound.h"
cmp "$files/motehound.c" "$folder/motehound.c"
cd "$folder"
strict="-std=c99 -Wall -Wextra -Wconversion -Werror"
for compiler in gcc clang "arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb" "avr-gcc -mmcu=atmega128"; do
    for arithmetic in 0 1; do
        if command -v "${compiler%% *}" >/dev/null; then
            $compiler $strict -DMH_REAL_FIXED=$arithmetic -fsyntax-only motehound.c
        fi
    done
done
for compiler in "avr-g++ -mmcu=atmega2560" clang++; do
    if command -v "${compiler%% *}" >/dev/null; then
        printf '#include "motehound.h"\n' | $compiler -std=gnu++11 -Wall -Wextra -Werror -I. -x c++ -fsyntax-only -
    fi
done
