#!/usr/bin/env python3
"""Fixed point against float on the same inputs: the same scenarios and seeds through both builds of `motehound`.

    compare.py FIXED FLOAT

The root mean square position error of each differs by at most 2 %, and no number saturates. Luo's tracker and `dm` follow the same course in both; particles are drawn
from other numbers, so the means of 200 runs, whose standard errors are 0.4 %, are compared. A source that releases a thousand times as much as Luo's saturates
sensors, and the tracker in fixed point: both are counted. Exit status 77 where there is no float build."""

import json
import os
import subprocess
import sys
import tempfile

# scenario, tracker, runs
CASES = [("luo_exp1", "luo", 10), ("zhou_nominal", "pftl", 200), ("zhou_nominal", "centroid", 10), ("han_turn", "dm", 4)]
LARGEST_SHARE = 0.02


def run(command, scenario, tracker, runs, *more):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        subprocess.run([command, "run", scenario, "--set", "tracker.name=" + tracker, "--runs", str(runs), "--jobs", "2", "--out", out, *more],
                       check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(out, "summary.json")) as file:
            metrics = json.load(file)["metrics"]
    return [metrics[name]["mean"] if name in metrics else None for name in ("position_rmse_m", "saturations", "measurements_saturated")]


def main():
    fixed, floating = sys.argv[1:]
    if not os.access(floating, os.X_OK):
        print("skipped: no %s (build the preset host)" % floating)
        return 77
    failed = False
    for scenario, tracker, runs in CASES:
        (error_fixed, *saturated), (error_float, *_) = run(fixed, scenario, tracker, runs), run(floating, scenario, tracker, runs)
        share = error_fixed / error_float - 1
        failed = failed or abs(share) > LARGEST_SHARE or any(saturated)
        print("%-13s %-9s %3d runs: %.4f m in fixed point, %.4f m in float: %+.3f %%"
              % (scenario, tracker, runs, error_fixed, error_float, 100 * share))
    _, steps, measurements = run(fixed, "luo_exp1", "luo", 1, "--set", "source.release_gps=1e5")
    print("luo_exp1 with 1e5 g/s: %g measurements and %g steps saturated" % (measurements, steps))
    return 1 if failed or steps == 0 or measurements == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
