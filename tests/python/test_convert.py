"""The converters of tools/: known small recordings, refusals, and the whole way of the UWB recording through `motehound replay`.

Standard library only, as the converters. MOTEHOUND: the command; MOTEHOUND_SHARED_DATA: the folder of real recordings."""

import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"
DATA = Path(os.environ.get("MOTEHOUND_SHARED_DATA", "/nowhere"))
COMMAND = os.environ.get("MOTEHOUND", "")

ANCHOR_HEADER = "%time,field.stamp,field.id,field.x,field.y,field.z,field.distanceFromTag,field.rssi,field.rssi_fp\n"
START = 1734501485317395687


def convert(name, *arguments):
    return subprocess.run([sys.executable, "-B", TOOLS / f"convert_{name}.py", *map(str, arguments)],
                          capture_output=True, text=True, check=False)


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.out = self.folder / "out"

    def assert_refused(self, result, expected):
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(expected, result.stderr)
        self.assertEqual(list(self.out.glob("*")) + list(self.out.glob(".*")), [])


class Uwb(Case):
    def setUp(self):
        super().setUp()
        for i, anchor in enumerate((3, 5, 9, 12)):
            rows = [f"0,{START + 1_000_000 * (100 * k + i)},{anchor},{i}.5,-1,{i},{5 + i + k}.25,-80,-81\n" for k in range(2)]
            (self.folder / f"A{anchor}.csv").write_text(ANCHOR_HEADER + "".join(rows))
        (self.folder / "trajectory.csv").write_text(
            f"timestamp,x,y,z,heading_degrees\n{START - 5e8},9,9,0,0\n{START + 5e8},1.5,-2,0,0\n")

    def test_known_recording(self):
        result = convert("uwb_hanyang", self.folder, self.out)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual((self.out / "nodes.csv").read_text().splitlines(),
                         ["node,x_m,y_m,z_m", "3,0.5000,-1.0000,0.0000", "5,1.5000,-1.0000,1.0000",
                          "9,2.5000,-1.0000,2.0000", "12,3.5000,-1.0000,3.0000"])
        self.assertEqual((self.out / "readings.csv").read_text().splitlines()[:3],
                         ["time_s,node,value", "0.000,3,5.250000", "0.001,5,6.250000"])
        self.assertEqual((self.out / "readings.csv").read_text().splitlines()[-1], "0.103,12,9.250000")
        # the position before the first range is left out
        self.assertEqual((self.out / "truth.csv").read_text().splitlines(), ["time_s,x_m,y_m", "0.500,1.5000,-2.0000"])

    def test_refusals(self):
        for text, expected in (
                (None, "A9.csv: No such file"),
                ("", "A9.csv: empty"),
                ("a,b\n", "A9.csv:1: no column `field.stamp`"),
                (ANCHOR_HEADER, "A9.csv: no ranges"),
                (ANCHOR_HEADER + "0,1,9,1,1,1,5,0,0\n0,2,9\n", "A9.csv:3: 3 columns, expected 9"),
                (ANCHOR_HEADER + "0,1,9,1,1,1,nan,0,0\n", "A9.csv:2: field.distanceFromTag: `nan`, expected a finite number"),
                (ANCHOR_HEADER + "0,1,9,1,1,1,far,0,0\n", "A9.csv:2: field.distanceFromTag: `far`"),
                (ANCHOR_HEADER + "0,1,9,1,1,1,-5,0,0\n", "A9.csv:2: field.distanceFromTag: -5 m"),
                (ANCHOR_HEADER + "0,1,7,1,1,1,5,0,0\n", "A9.csv:2: field.id: 7, expected 9"),
                (ANCHOR_HEADER + "0,1,9,1,1,1,5,0,0\n0,2,9,1,1,2,5,0,0\n", "A9.csv:3: the anchor is at another place")):
            with self.subTest(expected):
                (self.folder / "A9.csv").unlink(missing_ok=True)
                if text is not None:
                    (self.folder / "A9.csv").write_text(text)
                self.assert_refused(convert("uwb_hanyang", self.folder, self.out), expected)

    def test_folder_that_cannot_be_made(self):
        self.out.write_text("a file")
        result = convert("uwb_hanyang", self.folder, self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn(str(self.out), result.stderr)
        self.assertEqual(self.out.read_text(), "a file")

    @unittest.skipUnless((DATA / "uwb_hanyang").is_dir(), f"no recording in {DATA}")
    @unittest.skipUnless(COMMAND, "the command motehound is not built")
    def test_replay_beats_the_published_error(self):
        self.assertEqual(convert("uwb_hanyang", DATA / "uwb_hanyang/LOS_A_case1", self.out).returncode, 0)
        subprocess.run([COMMAND, "replay", "--nodes", self.out / "nodes.csv", "--readings", self.out / "readings.csv",
                        "--truth", self.out / "truth.csv", "--tracker", "range", "--out", self.folder / "replay"],
                       check=True, capture_output=True)
        metrics = json.loads((self.folder / "replay/summary.json").read_text())["metrics"]
        self.assertLess(metrics["position_rmse_m"]["mean"], 0.8095)
        self.assertTrue(0.5 < metrics["nees_median"]["mean"] < 3)
        self.assertEqual(metrics["track_lost"]["mean"], 0)


class Plaza(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "Small_anchors.csv").write_text("anchor_id,x_m,y_m\n6.0,-4,2.5\n1.0,3,0\n")
        self.ranges("100.5,2.0,6.0,7.25\n99.0,2.0,1.0,-0.5\n")
        (self.folder / "Small_truth.csv").write_text("t_s,x_m,y_m,heading_rad\n98,9,9,0\n99.5,1,2,3\n")

    def ranges(self, rows):
        (self.folder / "Small_ranges.csv").write_text("t_s,sender,anchor_id,range_m\n" + rows)

    def test_known_recording(self):
        result = convert("plaza", self.folder, self.out, "--name", "Small")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual((self.out / "nodes.csv").read_text().splitlines(),
                         ["node,x_m,y_m,z_m", "6,-4.0000,2.5000,0.0000", "1,3.0000,0.0000,0.0000"])
        self.assertEqual((self.out / "readings.csv").read_text().splitlines(),
                         ["time_s,node,value", "0.000,1,-0.500000", "1.500,6,7.250000"])
        # the position before the first range is left out
        self.assertEqual((self.out / "truth.csv").read_text().splitlines(), ["time_s,x_m,y_m", "0.500,1.0000,2.0000"])

    def test_refusals(self):
        for rows, expected in (("", "no ranges"), ("1,2,7,5\n", "_ranges.csv:2: anchor_id: 7, expected one of"),
                               ("1,2,1,2048\n", "_ranges.csv:2: range_m: 2048, expected -2047 to 2047"),
                               ("1,2,1,nan\n", "_ranges.csv:2: range_m: `nan`, expected a finite number"),
                               ("1000,2,1,5\n", "_truth.csv: no position after the first range")):
            with self.subTest(expected):
                self.ranges(rows)
                self.assert_refused(convert("plaza", self.folder, self.out, "--name", "Small"), expected)

    @unittest.skipUnless((DATA / "plaza").is_dir(), f"no recording in {DATA}")
    @unittest.skipUnless(COMMAND, "the command motehound is not built")
    def test_replay_learns_scale_and_biases(self):
        self.assertEqual(convert("plaza", DATA / "plaza", self.out).returncode, 0)
        subprocess.run([COMMAND, "replay", "--nodes", self.out / "nodes.csv", "--readings", self.out / "readings.csv",
                        "--truth", self.out / "truth.csv", "--scenario", TOOLS.parent / "examples/plaza1.yaml",
                        "--out", self.folder / "replay"], check=True, capture_output=True)
        metrics = json.loads((self.folder / "replay/summary.json").read_text())["metrics"]
        self.assertLess(metrics["position_rmse_m"]["mean"], 1.5)
        self.assertTrue(0.5 < metrics["nees_median"]["mean"] < 3)


class Metec(Case):
    COLUMNS = ("tc_ExperimentID,tc_EquipmentGroupID,tc_ExpEPCount,tc_ExpStartDatetime,tc_ExpEndDatetime,tc_Longitude,tc_Latitude,"
               "tc_C1MassFlow\n")

    def setUp(self):
        super().setUp()
        (self.folder / "sensor_locations.csv").write_text("\ufefflon,lat,height,name\n-105.1399,40.5968,2.4,N\n-105.1389,40.5958,3,E")
        (self.folder / "source_locations.csv").write_text("\ufefflon,lat,height,name\n-105.1399,40.5958,4,Tank\n")
        self.minutes("".join(f"{60 * i},{2 + i}.5,{'' if i == 2 else 7},1.5,3.1\n" for i in range(6)))
        self.leaks("7,4T,1,1970-01-01 00:02:00+00:00,1970-01-01 00:04:30+00:00,-105.1399,40.5968,1000\n")

    def minutes(self, rows):
        (self.folder / "obs_wind_day.csv").write_text(
            "epoch_utc_s,CH4_ppm_E,CH4_ppm_N,wind_speed_mps,wind_toward_rad_ccw_from_east\n" + rows)

    def leaks(self, rows):
        (self.folder / "leak_data.csv").write_text(self.COLUMNS + rows)

    def test_known_recording(self):
        result = convert("metec", self.folder, self.out, "--lead", "1", "--density", "0.5")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual((self.out / "releases.csv").read_text().splitlines(),
                         ["release,begin_utc,hours,place,name,rate_mlps", "7,1970-01-01T00:02,0.04,1,Tank,555.6"])
        self.assertEqual((self.out / "7/nodes.csv").read_text().splitlines(),
                         ["node,x_m,y_m,z_m", "1,0.0000,111.1949,2.4000", "2,84.4324,0.0000,3.0000"])
        # from a minute before the release to its end; the reading that is missing is left out
        self.assertEqual((self.out / "7/readings.csv").read_text().splitlines(),
                         ["time_s,node,value,wind_speed_mps,wind_toward_rad", "0.000,1,7.000000,1.5000,3.1000",
                          "0.000,2,3.500000,1.5000,3.1000", "60.000,2,4.500000,1.5000,3.1000"] +
                         [row for i in (3, 4) for row in (f"{60 * i - 60}.000,1,7.000000,1.5000,3.1000",
                                                          f"{60 * i - 60}.000,2,{2 + i}.500000,1.5000,3.1000")])
        self.assertEqual((self.out / "7/truth.csv").read_text().splitlines(),
                         ["time_s,x_m,y_m,rate_mlps", "60.000,0.0000,111.1949,555.5556", "180.000,0.0000,111.1949,555.5556"])
        self.assertEqual((self.out / "7/candidates.csv").read_text().splitlines(), ["place,x_m,y_m", "1,0.0000,0.0000"])

    def test_refusals(self):
        leak = "7,4T,1,1970-01-01 00:02:00+00:00,1970-01-01 00:04:30+00:00,-105.1399,40.5968,1000\n"
        for change, rows, expected in (
                (self.leaks, leak.replace(",4T,1", ",4T,2"), "leak_data.csv: no release from a single source"),
                (self.leaks, leak.replace("4T", "9T"), "leak_data.csv:2: tc_EquipmentGroupID: `9T`, expected one of 4T"),
                (self.leaks, leak.replace("4T", "5S"), "source_locations.csv: no `Separator.East`"),
                (self.leaks, leak.replace("7,", "../7,", 1), "leak_data.csv:2: tc_ExperimentID: `../7`"),
                (self.leaks, leak.replace("1970-01-01 00:02:00+00:00", "noon"), "tc_ExpStartDatetime: `noon`, expected a date"),
                (self.leaks, leak.replace("1000", "much"), "leak_data.csv:2: tc_C1MassFlow: `much`, expected a finite number"),
                (self.minutes, "", "obs_wind_day.csv: no readings"),
                (self.minutes, "60,1,1,1,1\n60,1,1,1,1\n", "obs_wind_day.csv:3: epoch_utc_s: 60, expected more than 60"),
                (self.minutes, "60,x,1,1,1\n", "obs_wind_day.csv:2: CH4_ppm_E: `x`, expected a finite number")):
            with self.subTest(expected):
                self.setUp()
                change(rows)
                self.assert_refused(convert("metec", self.folder, self.out), expected)

    @unittest.skipUnless((DATA / "metec_aded2022").is_dir(), f"no recording in {DATA}")
    @unittest.skipUnless(COMMAND, "the command motehound is not built")
    def test_replay_finds_the_group_that_leaks(self):
        self.assertEqual(convert("metec", DATA / "metec_aded2022", self.out).returncode, 0)
        with open(self.out / "releases.csv", encoding="utf-8", newline="") as file:
            releases = list(csv.DictReader(file))
        self.assertEqual(len(releases), 16)
        right, ratios = 0, []
        for release in releases:
            folder = self.out / release["release"]
            result = subprocess.run([COMMAND, "replay", "--nodes", folder / "nodes.csv", "--readings", folder / "readings.csv",
                                     "--truth", folder / "truth.csv", "--candidates", folder / "candidates.csv",
                                     "--scenario", TOOLS.parent / "examples/metec.yaml", "--out", self.folder / "replay"],
                                    check=True, capture_output=True, text=True)
            right += f"(place {release['place']})" in result.stdout
            ratios.append(json.loads((self.folder / "replay/summary.json").read_text())["metrics"]["rate_ratio"]["mean"])
        self.assertGreaterEqual(right, 14)
        self.assertTrue(0.8 < statistics.median(ratios) < 1.25, ratios)


class Orebro(Case):
    def write(self, rows, name="Exp05.csv"):
        grid = [f"C_{i}{j}{k} (ppm)" for i in range(3) for j in range(3) for k in range(3)]
        text = ",".join(["# t (s)", *grid, "T_1 (\u00b0C)"]) + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
        (self.folder / name).write_text(text, encoding="mac_roman")
        return self.folder / name

    def test_known_log(self):
        log = self.write([[t, *range(27), 22] for t in (10.0, 10.5, 11.0)])
        self.assertEqual(convert("orebro3dsen", log, self.out, "--every", "2").returncode, 0)
        nodes = (self.out / "nodes.csv").read_text().splitlines()
        readings = (self.out / "readings.csv").read_text().splitlines()
        self.assertEqual((len(nodes), len(readings)), (28, 55))
        self.assertIn("120,3.0000,5.0000,0.4500", nodes)
        self.assertEqual((readings[16], readings[-1]), ("0.000,120,15.000000", "1.000,222,26.000000"))
        self.assertEqual((self.out / "truth.csv").read_text().splitlines()[1:], ["0.000,2.7000,2.7000", "1.000,2.7000,2.7000"])

    def test_other_places(self):
        log = self.write([[0, *range(27), 22]], "mine.csv")
        self.assert_refused(convert("orebro3dsen", log, self.out), "--source must say")
        result = convert("orebro3dsen", log, self.out, "--source", "1,2,0", "--y", "0.8,2.5,4.2")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("120,3.0000,4.2000,0.4500", (self.out / "nodes.csv").read_text())

    def test_refusals(self):
        for rows, expected in (([], "no readings"),
                               ([[1, *range(27), 22], [1, *range(27), 22]], ":3: t: 1 s, expected after 1"),
                               ([[1, *[9999] * 27, 22]], ":2: C_000: 9999 ppm"),
                               ([[1, *[""] * 27, 22]], ":2: C_000 (ppm): ``, expected a finite number")):
            with self.subTest(expected):
                self.assert_refused(convert("orebro3dsen", self.write(rows), self.out), expected)
        self.assertEqual(convert("orebro3dsen", self.write([]), self.out, "--x", "1,2").returncode, 2)


if __name__ == "__main__":
    unittest.main()
