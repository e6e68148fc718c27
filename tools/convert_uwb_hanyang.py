#!/usr/bin/env python3
"""Converts one recording of Hanyang University's outdoor UWB data set (github.com/cucudasluv/UWB-dataset, Scientific Data 2025) for
`motehound replay --tracker range`.

A recording is a folder with A3.csv, A5.csv, A9.csv and A12.csv (an anchor each: its place and the ranges to the tag) and
trajectory.csv (RTK positions of the tag). Ranges are taken as measured, at the time stamp of the sensor's own message; time
begins with the first range."""

import argparse
import sys

from recording_csv import Refused, read_columns, run, write_recording

ANCHORS = (3, 5, 9, 12)
COLUMNS = ["field.stamp", "field.id", "field.x", "field.y", "field.z", "field.distanceFromTag"]
LONGEST_M = 2047


def read_anchor(path, anchor):
    place, ranges = None, []
    for line, (stamp, identity, x, y, z, distance) in read_columns(path, COLUMNS):
        if identity != anchor:
            raise Refused(f"{path}:{line}: field.id: {identity:g}, expected {anchor}")
        if place not in (None, (x, y, z)):
            raise Refused(f"{path}:{line}: the anchor is at another place than in the line before")
        if not 0 < distance <= LONGEST_M:
            raise Refused(f"{path}:{line}: field.distanceFromTag: {distance:g} m, expected above 0 and at most {LONGEST_M}")
        place = (x, y, z)
        ranges.append((stamp, anchor, distance))
    if place is None:
        raise Refused(f"{path}: no ranges")
    return place, ranges


def convert(arguments):
    nodes, ranges = [], []
    for anchor in ANCHORS:
        place, heard = read_anchor(f"{arguments.recording}/A{anchor}.csv", anchor)
        nodes.append((anchor, *place))
        ranges += heard
    ranges.sort()
    start = ranges[0][0]
    truth = [((stamp - start) * 1e-9, x, y)
             for _, (stamp, x, y) in read_columns(f"{arguments.recording}/trajectory.csv", ["timestamp", "x", "y"])
             if stamp >= start]
    if not truth:
        raise Refused(f"{arguments.recording}/trajectory.csv: no position after the first range")
    write_recording(arguments.out, nodes, [((stamp - start) * 1e-9, *rest) for stamp, *rest in ranges], truth)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", help="folder with A3.csv, A5.csv, A9.csv, A12.csv and trajectory.csv")
    parser.add_argument("out", help="folder for nodes.csv, readings.csv and truth.csv; made if it does not exist")
    return run(convert, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
