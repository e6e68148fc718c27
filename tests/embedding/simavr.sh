#!/bin/sh
# simavr.sh SOURCE FOLDER CHIP IMAGE: compiles the project's runner of AVR images in FOLDER and runs IMAGE with it. Its status is the image's, 95 and more its own.
set -eu
if ! pkg-config --exists simavr; then
    echo "skipped: no simavr here"
    exit 77
fi
gcc -std=gnu11 -O2 $(pkg-config --cflags simavr) "$1/tools/emulator/simavr_runner.c" -o "$2/simavr_runner" $(pkg-config --static --libs simavr)
exec "$2/simavr_runner" -m "$3" "$4"
