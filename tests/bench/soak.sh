#!/bin/sh
# The scenario faults_soak on the program given: soak.sh PROGRAM [hours; all 24 without]. Fails if the program does (sanitizers that find something
# make it), or if the counters contradict each other.
set -eu
program=$1
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
if [ "${2:-24}" = 1 ]; then
    set -- --set "source.points=10,10; 10,110; 35,110; 35,10; 60,10; 60,110; 85,110; 85,10; 110,10; 110,110; 85,110; 85,15"
else
    set --
fi
"$program" run faults_soak --runs 1 --out "$out/soak" "$@"
awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) name[i] = $i }
    NR == 2 { for (i = 1; i <= NF; i++) value[name[i]] = $i }
    function expect(holds, what) { if (!holds) { print "soak: " what; bad = 1 } }
    END {
        split("collision random deaf asleep dead jammed partition mute range", reasons, " ")
        for (i in reasons) lost += value["frames_lost_" reasons[i]]
        expect(lost == value["frames_lost"], "losses by reason do not add up")
        expect(value["frames_received"] > 0 && value["estimates"] > 0, "nothing was received or tracked")
        expect(value["frames_repeated"] <= value["frames_sent"], "more repetitions than frames")
        expect(value["measurements"] <= value["reports"], "more measurements than reports")
        expect(value["reports_asked"] <= value["reports"], "more asked for than reported")
        split("random dead jammed partition mute", struck, " ")
        for (i in struck) expect(value["frames_lost_" struck[i]] > 0, "no frame lost: " struck[i])
        expect(value["overconfident_samples"] <= 10, value["overconfident_samples"] " overconfident samples")
        exit bad
    }' "$out/soak/runs.csv"
