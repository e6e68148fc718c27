#!/usr/bin/env python3
"""Converts one recording of Carnegie Mellon University's Plaza data set (a lawn mower with a radio among four others; Djugash and Singh) for
`motehound replay --tracker range`.

A recording is a folder with NAME_anchors.csv (anchor_id,x_m,y_m), NAME_ranges.csv (t_s,sender,anchor_id,range_m) and NAME_truth.csv
(t_s,x_m,y_m,heading_rad). Ranges are taken as measured; anchors and target are in one plane, z = 0; time begins with the first range."""

import argparse
import sys

from recording_csv import Refused, read_columns, run, write_recording

LONGEST_M = 2047


def convert(arguments):
    stem = f"{arguments.recording}/{arguments.name}"
    nodes = []
    for line, (anchor, x, y) in read_columns(f"{stem}_anchors.csv", ["anchor_id", "x_m", "y_m"]):
        if anchor != int(anchor) or anchor < 0:
            raise Refused(f"{stem}_anchors.csv:{line}: anchor_id: {anchor:g}, expected a whole number")
        nodes.append((int(anchor), x, y, 0))
    known = {anchor for anchor, *_ in nodes}
    ranges = []
    for line, (time, anchor, distance) in read_columns(f"{stem}_ranges.csv", ["t_s", "anchor_id", "range_m"]):
        if anchor not in known:
            raise Refused(f"{stem}_ranges.csv:{line}: anchor_id: {anchor:g}, expected one of {stem}_anchors.csv")
        if not -LONGEST_M <= distance <= LONGEST_M:
            raise Refused(f"{stem}_ranges.csv:{line}: range_m: {distance:g}, expected {-LONGEST_M} to {LONGEST_M}")
        ranges.append((time, int(anchor), distance))
    if not ranges:
        raise Refused(f"{stem}_ranges.csv: no ranges")
    ranges.sort()
    start = ranges[0][0]
    truth = [(time - start, x, y) for _, (time, x, y) in read_columns(f"{stem}_truth.csv", ["t_s", "x_m", "y_m"])
             if time >= start]
    if not truth:
        raise Refused(f"{stem}_truth.csv: no position after the first range")
    write_recording(arguments.out, nodes, [(time - start, anchor, distance) for time, anchor, distance in ranges], truth)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", help="folder with NAME_anchors.csv, NAME_ranges.csv and NAME_truth.csv")
    parser.add_argument("out", help="folder for nodes.csv, readings.csv and truth.csv; made if it does not exist")
    parser.add_argument("--name", default="Plaza1", help="of the recording (default: %(default)s)")
    return run(convert, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
