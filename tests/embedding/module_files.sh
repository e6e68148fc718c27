#!/bin/sh
# module_files.sh SOURCE FOLDER: what is written twice, because others' tools ask for it in their own form, agrees.
set -eu
cd "$1"
cmp examples/cmake_project/main.c examples/platformio/src/main.c
mkdir -p "$2"
for main in cmake_project/main.c zephyr/src/main.c; do # the mote; the loop about it is Zephyr's own
    sed -n '/^static const struct mh_sensor_config/,/^static mh_tick alarm_time/p' "examples/$main" >"$2/${main%%/*}"
done
test -s "$2/zephyr"
cmp "$2/cmake_project" "$2/zephyr"
version=$(sed -n 's/^project(motehound VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
grep -q "\"version\": \"$version\"" packaging/library.json
grep -q "^version=$version$" packaging/library.properties
# Kconfig's defaults and ranges are those of config.h
python3 - <<'END'
import re

config = open("firmware/include/motehound/config.h").read()
found = re.findall(r"config MOTEHOUND_(\w+)\n\tint .*\n\tdefault (\d+)\n\trange (\d+) (\d+)", open("zephyr/Kconfig").read())
assert len(found) > 8
for name, default, low, high in found:
    defaults = re.findall(rf"#define MH_{name} (\d+)", config)
    assert default == defaults[-1], f"{name}: {default} in Kconfig, {defaults} in config.h"
    assert re.search(rf"MH_{name} < {low} \|\|\s*MH_{name} > {high}\b", config), f"{name}: config.h has another range than {low} to {high}"
END
