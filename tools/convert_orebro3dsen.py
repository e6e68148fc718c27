#!/usr/bin/env python3
"""Converts one log of the Orebro3DSEN data set (github.com/jburgues/Orebro3DSEN) for `motehound replay`: 27 metal-oxide gas sensors in a
3 x 3 x 3 grid in an office of 30 m2, two readings a second, an evaporating source that stands still.

Values stay in ppm, as calibrated by the authors. Node ijk is the sensor of column C_ijk.

Where the sensors are: the logs name grid indices only, and the data set shows their places in a drawing. The heights 0.45, 1.20 and
2.23 m are those of the authors' plotting code (wsn_lite.py), which draws the maps on 6 m x 6 m with a sensor in the middle of each
third; so x and y are ASSUMED to be 1, 3 and 5 m. --x, --y and --z take other places."""

import argparse
import os
import sys

from recording_csv import Refused, read_columns, run, write_recording

# x, y, z in m, from the data set's table of experiments
SOURCES = {
    "Exp01": (2.70, 0.50, 0.90), "Exp02": (2.70, 0.50, 0.90), "Exp03": (5.95, 1.60, 0.00), "Exp04": (0.10, 4.50, 2.00),
    "Exp05": (2.70, 2.70, 0.00), "Exp06": (2.70, 0.50, 0.90), "Exp07": (2.70, 0.10, 2.20), "Exp08": (2.70, 0.50, 0.90),
    "Exp09": (2.70, 0.50, 0.90), "Exp10": (2.70, 3.15, 1.75),
}
GRID = [(i, j, k) for i in range(3) for j in range(3) for k in range(3)]
HIGHEST_PPM = 2047


def three(text):
    values = tuple(float(part) for part in text.split(","))
    if len(values) != 3:
        raise ValueError
    return values


three.__name__ = "three numbers, as in 1,3,5"


def positive(text):
    value = int(text)
    if value < 1:
        raise ValueError
    return value


positive.__name__ = "whole number above 0"


def convert(arguments):
    name = os.path.splitext(os.path.basename(arguments.log))[0]
    source = arguments.source or SOURCES.get(name)
    if source is None:
        raise Refused(f"{arguments.log}: the file's name is not one of Exp01 to Exp10, so --source must say where the source is")
    columns = ["# t (s)"] + [f"C_{i}{j}{k} (ppm)" for i, j, k in GRID]
    readings, before, row = [], None, -1
    for line, (time, *values) in read_columns(arguments.log, columns, encoding="mac_roman"):
        if before is not None and time <= before:
            raise Refused(f"{arguments.log}:{line}: t: {time:g} s, expected after {before:g}")
        before = time
        row += 1
        if row % arguments.every:
            continue
        for (i, j, k), value in zip(GRID, values):
            if abs(value) > HIGHEST_PPM:
                raise Refused(f"{arguments.log}:{line}: C_{i}{j}{k}: {value:g} ppm, expected within +- {HIGHEST_PPM}")
            readings.append((time, 100 * i + 10 * j + k, value))
    if not readings:
        raise Refused(f"{arguments.log}: no readings")
    start, end = readings[0][0], readings[-1][0]
    nodes = [(100 * i + 10 * j + k, arguments.x[i], arguments.y[j], arguments.z[k]) for i, j, k in GRID]
    write_recording(arguments.out, nodes, [(time - start, *rest) for time, *rest in readings],
                    [(0, *source[:2]), (end - start, *source[:2])])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", help="Exp01.csv to Exp10.csv")
    parser.add_argument("out", help="folder for nodes.csv, readings.csv and truth.csv; made if it does not exist")
    parser.add_argument("--every", type=positive, default=1, metavar="N", help="keep every N-th row (default 1: 2 Hz)")
    parser.add_argument("--x", type=three, default=(1, 3, 5), metavar="X0,X1,X2", help="of the grid, m (default 1,3,5)")
    parser.add_argument("--y", type=three, default=(1, 3, 5), metavar="Y0,Y1,Y2", help="of the grid, m (default 1,3,5)")
    parser.add_argument("--z", type=three, default=(0.45, 1.20, 2.23), metavar="Z0,Z1,Z2",
                        help="of the grid, m (default 0.45,1.20,2.23)")
    parser.add_argument("--source", type=three, metavar="X,Y,Z", help="true place, m (default: by the log's name)")
    return run(convert, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
