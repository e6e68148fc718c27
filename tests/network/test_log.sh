#!/bin/bash
# --log and --bus, as other LCM programs see them. Skipped (77) beyond the part that needs no network, where a network namespace of
# our own or LCM's programs are missing.
. "$(dirname "$0")/common.sh"
run=("$MOTEHOUND" run luo_exp1 --set tracker.name=luo --set network.nodes=200 --set radio.range_m=20 --set source.speed_mps=4)

accepted "${run[@]}" --log --out logged
"$COUNT_LOG" logged/events.lcm >played.txt || complain "the file provider does not play events.lcm"
"$COUNT_LOG" logged/events.lcm api >read.txt || complain "events.lcm cannot be read, or its times go backwards"
diff played.txt read.txt || complain "the file provider and the event log disagree"
of() { awk -v channel="MOTEHOUND_$1" '$1 == channel {print $2}' "$2"; }
column() { awk -F, -v name="$1" 'NR == 1 {for (i = 1; i <= NF; i++) if ($i == name) c = i} NR == 2 {print $c}' logged/runs.csv; }
[ "$(of RUN_BEGIN read.txt)" = 1 ] && [ "$(of RUN_END read.txt)" = 1 ] && [ "$(of TOTALS read.txt)" = 1 ] || complain "begin and end: $(cat read.txt)"
[ "$(of TRACK read.txt)" = "$(($(wc -l <logged/track.csv) - 1))" ] || complain "tracks: $(cat read.txt)"
[ "$(of NODE read.txt)" = "$(($(wc -l <logged/nodes.csv) - 1))" ] || complain "nodes: $(cat read.txt)"
[ "$(of FRAME read.txt)" = "$(column frames_sent)" ] || complain "frames: $(cat read.txt), $(column frames_sent) in runs.csv"
[ "$(of TRUTH read.txt)" -ge 24 ] || complain "truth: $(cat read.txt)"

accepted "${run[@]}" --log --runs 3 --jobs 2 --out thrice
"$COUNT_LOG" thrice/events.lcm api >read3.txt || complain "a log of three runs cannot be read, or its times go backwards"
[ "$(of RUN_END read3.txt)" = 3 ] || complain "three runs: $(cat read3.txt)"
[ $failures -eq 0 ] || exit 1

for program in lcm-logger lcm-logplayer; do
    command -v $program >/dev/null || { echo "skipped: no $program"; exit 77; }
done
. "$(dirname "$0")/own_network.sh"

# In a network of our own: $1 while lcm-logger writes $2.
beside_logger() {
    own_network sh -c '
        ip link set lo up && ip route add 224.0.0.0/4 dev lo || exit 1
        lcm-logger -q "$2" >/dev/null 2>&1 & logger=$!
        for _ in $(seq 100); do grep -q :1DF3 /proc/self/net/udp && break; sleep 0.1; done # it hears port 7667
        sleep 0.3
        eval "$1"; status=$?
        sleep 1
        kill -INT $logger; wait $logger
        exit $status' sh "$1" "$2"
}

# UDP drops bursts of frames on a busy machine, so the exact comparison is of the few and far between
beside_logger "lcm-logplayer -s 20 -e 'MOTEHOUND_(TRUTH|TRACK)' logged/events.lcm >/dev/null 2>&1" again.lcm ||
    complain "lcm-logplayer does not play events.lcm"
"$COUNT_LOG" again.lcm >again.txt || complain "lcm-logger's log"
for channel in TRUTH TRACK; do
    [ "$(of $channel again.txt)" = "$(of $channel read.txt)" ] || complain "lcm-logplayer: $channel: $(cat again.txt)"
done

beside_logger "${run[*]} --bus udpm://239.255.76.67:7667?ttl=0 --out outside >/dev/null" bus.lcm || complain "--bus udpm://"
"$COUNT_LOG" bus.lcm >bus.txt || complain "lcm-logger's log of --bus"
[ "$(of TRACK bus.txt)" -ge 1 ] && [ "$(of FRAME bus.txt)" -ge 1 ] || complain "--bus udpm://: $(cat bus.txt)"
diff -q outside/summary.json logged/summary.json >/dev/null || complain "a bus outside changes the results"

# at a pace of 8, 24 s of simulated time take 3 s on the clock, whatever else the machine does
begin=$(date +%s%N)
own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "${run[@]}" --pace 8 \
    --bus 'udpm://239.255.76.67:7667?ttl=0' --out paced >/dev/null || complain "--pace 8"
[ $((($(date +%s%N) - begin) / 1000000)) -ge 2900 ] || complain "--pace 8 did not keep pace"
diff -q paced/summary.json logged/summary.json >/dev/null || complain "a pace changes the results"
conclude
