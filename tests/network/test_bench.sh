#!/bin/bash
# motehound bench: one line of JSON a benchmark; and its scenarios, whose traffic is known beforehand.
. "$(dirname "$0")/common.sh"

# benchmark KEY...: one line that is an object with these keys.
benchmark() {
    accepted "$MOTEHOUND" bench "$name" --nodes 100 --seed 3
    [ "$(wc -l <out.txt)" -eq 1 ] || complain "bench $name: expected one line"
    grep -Eq "^\{\"name\": \"$name\", \"n\": 100, .*\}$" out.txt || complain "bench $name: $(cat out.txt)"
    for key in cpu_s events events_per_s peak_rss version "$@"; do
        grep -Eq "\"$key\": (\"[0-9.]+\"|[0-9.]*[1-9][0-9.]*)" out.txt || complain "bench $name: no $key in $(cat out.txt)"
    done
}

name=queue
benchmark
for name in s1 s2; do
    benchmark transmissions receptions us_per_transmission bytes_per_mote
done

# column NAME: of the last runs.csv
column() { awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } NR == 2 { print $at[name] }' out/runs.csv; }

accepted "$MOTEHOUND" run bench_s1 --out out
[ "$(column frames_sent_landmarks)" = 10010 ] || complain "bench_s1: 1,001 motes each send 10 frames, found $(column frames_sent_landmarks)"
accepted "$MOTEHOUND" run bench_s2 --out out
[ "$(column readings)" = 200 ] || complain "bench_s2: 20 sources sample 10 times each, found $(column readings)"
[ "$(column reports)" -ge 190 ] || complain "bench_s2: $(column reports) reports, expected 200 but for the last to come"

refused "expected queue, s1 or s2, found ''" "$MOTEHOUND" bench
refused "expected queue, s1 or s2, found 's3'" "$MOTEHOUND" bench s3
refused "found 's2' too" "$MOTEHOUND" bench s1 s2
refused "--nodes: expected a whole number 4 to 1000000, found '3'" "$MOTEHOUND" bench s1 --nodes 3
refused 'source.duration_s: expected more than 0 for a still source or none' "$MOTEHOUND" run bench_s1 --set source.duration_s=0
refused 'network.spacing_m: expected cells for 1025 nodes in the field, found 1024' "$MOTEHOUND" run bench_s1 --set network.nodes=1025
refused 'traffic.sources: expected 0 unless source.path is none' "$MOTEHOUND" run luo_exp1 --set traffic.sources=3
conclude
