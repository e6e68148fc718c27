#!/bin/bash
. "$(dirname "$0")/common.sh"
small=(--set tracker.name=luo --set network.nodes=300 --set source.speed_mps=4)

# scenarios
accepted "$MOTEHOUND" list
grep -q luo_exp4 out.txt || complain "list: no luo_exp4"
accepted "$MOTEHOUND" list --keys
grep -q '^source.speed_mps .*a number 0.01 to 100' out.txt || complain "list --keys: no source.speed_mps"
accepted "$MOTEHOUND" list --metrics
grep -q '^energy_mj_routing ' out.txt || complain "list --metrics: no energy_mj_routing"
accepted "$MOTEHOUND" --version
accepted "$MOTEHOUND" --help
for command in list run replay bench; do accepted "$MOTEHOUND" $command --help; done

# words
refused 'expected list, run, replay, bench or worker' "$MOTEHOUND"
refused "expected list, run, replay, bench or worker, found 'walk'" "$MOTEHOUND" walk
refused "unknown option '--run'" "$MOTEHOUND" run luo_exp1 --run 3
refused 'expected a scenario, found nothing' "$MOTEHOUND" run
refused "found 'luo_exp2' too" "$MOTEHOUND" run luo_exp1 luo_exp2
refused "--runs: expected a whole number 1 to 1000000, found '0'" "$MOTEHOUND" run luo_exp1 --runs 0
refused "--jobs: expected a whole number .*, found '-1'" "$MOTEHOUND" run luo_exp1 --jobs -1
refused "--seed: expected a whole number .*, found '1.5'" "$MOTEHOUND" run luo_exp1 --seed=1.5
refused '--out: expected a value' "$MOTEHOUND" run luo_exp1 --out
refused '--seed: expected once' "$MOTEHOUND" run luo_exp1 --seed 1 --seed 2
refused '--set speed: expected key=value' "$MOTEHOUND" run luo_exp1 --set speed
refused '--bus nowhere://: expected a URL' "$MOTEHOUND" run luo_exp1 --bus nowhere://
nothing out/luo_exp1

refused "found 'a.b'" "$MOTEHOUND" $'a\nb'
refused "found 'a.b'" "$MOTEHOUND" list $'a\nb'
refused '^--bus : expected a URL' "$MOTEHOUND" run luo_exp1 --bus ''
refused '^--bus tcpq://127.0.0.1:1: expected a URL' "$MOTEHOUND" run luo_exp1 --bus tcpq://127.0.0.1:1
nothing out/luo_exp1

# bad scenarios
refused 'luo_exp9: expected a scenario.s file or a name of .motehound list., found neither' "$MOTEHOUND" run luo_exp9
refused '^none.yaml: expected a scenario' "$MOTEHOUND" run none.yaml
printf 'source:\n  sped_mps: 1\n' >key.yaml
refused '^key.yaml:2: source.sped_mps: unknown key.*nearest is source.speed_mps' "$MOTEHOUND" run key.yaml
printf 'source:\n  speed_mps: fast\n' >type.yaml
refused "^type.yaml:2: source.speed_mps: expected a number 0.01 to 100, found 'fast'" "$MOTEHOUND" run type.yaml
printf 'sensor: {loss: 1.5}\n' >range.yaml
refused "^range.yaml:1: sensor.loss: expected a number 0 to 1, found '1.5'" "$MOTEHOUND" run range.yaml
printf 'source: [\n' >broken.yaml
refused '^broken.yaml:[12]: ' "$MOTEHOUND" run broken.yaml
refused "^--set network.nodes: expected a whole number 4 to 1000000, found '3'" "$MOTEHOUND" run luo_exp1 --set network.nodes=3
refused '^--set network.node: unknown key.*network.nodes' "$MOTEHOUND" run luo_exp1 --set network.node=30
refused '^.*luo_exp1.yaml: sensor.outage_s: expected an end within the run' "$MOTEHOUND" run luo_exp1 --set sensor.outage_s=500
refused 'sweep: expected a key and values' "$MOTEHOUND" run luo_exp1 --sweep
refused '^--set name: expected UTF-8 text' "$MOTEHOUND" run luo_exp1 --set name=$'\xff'
refused "sweep: expected a key of another section .*, found 'sweep.values'" "$MOTEHOUND" run luo_exp1 --set sweep.key=sweep.values --set sweep.values=1,2 --sweep
nothing out/key
nothing out/luo_exp1

# bad recordings
printf 'node,x_m,y_m\n0,0,0\n1,10,0\n2,0,10\n3,10,10\n' >nodes.csv
printf 'node,x_m,y_m\n0,0,0\n1,10,0\n2,0,10\n' >three.csv
readings() { { echo time_s,node,value; printf '%s\n' "$@"; } >readings.csv; }
replay=("$MOTEHOUND" replay --nodes nodes.csv --readings readings.csv --tracker luo --out replayed)
readings 0,0,1 0,1,nan
refused "^readings.csv:3: value: expected a number .*, found 'nan'" "${replay[@]}"
readings 0,0,1 0,9,1
refused '^readings.csv:3: node: expected one of the 4 nodes .*, found 9' "${replay[@]}"
readings 1,0,1 0.5,1,1
refused '^readings.csv:3: time_s: expected at least 1, .*found 0.5' "${replay[@]}"
readings 0,0,1 1,1,1
refused 'sensor.interval_s: expected a number' "${replay[@]}"
readings 0,0,1 1,0,1
refused '^three.csv: node: expected at least 4 nodes, found 3' "$MOTEHOUND" replay --nodes three.csv --readings readings.csv --tracker luo
refused '^none.csv: cannot read' "$MOTEHOUND" replay --nodes none.csv --readings readings.csv --tracker luo
refused 'expected --readings FILE' "$MOTEHOUND" replay --nodes nodes.csv --tracker luo
refused 'expected --tracker NAME' "$MOTEHOUND" replay --nodes nodes.csv --readings readings.csv
refused "^--tracker: tracker.name: expected one of .*, found 'kalman'" "$MOTEHOUND" replay --nodes nodes.csv --readings readings.csv --tracker kalman
targets() { { echo time_s,node,value,target; printf '%s\n' "$@"; } >readings.csv; }
targets 0,0,1,1 0,1,1,1 1,0,1,2
refused '^readings.csv: target: expected one.* found 1 and 2 in row 3' "${replay[@]}"
readings 0,0,1 1,0,1
printf 'time_s,x_m,y_m,target\n0,0,0,0\n0,9,9,1\n' >truths.csv
refused '^truths.csv: target: expected one.* found 0 and 1 in row 2' "${replay[@]}" --truth truths.csv
nothing replayed

# a replay without a truth has no errors; with one it has
for t in 0 1 2 3 4 5 6 7 8 9; do for n in 0 1 2 3; do echo $t,$n,7; done; done >rows.txt
mapfile -t rows <rows.txt
readings "${rows[@]}"
printf 'time_s,x_m,y_m\n0,5,5\n9,5,5\n' >truth.csv
ranged=("$MOTEHOUND" replay --nodes nodes.csv --readings readings.csv --tracker range)
accepted "${ranged[@]}" --out replayed
grep -q position_rmse_m replayed/summary.json && complain "errors without a truth"
grep -q tracked_share replayed/summary.json && complain "tracked share without a truth"
accepted "${ranged[@]}" --truth truth.csv --out replayed
grep -q position_rmse_m replayed/summary.json || complain "no errors with a truth"
[ "$(head -1 replayed/track.csv | cut -d, -f1-10)" = run,target,time_s,x_m,y_m,raw_x_m,raw_y_m,sd_m,true_x_m,true_y_m ] ||
    complain "columns of track.csv"

# which of two places leaks: the wind blows in turns from the second to the first node and back, and the first place lies between them
printf 'place,x_m,y_m\n4,5,0\n9,5,10\n' >places.csv
{ echo time_s,node,value,wind_speed_mps,wind_toward_rad
  for t in {0..39}; do
      toward=$((t / 4 % 2)) && for n in 0 1 2 3; do
          echo "$((60 * t)),$n,$((2 + (t > 9 && n == 1 - toward) * 5)),3,$(awk "BEGIN { print $toward * 3.14159 }")"
      done
  done; } >readings.csv
printf 'time_s,x_m,y_m,rate_mlps\n600,5,0,100\n2340,5,0,100\n' >truth.csv
leak=("$MOTEHOUND" replay --nodes nodes.csv --readings readings.csv --set sensor.unit_ppm=1 --set tracker.learn_s=600 --out leaked)
accepted "${leak[@]}" --tracker gas --candidates places.csv --truth truth.csv
grep -q '^leak at x 5.0 m, y 0.0 m (place 4), releases .*; true: x 5.0 m, y 0.0 m, 100 mL/s' out.txt || complain "no leak: $(cat out.txt)"
grep -q '"rate_ratio"' leaked/summary.json || complain "no rate_ratio"
accepted "${leak[@]}" --tracker gas # on a grid of 64 places 1.25 m apart
grep -Eq '^leak at x [4-6][.0-9]* m, y [01][.0-9]* m, releases' out.txt || complain "no leak on the grid: $(cat out.txt)"
refused '^tracker.name: .luo., expected gas where there are candidates' "${leak[@]}" --tracker luo --candidates places.csv
printf 'place,x_m,y_m\n4,5,0\n4,5,10\n' >places.csv
refused '^places.csv:3: place: expected each once, found 4 again' "${leak[@]}" --tracker gas --candidates places.csv
printf 'place,x_m,y_m\n4,5,0\n' >places.csv
cut -d, -f1-3 readings.csv >calm.csv
refused 'no columns wind_speed_mps' "$MOTEHOUND" replay --nodes nodes.csv --readings calm.csv --tracker gas --candidates places.csv --out leaked

# clusters: what the sink has is never farther from the head's position than the tolerance; of two scenarios one has frames
followed=(--set tracker.name=pftl --set source.duration_s=400 --seed 1)
accepted "$MOTEHOUND" run zhou_nominal "${followed[@]}" --out followed
[ "$(head -1 followed/track.csv | cut -d, -f20-26)" = flags,head,sink_x_m,sink_y_m,states,rate,true_rate ] || complain "last columns of track.csv"
[ "$(wc -l <followed/track.csv)" = 202 ] || complain "positions at 201 instants: $(wc -l <followed/track.csv)"
awk -F, 'NR > 1 && ($22 == "" || ($22 - $4) ^ 2 + ($23 - $5) ^ 2 > 25.001) { exit 1 }' followed/track.csv || complain "the sink is off by more than the tolerance"
accepted "$MOTEHOUND" run zhou_real "${followed[@]}" --out followed
grep -q '"sink_error_rs"' followed/summary.json || complain "nothing at the sink"
refused '^tracker.name: .luo' "$MOTEHOUND" run zhou_nominal --set tracker.name=luo
refused 'network.ideal: expected false where there are faults' "$MOTEHOUND" run zhou_nominal --set faults.dead_share=0.1

# searches: one that nothing can come of, clusters of more than any mote's neighbours, a start that is nowhere
accepted "$MOTEHOUND" run zhang_a --set source.rate_mlps=0 --out searched
grep -q '"rate_error_median"' searched/summary.json && complain "a relative error of no release"
accepted "$MOTEHOUND" run zhang_a --set network.nodes=300 --set radio.range_m=700 --out searched
accepted "$MOTEHOUND" run zhang_a --set network.starts=0 --set protocol.start=99 --out searched
refused '^protocol.start: expected a node of the network, found 100$' "$MOTEHOUND" run zhang_a --set network.starts=0 --set protocol.start=100

# the same bytes whatever the jobs, and for the same seeds whatever the runs before
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --set sensor.relative_noise=0.05 --runs 5 --seed 7 --log --out one
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --set sensor.relative_noise=0.05 --runs 5 --seed 7 --log --out two --jobs 2
diff -r one two >/dev/null || complain "--jobs 2 gives other bytes"
[ "$(ls one)" = "$(printf 'events.lcm\nnodes.csv\nruns.csv\nscenario.json\nsummary.json\ntrack.csv')" ] || complain "files: $(ls one)"
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --set sensor.relative_noise=0.05 --seed 10 --out three
[ "$(sed -n 5p one/runs.csv | cut -d, -f2-)" = "$(sed -n 2p three/runs.csv | cut -d, -f2-)" ] || complain "run 3 of seed 7 is not run 0 of seed 10"
[ "$(head -1 one/runs.csv | cut -d, -f1,2)" = run,seed ] || complain "columns of runs.csv"
[ "$(cut -d, -f1 one/runs.csv | tr '\n' ' ')" = "run 0 1 2 3 4 " ] || complain "rows of runs.csv"
grep -iq nan one/*.json one/*.csv && complain "NaN in a file"

# an earlier result is replaced, what else is in the folder stays
echo mine >one/notes.txt
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --seed 10 --set sensor.relative_noise=0.05 --out one/
[ "$(cat one/notes.txt)" = mine ] || complain "notes.txt is gone"
[ ! -e one/events.lcm ] || complain "events.lcm of the run before is still there"
diff one/summary.json three/summary.json >/dev/null || complain "summary.json was not replaced"
nothing one/other

# by default into out/NAME, and a sweep into a folder a value
accepted "$MOTEHOUND" run luo_exp4 --set tracker.name=luo --set source.speed_mps=8 --set sweep.values=100,200 --sweep
[ "$(ls out/luo_exp4)" = "$(printf '100\n200')" ] || complain "folders of the sweep: $(ls out/luo_exp4)"
[ "$(wc -l <out/luo_exp4/200/nodes.csv)" -gt 200 ] || complain "nodes of the sweep"
refused 'sweep: network.nodes: expected a whole number' "$MOTEHOUND" run luo_exp4 --set sweep.values=100,two --sweep --out swept
nothing swept

# a name stays within its folder, whatever it is; swept names too
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --set name=../../evil
[ -s out/.._.._evil/summary.json ] || complain "folder of a name with slashes: $(ls -A out)"
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --set sweep.key=name --set 'sweep.values=..,,a/b' --sweep --out swept
[ "$(ls -A swept)" = "$(printf '_\n_..\na_b')" ] || complain "folders of the sweep: $(ls -A swept)"
[ ! -e summary.json ] || complain "a sweep wrote outside its folder"

# a folder that exists stays the same one: it may be the current folder, a link or a mount point
mkdir current real
ln -s real link
(cd current && accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --out ../current && [ -s summary.json ]) ||
    complain "the current folder was replaced"
accepted "$MOTEHOUND" run luo_exp1 "${small[@]}" --out link
[ -L link ] && [ -s real/summary.json ] || complain "the link was replaced"
ln -s nowhere loose
refused '^loose: cannot write into this folder' "$MOTEHOUND" run luo_exp1 --runs 100000 --out loose
nothing loose
if unshare -rm true 2>/dev/null; then
    mkdir mounted
    unshare -rm sh -c 'mount -t tmpfs -o size=1m none mounted && "$@" --out mounted >/dev/null && test -s mounted/summary.json' \
        sh "$MOTEHOUND" run luo_exp1 "${small[@]}" || complain "a mount point as the folder"
    unshare -rm sh -c 'mount -t tmpfs -o size=16k none mounted && exec "$@" --out mounted/full' \
        sh "$MOTEHOUND" run luo_exp1 "${small[@]}" >out.txt 2>err.txt && complain "a full disk: status 0"
    grep -q 'No space left' err.txt && [ "$(wc -l <err.txt)" -eq 1 ] || complain "a full disk: $(cat err.txt)"
fi

# standard streams: full, gone, or closed from the start
refuses_stdout() {
    [ "$1" -eq 1 ] && grep -q '^standard output: cannot write' err.txt && [ "$(wc -l <err.txt)" -eq 1 ] ||
        complain "standard output $2: status $1, $(cat err.txt)"
}
"$MOTEHOUND" run luo_exp1 "${small[@]}" --out streams >/dev/full 2>err.txt
refuses_stdout $? full
[ -s streams/summary.json ] || complain "no results after a full standard output"
{ sleep 0.2; "$MOTEHOUND" list --keys 2>err.txt; echo $? >status.txt; } | true
refuses_stdout "$(cat status.txt)" gone
"$MOTEHOUND" run luo_exp1 "${small[@]}" --out closed <&- >&- 2>&- || complain "closed standard streams"
diff -r streams closed >/dev/null || complain "closed standard streams change the results"

# a folder that cannot be written is refused before anything is simulated
echo file >plain
began=$SECONDS
refused '^plain: cannot write into this folder: Not a directory' "$MOTEHOUND" run luo_exp1 --runs 100000 --out plain
refused '^plain/deeper: cannot write into this folder: ' "$MOTEHOUND" run luo_exp1 --runs 100000 --out plain/deeper
refused '^/proc/motehound: cannot write into this folder: ' "$MOTEHOUND" run luo_exp1 --runs 100000 --out /proc/motehound
[ $((SECONDS - began)) -lt 20 ] || complain "simulated before the folder was tried"

# an interrupt in mid-run
for signal in INT TERM HUP; do
    "$MOTEHOUND" run luo_exp1 --set tracker.name=luo --runs 100000 --log --jobs 2 --out stopped >out.txt 2>err.txt &
    process=$!
    for _ in $(seq 100); do [ -n "$(find . -maxdepth 1 -name '.stopped.partial*')" ] && break; sleep 0.1; done
    sleep 0.3
    kill -$signal $process
    wait $process
    status=$?
    [ $status -eq 1 ] || complain "status $status after SIG$signal"
    [ "$(cat err.txt)" = "motehound: interrupted, nothing was written to stopped" ] || complain "after SIG$signal: $(cat err.txt)"
    nothing stopped
done
refused '^--pace: expected a number' "$MOTEHOUND" run luo_exp1 --pace 0
refused '^--respawn: expected --workers or --join' "$MOTEHOUND" run luo_exp1 --respawn
refused '^--pace: expected --bus' "$MOTEHOUND" run luo_exp1 --pace 1
conclude
