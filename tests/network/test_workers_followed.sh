#!/bin/bash
# The messages between a run and its workers as other LCM programs see them: lcm-logger records, lcm-logplayer replays, a Python program follows.
. "$(dirname "$0")/common.sh"
if [ -z "$IN_OWN_NETWORK" ]; then
    for program in lcm-logger lcm-logplayer lcm-gen; do
        command -v $program >/dev/null || { echo "skipped: no $program"; exit 77; }
    done
    "$PYTHON" -c 'import lcm' 2>/dev/null || { echo "skipped: $PYTHON does not have the package lcm; run tools/setup"; exit 77; }
    . "$(dirname "$0")/own_network.sh"
    IN_OWN_NETWORK=1 own_network sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh bash "$0"
    exit $?
fi
bus='udpm://239.255.76.67:7667?ttl=0'
follow="$(dirname "$0")/../../examples/follow_workers.py"
run=("$MOTEHOUND" run luo_exp1 --set network.nodes=200 --set radio.range_m=20 --set source.speed_mps=4 --bus "$bus" --workers 2)
await() { for _ in $(seq 100); do eval "$1" && return; sleep 0.1; done; complain "never: $1"; }
sum() { awk -v column="$1" 'NR == 2 {for (i = 1; i <= NF; i++) if ($i == column) c = i} NR > 2 {s += $c} END {print s + 0}' "$2"; }

accepted "$MOTEHOUND" "${run[@]:1:8}" --out alone

# recorded and followed while it runs; UDP may drop some of what mere listeners should hear on a busy machine
lcm-logger -q --lcm-url="$bus" run.lcm >/dev/null 2>&1 & logger=$!
"$PYTHON" "$follow" "$bus" >followed.txt 2>err.txt & follower=$!
await 'grep -q listening followed.txt && [ "$(grep -c :1DF3 /proc/self/net/udp)" -ge 2 ]'
sleep 0.5
accepted "${run[@]}" --out followed
windows=$(awk 'NR == 1 {print $3}' out.txt)
wait $follower || complain "follow_workers.py: $(cat err.txt)"
sleep 1
kill -INT $logger
wait $logger
cmp alone/track.csv followed/track.csv || complain "listeners change the results"
[ "$(wc -l <followed.txt)" -eq 4 ] || complain "expected two workers, found: $(cat followed.txt)"
[ "$(sum window followed.txt)" -gt $((windows / 2)) ] && [ "$(sum frames followed.txt)" -gt 100 ] || complain "$windows windows, found: $(cat followed.txt)"
logged() { # CHANNEL: how many messages of it lcm-logger wrote
    "$PYTHON" -c 'import lcm, sys; print(sum(e.channel.endswith(sys.argv[1]) for e in lcm.EventLog("run.lcm", "r")))' "$1"
}
[ "$(logged WINDOW)" -gt $((windows / 2)) ] && [ "$(logged DONE)" -gt $((windows / 2)) ] || complain "$windows windows, logged $(logged WINDOW), $(logged DONE)"

# replayed: followed again, and no run on the same bus takes it for its own
"$PYTHON" "$follow" "$bus" >again.txt 2>err.txt & follower=$!
await 'grep -q listening again.txt && grep -q :1DF3 /proc/self/net/udp'
lcm-logplayer --lcm-url="$bus" -s 0.5 run.lcm >/dev/null 2>&1 || complain "lcm-logplayer"
wait $follower || complain "follow_workers.py: $(cat err.txt)"
[ "$(sum window again.txt)" -gt $((windows / 2)) ] || complain "a log that is replayed: $(cat again.txt)"
lcm-logplayer --lcm-url="$bus" -s 0.5 run.lcm >/dev/null 2>&1 & player=$!
accepted "${run[@]}" --out beside
cmp alone/track.csv beside/track.csv || complain "a log that is replayed changes the results of a run"
wait $player || complain "lcm-logplayer"
conclude
