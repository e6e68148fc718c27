#!/usr/bin/env python3
"""Images driven over their serial lines: test_images.py FOLDER [EMULATOR ...]

FOLDER holds the images of one board; EMULATOR is the command that runs one, with the board's line as its standard input and output.
The radio is this program: what one mote transmits the other gets. One sensor node's image is sixteen nodes, one after the other."""
import math
import struct
import sys
import unittest
from pathlib import Path

import line
from line import Board, fields

FOLDER, EMULATOR = Path(sys.argv[1]), sys.argv[2:]
SECOND = 1000  # ticks
HEAD = 1


def board(image):
    return Board(EMULATOR + [str(FOLDER / image)])


class Mote:
    """One mote on a board, in lock step."""

    def __init__(self, board, number, x_m, y_m):
        self.board, self.alarm, self.sent, self.reports = board, None, [], []
        assert board.ask(line.CONFIGURE, line.MOTE, number, x_m * 1000, y_m * 1000, 0)[0][0] == line.MH_OK

    def event(self, kind, time, *values):
        """Events until `time`, and then this one -> its status."""
        while self.alarm is not None and self.alarm < time:
            due, self.alarm = self.alarm, None
            self._take(due, line.ALARM, due)
        return self._take(time, kind, time, *values)

    def _take(self, time, kind, *values):
        (status, cycles, stack), answers = self.board.ask(kind, *values)
        transmitted = 0
        for answer, data in answers:
            if answer == line.SET_ALARM:
                self.alarm, = struct.unpack('>I', data)
            elif answer == line.TRANSMIT:
                self.sent.append((time, struct.unpack('>I', data[:4])[0], data[4:]))
                transmitted += 1
            elif answer == line.REPORT:
                self.reports.append(data)
        for _ in range(transmitted):
            self._take(time + 3, line.SENT, time + 3, 0)
        return status


def concentration(x_m, y_m, time):
    """100 g each second from (1, 7) on, at 2 m/s along x, D = 1 m2/s: g/m2 at a place."""
    total = 0
    for release in range(500, time, SECOND):
        age = (time - release) / 1000
        total += 100 / (4 * math.pi * age) * math.exp(-((x_m - release * 0.002)**2 + (y_m - 7)**2) / (4 * age))
    return total


class Images(unittest.TestCase):
    def test_identity_and_errors(self):
        with board('sensor_node') as sensor:
            identity = sensor.identify()
            self.assertEqual((identity['version'], identity['passed'], identity['senses']), (1, 1, 1))
            self.assertEqual((identity['protocol'], identity['tracker']), ('collection', ''))
            self.assertIn(b'self-test passed', sensor.text)
            self.assertEqual(sensor.ask(line.READING, 0, 0, 0)[0][0], line.MH_ERR_ARGUMENT)  # it has not begun
            self.assertEqual(sensor.ask(line.CONFIGURE, 77, 1)[0][0], line.MH_ERR_ARGUMENT)
            self.assertEqual(sensor.ask(line.CONFIGURE, line.TRACKER, 1)[0][0], line.MH_ERR_ARGUMENT)
            self.assertEqual(sensor.ask(line.CONFIGURE, line.MOTE, 1)[0][0], line.MH_ERR_CORRUPT)
            self.assertEqual(sensor.ask(99)[0][0], line.MH_ERR_CORRUPT)
            sensor.program.stdin.write(b'\x7e\x01damaged\x7e')
            self.assertEqual(sensor.ask(line.CONFIGURE, line.MOTE, 5, 0, 0, 0)[0][0], line.MH_OK)
            status, cycles, stack = sensor.ask(line.START, 0)[0]
            self.assertEqual(status, line.MH_OK)
            if identity['ram_size'] > 0:
                self.assertGreater(cycles, 100)
                self.assertTrue(50 < stack < 2048, stack)
                self.assertTrue(0 < identity['ram_static'] < identity['ram_size'] - stack)

    def test_a_head_that_hears(self):
        with board('cluster_head_dm') as head:
            identity = head.identify()
            self.assertEqual((identity['passed'], identity['protocol'], identity['tracker']), (1, 'prince', 'dm'))

    def test_it_runs_free(self):
        """By its own clock it sends a beacon, and asks for samples."""
        with board('cluster_head_luo') as head:
            head.wait_for_start()
            kinds = {head.receive()[0]}
            while not {line.SENSE, line.TRANSMIT} <= kinds:
                kinds.add(head.receive()[0])
            self.assertNotIn(line.SET_ALARM, kinds)

    def test_a_source_passes_through_sixteen_nodes(self):
        with board('cluster_head_luo') as head_board, board('sensor_node') as node_board:
            identity = head_board.identify()
            self.assertEqual(identity['tracker'], 'luo')
            node_board.identify()
            head = Mote(head_board, HEAD, 0, 0)
            self.assertEqual(head_board.ask(line.CONFIGURE, line.HEAD, 0, SECOND, 500, 0, False, 0)[0][0], line.MH_OK)
            self.assertEqual(head.event(line.START, 0), line.MH_OK)
            head.event(line.PROBE, 200)
            beacon = next(frame for _, to, frame in head.sent if to == line.BROADCAST)

            deliveries, relayed = [], 0
            for k in range(16):
                x_m, y_m = k % 4 * 4, k // 4 * 4
                node = Mote(node_board, k + 2, x_m, y_m)
                status = node_board.ask(line.CONFIGURE, line.SENSOR, 0, 1, -2**31, 2**31 - 1, SECOND, 0, True, 0)[0][0]
                self.assertEqual(status, line.MH_OK)
                self.assertEqual(node.event(line.START, 0), line.MH_OK)
                self.assertEqual(node.event(line.FRAME, 300, beacon), line.MH_OK)
                for time in range(SECOND, 7 * SECOND, SECOND):
                    counts = round(concentration(x_m, y_m, time) * 2**20)
                    self.assertEqual(node.event(line.READING, time, counts, 0), line.MH_OK)
                relayed += sum(to == line.BROADCAST and 300 < time < SECOND for time, to, _ in node.sent)
                reports = [(time + k, frame) for time, to, frame in node.sent if to == HEAD]
                self.assertEqual(len(reports), 6)
                deliveries += reports
            self.assertGreaterEqual(relayed, 16)  # each hears the sink alone, and relays its beacon

            for time, frame in sorted(deliveries):
                self.assertEqual(head.event(line.FRAME, time + 10, frame), line.MH_OK)
            head.event(line.PROBE, 6900)
            positions = []
            for data in head.reports:
                x0_mm, y0_mm, _, time, x, y = struct.unpack('>iiiIii', data[:24])
                x, y = [v / 65536 for v in (x, y)] if identity['fixed'] else struct.unpack('>ff', data[16:24])
                positions.append((time, x0_mm / 1000 + x, y0_mm / 1000 + y))
            good = [-6 < x - time * 0.002 < 3 and 5 < y < 9 for time, x, y in positions]  # the method lags
            self.assertTrue(len(good) >= 3 and sum(good) >= len(good) - 1, positions)
            counters = struct.unpack_from('>15I', head_board.ask(line.COUNT)[1][0][1])
            self.assertEqual(counters[1], 96)  # frames received

    def test_a_spoilt_coefficient_is_found(self):
        with board('cluster_head_luo_corrupted') as head:
            self.assertEqual(head.identify()['passed'], 0)
            self.assertIn(b'self-test FAILED', head.text)
            self.assertEqual(head.ask(line.START, 0)[0][0], line.MH_ERR_CORRUPT)
            self.assertEqual(head.ask(line.READING, 5, 0, 0)[0][0], line.MH_ERR_ARGUMENT)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
