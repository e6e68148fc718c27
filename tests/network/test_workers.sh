#!/bin/bash
# Motes in other processes: the same bytes however they are spread, whatever the bus loses and whoever dies. Runs itself anew in a network of
# its own.
. "$(dirname "$0")/common.sh"
if [ -z "$IN_OWN_NETWORK" ]; then
    . "$(dirname "$0")/own_network.sh"
    IN_OWN_NETWORK=1 own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh bash "$0"
    exit $?
fi
export MARK=$$ # of all processes that are started here
bus='udpm://239.255.76.67:7667?ttl=0'
small=("$MOTEHOUND" run luo_exp1 --set network.nodes=200 --set radio.range_m=20 --set source.speed_mps=4)
same() { for file in track.csv runs.csv summary.json; do cmp "$1/$file" "$2/$file" || complain "$2/$file differs from that of one process"; done; }

# the scenario of the papers, with lost datagrams
accepted "$MOTEHOUND" run luo_exp1 --out paper
accepted "$MOTEHOUND" run luo_exp1 --out paper2 --bus "$bus" --workers 2 --drop-share 0.05
head -1 out.txt
same paper paper2
grep -Eq ' [1-9][0-9]+ sent again' out.txt || complain "nothing was lost: $(cat out.txt)"

# one worker and more of them, several runs, a sweep, noise, losses, sleeping motes
accepted "${small[@]}" --out small --runs 3 --seed 7 --set radio.loss=0.1 --set sensor.relative_noise=0.05
for workers in 1 3; do
    accepted "${small[@]}" --out small$workers --runs 3 --seed 7 --set radio.loss=0.1 --set sensor.relative_noise=0.05 --bus "$bus" --workers $workers
    same small small$workers
done

# collisions, drifting clocks that are synchronised, batteries that empty, motes that die and restart; and a log, which looks on
rough=(--set radio.profile=802154 --set clock.drift_ppm=40 --set clock.sync=flooding --set energy.battery_j=1 --set faults.dead_share=0.1 --set faults.dead_from_s=5
    --set faults.reboot_share=0.2 --set faults.reboot_from_s=8 --set faults.stuck_share=0.1)
accepted "${small[@]}" "${rough[@]}" --out rough --log
accepted "${small[@]}" "${rough[@]}" --out rough2 --bus "$bus" --workers 2
same rough rough2
accepted "$MOTEHOUND" run bench_s2 --set source.duration_s=15 --out s2
accepted "$MOTEHOUND" run bench_s2 --set source.duration_s=15 --out s22 --bus "$bus" --workers 2
same s2 s22

# clusters: sensors sample when they are asked, any node leads, radios sleep
clusters=("$MOTEHOUND" run zhou_real --set source.duration_s=60 --set clock.sync=flooding --set clock.drift_ppm=20 --set clock.sync_period_s=4 --set faults.dead_share=0.1
    --set faults.dead_from_s=30 --seed 3)
accepted "${clusters[@]}" --out clusters --log
accepted "${clusters[@]}" --out clusters2 --bus "$bus" --workers 2 --drop-share 0.02
same clusters clusters2
awk -F, 'NR == 1 {for (i = 1; i <= NF; i++) at[$i] = i} NR == 2 {exit !($at["estimates"] > 10 && $at["clusters"] > 0)}' clusters/runs.csv || complain "no cluster led"

# particles of the run's own, wherever they are drawn
particles=("$MOTEHOUND" run zhou_real --set source.duration_s=60 --set tracker.name=pftl --runs 2 --seed 3)
accepted "${particles[@]}" --out particles
accepted "${particles[@]}" --out particles2 --bus "$bus" --workers 2
same particles particles2

# targets that begin where and when the run says, followed by who hears them; the tracks travel in two frames
heard=("$MOTEHOUND" run han_real --set source.path=scripted --set "targets=0,10,1: 300,480; 380,484 | 0,10,2: 320,530; 400,530" --set network.grid=26 --seed 3)
accepted "${heard[@]}" --out heard --log
accepted "${heard[@]}" --out heard2 --bus "$bus" --workers 2
same heard heard2
awk -F, 'NR == 1 {for (i = 1; i <= NF; i++) at[$i] = i} NR == 2 {exit !($at["fixes"] > 2)}' heard/runs.csv || complain "no target found"

# a search begins where the run says, wherever that mote lives
search=("$MOTEHOUND" run zhang_real --set source.duration_s=30 --seed 3)
accepted "${search[@]}" --out search
accepted "${search[@]}" --out search2 --bus "$bus" --workers 2
same search search2

# a worker from elsewhere joins; it ends when the run does
"$MOTEHOUND" worker --bus "$bus" 2>joined.txt & joined=$!
accepted "${small[@]}" --out alone
accepted "${small[@]}" --out together --bus "$bus" --workers 1 --join 1
same alone together
wait $joined || complain "a worker that joined: status $?: $(cat joined.txt)"

# what is no message of ours is ignored and counted; the same bus serves two runs at once
"$FOREIGN" "$bus" & foreign=$!
"${small[@]}" --out beside --bus "$bus" --workers 1 >/dev/null & beside=$!
accepted "${small[@]}" --out noisy --bus "$bus" --workers 2
same alone noisy
grep -Eq ' [1-9][0-9]* messages not understood' out.txt || complain "foreign messages are not counted: $(head -1 out.txt)"
wait $beside || complain "two runs on one bus"
same alone beside
kill $foreign
wait $foreign

# a worker that dies: the run ends, or replaces it
workers_of() { awk -v parent="$1" '$4 == parent {print $1; exit}' /proc/[0-9]*/stat 2>/dev/null; }
kill_one_of() { # PROCESS: one of its workers, once the run goes on
    local victim
    for _ in $(seq 200); do
        victim=$(workers_of "$1")
        [ -z "$victim" ] || break
        sleep 0.01
    done
    sleep 0.4
    kill -KILL "$victim"
}
slow=(--set radio.delay_s=0.0002 --set source.speed_mps=1)
"${small[@]}" "${slow[@]}" --out killed --bus "$bus" --workers 2 >out.txt 2>err.txt & run=$!
kill_one_of $run
wait $run && complain "a run whose worker was killed has status 0"
[ "$(wc -l <err.txt)" -eq 1 ] && grep -q 'was ended by signal 9; --respawn' err.txt || complain "a killed worker: $(cat err.txt)"
nothing killed
accepted "${small[@]}" "${slow[@]}" --out whole
"${small[@]}" "${slow[@]}" --out replaced --bus "$bus" --workers 2 --respawn >out.txt 2>err.txt & run=$!
kill_one_of $run
wait $run || complain "--respawn: status $?: $(cat err.txt)"
grep -q '; 1 replaced' out.txt || complain "--respawn: $(cat out.txt)"
same whole replaced

# errors
refused 'expected a bus that other processes hear' "${small[@]}" --out no --workers 2
refused '^--workers: expected one run at a time' "${small[@]}" --out no --workers 2 --jobs 2 --bus "$bus"
refused "^--drop-share: expected a number from 0 to below 1, found '1'" "${small[@]}" --out no --workers 2 --drop-share 1 --bus "$bus"
refused 'expected --bus URL, found nothing' "$MOTEHOUND" worker
refused "^--key: expected a hexadecimal number, found 'x'" "$MOTEHOUND" worker --bus "$bus" --key x
nothing no
"${small[@]}" --out no --join 1 --bus "$bus" >out.txt 2>err.txt & run=$!
sleep 0.3
kill -INT $run
wait $run && complain "interrupted while it waits: status 0"
grep -q 'interrupted' err.txt || complain "interrupted while it waits: $(cat err.txt)"
nothing no
sleep 0.5
for process in $(grep -lzx "MARK=$MARK" /proc/[0-9]*/environ 2>/dev/null); do
    ! tr '\0' ' ' <"${process%environ}cmdline" | grep -q ' worker ' || complain "a worker is left: $process"
done
conclude
