#!/usr/bin/env python3
"""Converts a week of the Methane Emissions Technology Evaluation Center's ADED campaign (Daniels, Jia and Hammerling, 2024;
github.com/wsdaniels/DLQ) for `motehound replay --tracker gas --candidates`: a folder for each release from a single source, called as the experiment, with
nodes.csv (the sensors), readings.csv (methane in ppm and the wind, once a minute, from --lead before the release to its end), truth.csv (place
and rate) and candidates.csv (the groups of equipment); and releases.csv, which lists them.

A recording is a folder with sensor_locations.csv and source_locations.csv (lon,lat,height,name), obs_wind_*.csv (epoch_utc_s,CH4_ppm_NAME...,
wind_speed_mps,wind_toward_rad_ccw_from_east; a missing reading is empty) and leak_data.csv. Coordinates are metres to the east and north of --latitude,
--longitude. Rates in g/h become mL/s by the density of methane at the site: 0.565 kg/m3 at 84.3 kPa and 15 C."""

import argparse
import glob
import math
import os
import sys
from datetime import datetime, timezone

from recording_csv import Refused, number, read_rows, run, write_tables

METRES_PER_DEGREE = math.radians(6_371_000)
GROUPS = {"4T": "Tank", "5S": "Separator.East", "5W": "Wellhead.East", "4W": "Wellhead.West", "4S": "Separator.West"}
SPEED, TOWARD = "wind_speed_mps", "wind_toward_rad_ccw_from_east"
RELEASE = ["tc_ExperimentID", "tc_EquipmentGroupID", "tc_ExpEPCount", "tc_ExpStartDatetime", "tc_ExpEndDatetime", "tc_Longitude",
           "tc_Latitude", "tc_C1MassFlow"]


def east_north(arguments, longitude, latitude):
    across = METRES_PER_DEGREE * math.cos(math.radians(arguments.latitude))
    return across * (longitude - arguments.longitude), METRES_PER_DEGREE * (latitude - arguments.latitude)


def places(arguments, name):
    """[(name, x, y, height), ...] in the order of the file."""
    path = os.path.join(arguments.recording, name)
    found = []
    for line, (longitude, latitude, height, label) in read_rows(path, ["lon", "lat", "height", "name"], "utf-8-sig"):
        x, y = east_north(arguments, number(path, line, "lon", longitude), number(path, line, "lat", latitude))
        found.append((label, x, y, number(path, line, "height", height)))
    return found


def minutes(arguments, names):
    """[(epoch, [ppm or None, ...], speed, toward), ...]"""
    files = sorted(glob.glob(os.path.join(arguments.recording, "obs_wind_*.csv")))
    if len(files) != 1:
        raise Refused(f"{arguments.recording}: {len(files)} files obs_wind_*.csv, expected one")
    path, columns = files[0], [f"CH4_ppm_{name}" for name in names]
    rows = []
    for line, row in read_rows(path, ["epoch_utc_s", SPEED, TOWARD] + columns):
        epoch, speed, toward = (number(path, line, name, text) for name, text in zip(["epoch_utc_s", SPEED, TOWARD], row))
        ppm = [number(path, line, name, text) if text else None for name, text in zip(columns, row[3:])]
        if rows and epoch <= rows[-1][0]:
            raise Refused(f"{path}:{line}: epoch_utc_s: {epoch:.0f}, expected more than {rows[-1][0]:.0f}, the time before")
        rows.append((epoch, ppm, speed, toward))
    if not rows:
        raise Refused(f"{path}: no readings")
    return rows


def when(path, line, name, text):
    try:
        date = datetime.fromisoformat(text)
        return (date if date.tzinfo else date.replace(tzinfo=timezone.utc)).timestamp()
    except ValueError:
        raise Refused(f"{path}:{line}: {name}: `{text}`, expected a date and time") from None


def releases(arguments, first, last):
    """[(experiment, group, begin, end, x, y, mL/s), ...] of those from a single source that begin within the readings, in order of time."""
    path = os.path.join(arguments.recording, "leak_data.csv")
    found = []
    for line, (experiment, group, sources, begin, end, longitude, latitude, flow) in read_rows(path, RELEASE):
        begin_s, end_s = when(path, line, RELEASE[3], begin), when(path, line, RELEASE[4], end)
        if number(path, line, RELEASE[2], sources) != 1 or not first <= begin_s < last:
            continue
        if group not in GROUPS:
            raise Refused(f"{path}:{line}: {RELEASE[1]}: `{group}`, expected one of {', '.join(GROUPS)}")
        if not experiment.isalnum():
            raise Refused(f"{path}:{line}: {RELEASE[0]}: `{experiment}`, expected letters and digits")
        x, y = east_north(arguments, number(path, line, RELEASE[5], longitude), number(path, line, RELEASE[6], latitude))
        rate = number(path, line, RELEASE[7], flow) / 3600 / arguments.density * 1000
        found.append((experiment, GROUPS[group], begin_s, end_s, x, y, rate))
    if not found:
        raise Refused(f"{path}: no release from a single source begins within the readings")
    return sorted(found, key=lambda release: release[2])


def convert(arguments):
    sensors, sources = places(arguments, "sensor_locations.csv"), places(arguments, "source_locations.csv")
    rows = minutes(arguments, [sensor[0] for sensor in sensors])
    nodes = [(i + 1, *sensor[1:]) for i, sensor in enumerate(sensors)]
    candidates = [(i + 1, *source[1:3]) for i, source in enumerate(sources)]
    numbers = {source[0]: i + 1 for i, source in enumerate(sources)}
    listed = []
    for experiment, group, begin, end, x, y, rate in releases(arguments, rows[0][0], rows[-1][0]):
        if group not in numbers:
            raise Refused(f"{arguments.recording}/source_locations.csv: no `{group}`")
        kept = [row for row in rows if begin - 60 * arguments.lead <= row[0] < end]
        readings = [(epoch - kept[0][0], node, ppm, speed, toward) for epoch, values, speed, toward in kept
                    for (node, *_), ppm in zip(nodes, values) if ppm is not None]
        truth = [(max(begin - kept[0][0], 0), x, y, rate), (kept[-1][0] - kept[0][0], x, y, rate)]
        write_tables(os.path.join(arguments.out, experiment), [
            ("nodes.csv", "node,x_m,y_m,z_m", nodes, "{},{:.4f},{:.4f},{:.4f}"),
            ("readings.csv", "time_s,node,value,wind_speed_mps,wind_toward_rad", readings, "{:.3f},{},{:.6f},{:.4f},{:.4f}"),
            ("truth.csv", "time_s,x_m,y_m,rate_mlps", truth, "{:.3f},{:.4f},{:.4f},{:.4f}"),
            ("candidates.csv", "place,x_m,y_m", candidates, "{},{:.4f},{:.4f}"),
        ])
        date = datetime.fromtimestamp(begin, timezone.utc).strftime("%Y-%m-%dT%H:%M")
        listed.append((experiment, date, (end - begin) / 3600, numbers[group], group, rate))
    write_tables(arguments.out, [("releases.csv", "release,begin_utc,hours,place,name,rate_mlps", listed, "{},{},{:.2f},{},{},{:.1f}")])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", help="folder with the four files")
    parser.add_argument("out", help="folder for the releases' folders; made if it does not exist")
    parser.add_argument("--lead", type=float, default=60, help="minutes before a release that are kept (default: %(default)s)")
    parser.add_argument("--density", type=float, default=0.565, help="of methane at the site, kg/m3 (default: %(default)s)")
    parser.add_argument("--latitude", type=float, default=40.5958, help="of the origin (default: %(default)s)")
    parser.add_argument("--longitude", type=float, default=-105.1399, help="of the origin (default: %(default)s)")
    arguments = parser.parse_args()
    if not (arguments.lead >= 0 and arguments.density > 0 and abs(arguments.latitude) < 89):
        parser.error("expected --lead of at least 0, --density above 0 and --latitude within 89 degrees")
    return run(convert, arguments)


if __name__ == "__main__":
    sys.exit(main())
