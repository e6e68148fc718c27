#!/bin/bash
# Motes on emulated boards among those of this process: the same track. $BUILDS is the folder of all builds, whose firmware/apps have the images, $APPS the
# images of this build, $ARITHMETIC empty or -fixed. Boards that are not there are left out, unless $ALL_BOARDS says that they must be; with $NO_BOARDS all are.
if [ -z "$IN_OWN_NETWORK" ]; then
    own=$(dirname "$0")/../network/own_network.sh
    if bash -c '. "$0"' "$own" >/dev/null 2>&1; then
        . "$own"
        IN_OWN_NETWORK=yes own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh bash "$0"
        exit $?
    fi
    IN_OWN_NETWORK=no
fi
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/../network/common.sh"
for board in atmega128 cortex-m0; do
    if [ -z "$NO_BOARDS" ] && [ -e "$BUILDS/$board$ARITHMETIC/firmware/apps/cluster_head_luo" ]; then
        mkdir -p images
        ln -s "$BUILDS/$board$ARITHMETIC/firmware/apps" "images/$board$ARITHMETIC"
    fi
done
mkdir -p images
ln -s "$APPS" "images/host$ARITHMETIC"
export MOTEHOUND_IMAGES=$PWD/images LSAN_OPTIONS=suppressions=$PWD/suppressions:print_suppressions=0
echo leak:libsimavr >suppressions

# close NATIVE EMULATED: as many estimates at the same times by the same heads, all within 1e-3 m; in fixed point the same bytes; as many frames
close() {
    if [ -n "$ARITHMETIC" ]; then
        cmp "$1/track.csv" "$2/track.csv" || complain "$2/track.csv differs"
    fi
    paste -d, "$1/track.csv" "$2/track.csv" | awk -F, '
        NR == 1 {n = NF / 2; for (i = 1; i <= n; i++) at[$i] = i; next}
        {lines++; split("time_s x_m y_m head", names, " ")
         for (k in names) {d = $at[names[k]] - $(n + at[names[k]]); if (d > 1e-3 || d < -1e-3) exit bad = 1}}
        END {exit bad || lines < 3}' || complain "$2/track.csv is not that of $1"
    python3 - "$1" "$2" <<'END' || complain "$2: other frames than $1"
import csv, sys
native, emulated = (next(csv.DictReader(open(f"{folder}/runs.csv"))) for folder in sys.argv[1:])
sys.exit(any(native[key] != emulated[key] for key in native if key.startswith("frames_")))
END
}

# same SCENARIO BOARDS OPTION...: with these boards and without
same() {
    local name=$1 boards=$2
    shift 2
    [ -d "native_$name" ] || accepted "$MOTEHOUND" run "$@" --out "native_$name"
    rm -rf "on_$name"
    accepted "$MOTEHOUND" run "$@" --out "on_$name" --emulate "$boards"
    grep '^node' out.txt
    close "native_$name" "on_$name"
}

luo=(luo_exp1 --set tracker.name=luo)
same luo 17=host,42=host "${luo[@]}"
same luo 1280=host "${luo[@]}" # the head
grep -q '"boards"' on_luo/summary.json || complain "no boards in summary.json"
! grep -q '"boards"' native_luo/summary.json || complain "boards in a run without any"
# few neighbours, as images have room for; a walk of a minute
sparse=(zhou_real --set source.duration_s=60 --set network.density=5 --set radio.range_m=60 --set protocol.members=6 --seed 12)
han=(han_real --set source.duration_s=40 --set target.count=1 --set radio.range_m=45 --set protocol.replies=4 --set tracker.groups=none --set tracker.separation=none
    --seed 3)
xu=(xu_real --set source.duration_s=20 --set network.nodes=16 --set clusters.nodes=3,4,5,4) # node 16 is the fusion centre
tracker=range
[ -z "$ARITHMETIC" ] || tracker=pftl
same zhou 680=host,543=host "${sparse[@]}" --set tracker.name=$tracker
if [ -z "$ARITHMETIC" ]; then
    same han 590=host,548=host "${han[@]}" # the second is where the target begins
    same xu 16=host,0=host,5=host "${xu[@]}"
    same fed 16=host,0=host,5=host "${xu[@]}" --set fusion.rule=hif_feedback
else
    han+=(--set tracker.name=dm)
    same han 597=host,555=host "${han[@]}"
fi

# a mote that dies and comes back, and several runs
faults=("${luo[@]}" --set source.speed_mps=4 --set faults.reboot_share=0.5 --set faults.reboot_from_s=5 --set faults.reboot_for_s=3 --runs 2)
accepted "$MOTEHOUND" run "${faults[@]}" --out native_faults
accepted "$MOTEHOUND" run "${faults[@]}" --out on_faults --emulate 17=host,18=host,19=host,20=host
close native_faults on_faults

# boards of other processors
missing=()
command -v qemu-system-arm >/dev/null || missing+=("no qemu-system-arm")
[ -d "images/cortex-m0$ARITHMETIC" ] || missing+=("no images of cortex-m0$ARITHMETIC")
[ -d "images/atmega128$ARITHMETIC" ] || missing+=("no images of atmega128$ARITHMETIC")
[ -n "$SIMAVR" ] || missing+=("no libsimavr")
if [ ${#missing[@]} -eq 0 ]; then
    same luo 17=atmega128,42=atmega128,18=cortex-m0,43=cortex-m0 "${luo[@]}"
    same zhou 84=atmega128,543=atmega128,680=cortex-m0,752=cortex-m0 "${sparse[@]}" --set tracker.name=$tracker # all of them lead
    if [ -z "$ARITHMETIC" ]; then
        same han 590=atmega128,548=atmega128,519=cortex-m0,562=cortex-m0 "${han[@]}" # all of them lead
        same xu 16=atmega128,0=cortex-m0,7=cortex-m0 "${xu[@]}"                       # the centre and two heads
        refused 'more than its image has room for: clusters' "$MOTEHOUND" run "${xu[@]}" --set network.nodes=18 --set clusters.nodes=3,4,5,6 --out no --emulate 18=atmega128
        refused 'more than its image has room for: tracker.separation joint' "$MOTEHOUND" run "${han[@]}" --set tracker.separation=joint --out no --emulate 590=atmega128
    else
        same han 597=atmega128,558=atmega128,555=cortex-m0,601=cortex-m0 "${han[@]}" # likewise
        # a head with 50 particles leaves 512 of 4,096 bytes; here the neighbours are more than it keeps
        crowd=(zhou_real --set source.duration_s=80 --set protocol.members=6 --set tracker.name=pftl)
        accepted "$MOTEHOUND" run "${crowd[@]}" --out crowd
        heads=$(python3 -c "
import csv
heads = dict.fromkeys(row['head'] for row in csv.DictReader(open('crowd/track.csv')))
print(','.join(f'{head}=atmega128' for head in list(heads)[:10]))")
        accepted "$MOTEHOUND" run "${crowd[@]}" --out on_crowd --emulate "$heads"
        python3 -c "
import json, sys
free = [board['ram_free_b'] for board in json.load(open('on_crowd/summary.json'))['boards']]
print(free)
sys.exit(len(free) != 10 or min(free) < 512)" >free.txt || complain "bytes of RAM never used by heads with 50 particles, expected 512: $(cat free.txt)"
    fi
elif [ -n "$ALL_BOARDS" ]; then
    complain "${missing[*]}"
else
    echo "skipped: boards of other processors: ${missing[*]}"
fi

# what is wrong is said in one line
run=("$MOTEHOUND" run "${luo[@]}" --out no)
refused "^--emulate: expected NODE=BOARD, found '17'" "${run[@]}" --emulate 17
refused "^--emulate: expected NODE=BOARD, found ''" "${run[@]}" --emulate 17=host,
refused "^--emulate: expected a board, atmega128, .* found 'z80'" "${run[@]}" --emulate 17=z80
refused '^--emulate: expected each node once, found 17 again' "${run[@]}" --emulate 17=host --emulate 17=host
refused '^--emulate: expected a node of the network, 0 to 1280, found 2000' "${run[@]}" --emulate 2000=host
refused '^--emulate: expected one run at a time' "${run[@]}" --emulate 17=host --runs 2 --jobs 2
refused "node 17 on board host: no image nowhere/host$ARITHMETIC/sensor_node; .tools/images host. builds it" "${run[@]}" --emulate 17=host --images nowhere
refused '^--emulate: expected a network of motes, found network.ideal' "$MOTEHOUND" run zhou_nominal --out no --emulate 17=host
fake=fake/host$ARITHMETIC
mkdir -p "$fake"
pretend() { printf '#!/bin/bash\n%s\n' "$1" >"$fake/sensor_node" && chmod +x "$fake/sensor_node"; }
pretend 'echo broken >&2; exit 3'
refused 'node 17 on board host has ended with status 3: broken, at 0.000 s; image fake' "${run[@]}" --emulate 17=host --images fake
pretend "exec '$APPS/cluster_head_pftl'"
refused "has an image of the protocol cluster, expected collection" "${run[@]}" --emulate 17=host --images fake
if [ -z "$ARITHMETIC" ]; then
    mkdir other
    ln -s "$APPS" other/host-fixed
    refused "has an image in floating point, expected fixed point" "${run[@]}" --emulate 17=host-fixed --images other
fi
version=$("$MOTEHOUND" --version | grep -Eo '[0-9.]+')
LC_ALL=C sed "s/${version//./[.]}\\x00/9.8.7\\x00/g" "$APPS/sensor_node" >"$fake/old" && chmod +x "$fake/old"
pretend "exec '$fake/old'"
refused 'has an image of version 9.8.7 .line 1., expected '"$version"' .line 1.' "${run[@]}" --emulate 17=host --images fake
pretend "exec python3 '$folder/fault.py' '$APPS/sensor_node' 100"
refused 'node 17 on board host has started anew: its stack ran over at 0x1234, at [1-9][0-9.]* s; image fake' "${run[@]}" --emulate 17=host --images fake
rm "$fake/sensor_node"
echo "not to be run" >"$fake/sensor_node"
refused 'sensor_node: cannot be started: may not be run' "${run[@]}" --emulate 17=host --images fake
mkdir -p "fake/cortex-m0$ARITHMETIC"
: >"fake/cortex-m0$ARITHMETIC/sensor_node"
refused 'node 17 on board cortex-m0: fake.* is no image of a board' "${run[@]}" --emulate 17=cortex-m0 --images fake
if [ ${#missing[@]} -eq 0 ]; then
    cp "images/atmega128$ARITHMETIC/sensor_node" "fake/cortex-m0$ARITHMETIC"
    refused 'is for another processor .ELF machine 83, expected 40.' "${run[@]}" --emulate 17=cortex-m0 --images fake
    head -c 30000 "images/cortex-m0$ARITHMETIC/sensor_node" >"fake/cortex-m0$ARITHMETIC/sensor_node"
    refused 'sensor_node is not whole' "${run[@]}" --emulate 17=cortex-m0 --images fake
    refused 'qemu-system-arm: cannot be started: not installed' env PATH=/nowhere "${run[@]}" --emulate 17=cortex-m0
fi
pretend "exec timeout -s KILL 0.5 '$APPS/sensor_node'"
refused 'node 17 on board host .*(was ended by signal 9|has ended with status 137|has closed its line)' "$MOTEHOUND" run "${luo[@]}" --set source.speed_mps=0.02 --set radio.delay_s=0.0002 --out no --emulate 17=host --images fake
"${run[@]}" --set source.speed_mps=0.02 --emulate 17=host,18=host >out.txt 2>err.txt & interrupted=$!
sleep 0.3
kill -INT $interrupted
wait $interrupted && complain "interrupted: status 0"
[ "$(cat err.txt)" = "motehound: interrupted, nothing was written to no" ] || complain "interrupted: $(cat err.txt)"
nothing no
sleep 0.1
for process in /proc/[0-9]*; do
    [ "$(readlink "$process/cwd")" != "$PWD" ] || [[ "$(readlink "$process/exe")" != */sensor_node ]] || complain "a board is left: $process"
done

# over the bus: whichever worker has the mote runs its board
if [ "$IN_OWN_NETWORK" = yes ]; then
    bus='udpm://239.255.76.67:7667?ttl=0'
    accepted "$MOTEHOUND" run "${luo[@]}" --out on_workers --bus "$bus" --workers 2 --emulate 17=host,1280=host
    grep -q '^node 17 on host: [1-9]' out.txt && grep -q '^node 1280 on host: [1-9]' out.txt || complain "boards on workers: $(cat out.txt)"
    close native_luo on_workers
    refused "node 17 on board host: no image nowhere/host" "${run[@]}" --bus "$bus" --workers 2 --emulate 17=host --images nowhere
else
    echo "skipped: boards on workers: no network namespace may be made"
fi
conclude
