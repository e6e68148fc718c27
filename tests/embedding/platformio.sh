#!/bin/sh
# platformio.sh SOURCE FOLDER: what the README says about PlatformIO, by PlatformIO itself, and the image for the ATmega2560 in simavr. The platforms, which its registry
# has, are stood in for by those beside this script, with the system's compilers; so is the package of SCons, by SCons.
set -eu
source=$1 folder=$2
here=$source/tests/embedding/platformio packages=$source/.deps/embedding python=$source/.deps/venv/bin/python
if ! PYTHONPATH=$packages "$python" -c 'import platformio, SCons' 2>/dev/null || ! command -v avr-gcc >/dev/null; then
    echo "skipped: no PlatformIO in $packages or no avr-gcc; run tools/setup test"
    exit 77
fi
core=$folder.core
rm -rf "$core"
mkdir -p "$core/platforms" "$core/packages/tool-scons" "$core/bin"
cp -r "$here/native" "$here/atmelavr" "$core/platforms/"
version=$(PYTHONPATH=$packages "$python" -c '
from platformio.dependencies import get_core_dependencies
print(get_core_dependencies()["tool-scons"].lstrip("~"))')
cat >"$core/packages/tool-scons/package.json" <<END
{"name": "tool-scons", "version": "$version"}
END
cat >"$core/packages/tool-scons/.piopm" <<END
{"type": "tool", "name": "tool-scons", "version": "$version", "spec": {"owner": "platformio", "id": null, "name": "tool-scons", "requirements": null, "uri": null}}
END
printf 'import sys\nimport SCons.Script\nsys.exit(SCons.Script.main())\n' >"$core/packages/tool-scons/scons.py"
printf '#!/bin/sh\nPYTHONPATH=%s exec %s -m platformio "$@"\n' "$packages" "$python" >"$core/bin/pio"
chmod +x "$core/bin/pio"

PATH=$core/bin:$PATH PLATFORMIO_CORE_DIR=$core PLATFORMIO_SETTING_ENABLE_TELEMETRY=no \
    sh "$source/tests/embedding/follow.sh" "$source" "$folder" PlatformIO '^frame of|^3 reports|\[SUCCESS\]' 7
sh "$source/tests/embedding/simavr.sh" "$source" "$core" atmega2560 "$folder/my_node/.pio/build/mega/firmware.elf" >"$core/log" 2>&1 || test $? -lt 90
test "$(grep -cE '^frame of|^3 reports' "$core/log")" -eq 5 || { cat "$core/log"; exit 1; }
