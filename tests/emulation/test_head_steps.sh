#!/bin/bash
# The default trackers of releases as whole images on the Cortex-M4F and M33, heads of a run: how long their steps take, an instruction a cycle, and that the
# track is the same. $BUILDS is the folder of all builds, whose firmware/apps have the images. Boards that are not there are left out, unless $ALL_BOARDS says
# that they must be; with $NO_BOARDS all are.
. "$(dirname "$0")/../network/common.sh"
boards=()
mkdir images
for board in cortex-m4f cortex-m33; do
    if [ -z "$NO_BOARDS" ] && command -v qemu-system-arm >/dev/null && [ -e "$BUILDS/$board/firmware/apps/cluster_head_gas" ]; then
        ln -s "$BUILDS/$board/firmware/apps" "images/$board"
        boards+=("$board")
    elif [ -n "$ALL_BOARDS" ]; then
        complain "no qemu-system-arm or no images of $board"
    else
        echo "skipped: no image of $board, or no qemu-system-arm"
    fi
done
export MOTEHOUND_IMAGES=$PWD/images

# in_time FOLDER: every head's steps within 100 ms in the median and 500 ms at most
in_time() {
    python3 - "$1" <<'END' || complain "$1: a head takes too long, or has no steps"
import json, sys
boards = json.load(open(sys.argv[1] + "/summary.json"))["boards"]
took = [[1e3 * board["steps"][key] / board["rate_hz"] for key in ("cycles_median", "cycles_max")] for board in boards]
sys.exit(not took or any(median > 100 or longest > 500 for median, longest in took))
END
}

# close NATIVE EMULATED METRES: the same heads at the same times, places as near as that
close() {
    paste -d, "$1/track.csv" "$2/track.csv" | awk -F, -v metres="$3" '
        NR == 1 {n = NF / 2; for (i = 1; i <= n; i++) at[$i] = i; next}
        {lines++; split("time_s x_m y_m head", names, " ")
         for (k in names) {d = $at[names[k]] - $(n + at[names[k]]); if (d > metres || d < -metres) exit bad = 1}}
        END {exit bad || lines < 3}' || complain "$2/track.csv is not that of $1"
}

declare -A speed=([cortex-m4f]=1 [cortex-m33]=4) # of the source, m/s: the whole minute and a half on one board is enough
for board in "${boards[@]}"; do
    release=(luo_exp1 --set "source.speed_mps=${speed[$board]}")
    accepted "$MOTEHOUND" run "${release[@]}" --out "native_$board"
    accepted "$MOTEHOUND" run "${release[@]}" --out "diffusion_$board" --emulate "1280=$board"
    grep '^node' out.txt
    close "native_$board" "diffusion_$board" 1e-3
    in_time "diffusion_$board"
done

# its heads one after the other, on one board or the other, until the leak is found
if [ ${#boards[@]} -gt 0 ]; then
    on=()
    for head in 35 72 12 17 7 46 70 42 23 44 75; do
        on+=(--emulate "$head=${boards[${#on[@]} / 2 % ${#boards[@]}]}")
    done
    accepted "$MOTEHOUND" run zhang_real --set source.duration_s=75 --out gas "${on[@]}"
    grep '^node' out.txt
    in_time gas
    tail -1 gas/track.csv | cut -d, -f4,5 | awk -F, '{exit !(($1 - 50) ^ 2 + ($2 - 200) ^ 2 < 2 ^ 2)}' || complain "the leak is not found"
fi
conclude
