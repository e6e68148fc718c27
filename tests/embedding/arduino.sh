#!/bin/sh
# arduino.sh SOURCE FOLDER: the library as the README makes it, its sketch built by Debian's arduino-builder for an Uno, and run in simavr.
set -eu
source=$1 folder=$2
hardware=/usr/share/arduino/hardware
if ! command -v arduino-builder >/dev/null || [ ! -d $hardware/arduino/avr ]; then
    echo "skipped: no arduino-builder or arduino-core-avr here; run tools/setup test"
    exit 77
fi
sh "$source/tests/embedding/follow.sh" "$source" "$folder" Arduino
cd "$folder"
mkdir build
# Debian's core wants a newer avr-gcc than Debian's, whose float.h names DECIMAL_DIG for C alone
arduino-builder -compile -hardware $hardware -hardware /usr/share/arduino-builder -tools $hardware -libraries Arduino/libraries -fqbn arduino:avr:uno \
    -build-path "$folder/build" -warnings all -prefs compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__ \
    Arduino/libraries/motehound/examples/SensorNode/SensorNode.ino >log 2>&1 || { tail -20 log; exit 1; }
if grep -E 'motehound.*(warning|error):|SensorNode.*(warning|error):' log; then
    exit 1
fi
sh "$source/tests/embedding/simavr.sh" "$source" "$folder" atmega328p build/SensorNode.ino.elf >out 2>&1 || test $? -lt 90
test "$(grep -cE '^frame to (-1|4): [0-9A-F]+.?$|^3 reports' out)" -eq 5 || { cat out; exit 1; }
