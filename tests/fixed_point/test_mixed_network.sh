#!/bin/bash
# Motes of both arithmetics in one network: half of them live in a worker of the fixed-point build, half in one of $MOTEHOUND_FLOAT, and tracks that they save
# travel from one to the other. The network follows its target as a network of float motes does. Runs itself anew in a network of its own.
[ -x "$MOTEHOUND_FLOAT" ] || { echo "skipped: no $MOTEHOUND_FLOAT (build the preset host)"; exit 77; }
folder=$(dirname "$0")/../network
if [ -z "$IN_OWN_NETWORK" ]; then
    . "$folder/own_network.sh"
    IN_OWN_NETWORK=1 own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh bash "$0"
    exit $?
fi
. "$folder/common.sh"
bus='udpm://239.255.76.67:7667?ttl=0'

# value NAME FOLDER: a metric of the only run
value() { awk -F, -v name="$1" 'NR == 1 {for (i = 1; i <= NF; i++) at[$i] = i} NR == 2 {print $at[name]}' "$2/runs.csv"; }

# follows SCENARIO...: alone in float, and mixed
follows() {
    rm -rf float mixed
    accepted "$MOTEHOUND_FLOAT" run "$@" --out float
    "$MOTEHOUND" worker --bus "$bus" >worker.txt 2>&1 &
    accepted "$MOTEHOUND_FLOAT" run "$@" --out mixed --bus "$bus" --workers 1 --join 1 --mixed
    wait $! || complain "the fixed-point worker: $(cat worker.txt)"
    for name in position_rmse_m tracked_share saturations; do
        echo "$1 $name: $(value $name float) in float, $(value $name mixed) mixed"
    done
    cmp -s float/track.csv mixed/track.csv && complain "$1: the same track; was anything in fixed point?"
    awk -v alone="$(value position_rmse_m float)" -v mixed="$(value position_rmse_m mixed)" 'BEGIN {exit !(mixed > 0 && mixed < 1.25 * alone)}' ||
        complain "$1: position_rmse_m $(value position_rmse_m mixed), alone $(value position_rmse_m float)"
    [ "$(value saturations mixed)" = 0 ] || complain "$1: saturations $(value saturations mixed)"
}

# differs RUN WORKER EXPECTED: not told --mixed, a run of the one program refuses a worker of the other
differs() {
    "$2" worker --bus "$bus" 2>/dev/null &
    local worker=$!
    # without a worker of its own it always says that it waits, else only where that one joins first
    refused "^worker .*, process [0-9]+ computes in .*, expected $3 like this run; --mixed lets it join" \
        sh -c '"$@" >told.txt' sh "$1" run luo_exp1 --set tracker.name=luo --out no --bus "$bus" --join 1
    [ "$(cat told.txt)" = 'waiting for 1 worker to join: motehound worker --bus URL' ] || complain "told: $(cat told.txt)"
    nothing no
    kill -INT $worker
    wait $worker
}

differs "$MOTEHOUND_FLOAT" "$MOTEHOUND" 'floating point'
differs "$MOTEHOUND" "$MOTEHOUND_FLOAT" 'fixed point'
follows luo_exp1 --set tracker.name=luo
follows zhou_real --set tracker.name=pftl --set source.duration_s=300 --seed 3
awk -v clusters="$(value clusters mixed)" 'BEGIN {exit !(clusters >= 10)}' || complain "clusters: $(value clusters mixed)"
conclude
