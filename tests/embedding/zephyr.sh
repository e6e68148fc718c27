#!/bin/sh
# zephyr.sh SOURCE FOLDER: the sample and the module in what stands in for Zephyr beside this script: Kconfig read by kconfiglib, as in Zephyr's own build,
# and its commands. As the sample has it, and with every tracker and protocol; fixed point refuses what it has not.
set -eu
source=$1 folder=$2
packages=$source/.deps/embedding python=$source/.deps/venv/bin/python
if ! PYTHONPATH=$packages "$python" -c 'import kconfiglib, yaml' 2>/dev/null; then
    echo "skipped: no kconfiglib in $packages; run tools/setup test"
    exit 77
fi
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
printf '#!/bin/sh\nPYTHONPATH=%s exec %s "$@"\n' "$packages" "$python" >python
chmod +x python
configure() {
    build=$1
    shift
    cmake -G Ninja -S "$source/examples/zephyr" -B "$build" -DZephyr_DIR="$source/tests/embedding/zephyr" -DZEPHYR_EXTRA_MODULES="$source" \
        -DMOTEHOUND_PYTHON="$folder/python" "$@"
}
configure sample >log 2>&1 && cmake --build sample -j 2 >>log 2>&1 || { tail -20 log; exit 1; }
test "$(sample/zephyr | grep -cE '^frame of|^3 reports')" -eq 5
grep -q 'DMH_REPORTS_MAX=16 ' sample/build.ninja

sed -n 's/^config \(MOTEHOUND_\(TRACKER\|PROTOCOL\)_.*\)/CONFIG_\1=y/p' "$source/zephyr/Kconfig" | grep -v COLLECTION >all.conf
test "$(wc -l <all.conf)" -ge 15
configure all -DEXTRA_CONF="$folder/all.conf" >log 2>&1 || { tail -20 log; exit 1; }
for file in "$source"/firmware/src/*/*.c; do
    grep -q "/${file#"$source"/}.o" all/build.ninja || { echo "$file is in no configuration of the module"; exit 1; }
done
# what a part is made of is not there without it
cat all.conf | while IFS='=' read -r symbol _; do
    grep -q "of_${symbol#CONFIG_MOTEHOUND_} " "$source/zephyr/CMakeLists.txt" || { echo "$symbol has no sources"; exit 1; }
done

echo CONFIG_MOTEHOUND_FIXED=y >fixed.conf
configure fixed -DEXTRA_CONF="$folder/fixed.conf" >log 2>&1 && cmake --build fixed -j 2 >>log 2>&1 || { tail -20 log; exit 1; }
test "$(fixed/zephyr | grep -cE '^frame of|^3 reports')" -eq 5
echo CONFIG_MOTEHOUND_TRACKER_DIFFUSION=y >>fixed.conf
! configure fixed -DEXTRA_CONF="$folder/fixed.conf" >log 2>&1
grep -q 'fixed-point form' log
