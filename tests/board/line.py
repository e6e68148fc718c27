"""The serial line of a board whose image runs under its emulator (motehound/line.h), from Python."""
import os
import select
import struct
import subprocess
import time

FLAG, ESCAPE = 0x7E, 0x7D
IDENTIFY, CONFIGURE, START, STOP, READING, FRAME, SENT, ALARM, PROBE, COUNT = range(1, 11)
IDENTITY, TRANSMIT, SET_ALARM, REPORT, SLEEP, SENSE, CLOCK, COUNTERS, DONE, FAULT = range(129, 139)
MOTE, SENSOR, PROTOCOL, HEAD, TRACKER, CLOCK_KEEPING = range(6)
BROADCAST = 0xFFFFFFFF
MH_OK, MH_ERR_ARGUMENT, MH_ERR_CORRUPT, MH_ERR_UNKNOWN = 0, 2, 10, 11


def check_sequence(data):
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return struct.pack('<H', crc)


def fields(*values):
    """Each 4 bytes: integers, True and False, and floats as IEEE 754; bytes as they are."""
    parts = []
    for value in values:
        if isinstance(value, bytes):
            parts.append(value)
        elif isinstance(value, float):
            parts.append(struct.pack('>f', value))
        else:
            parts.append(struct.pack('>I', int(value) & 0xFFFFFFFF))
    return b''.join(parts)


class Board:
    """An image under its emulator, `command`, whose standard input and output are the board's line."""

    def __init__(self, command, wait_s=20):
        self.wait_s = wait_s
        self.text = b''  # what came between messages
        self.faults = []
        self.incoming = b''
        self.program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.program.kill()
        self.program.wait()
        self.program.stdin.close()
        self.program.stdout.close()

    def wait_for_start(self):
        """Bytes sent before the board is up are lost: wait for the line of text that it begins with."""
        deadline = time.monotonic() + self.wait_s
        while not self.text.endswith(b'\n'):
            self.text += bytes([self._byte(deadline)])
        return self.text.decode()

    def _byte(self, deadline):
        if time.monotonic() > deadline:
            raise TimeoutError('no answer from the board; text so far: ' + repr(self.text))
        if not self.incoming:
            ready, _, _ = select.select([self.program.stdout], [], [], max(0, deadline - time.monotonic()))
            self.incoming = os.read(self.program.stdout.fileno(), 4096) if ready else b''
            if not self.incoming:
                raise TimeoutError('the board is silent; text so far: ' + repr(self.text))
        byte, self.incoming = self.incoming[0], self.incoming[1:]
        return byte

    def receive(self, deadline=None):
        """The next message: (kind, fields). What is no message is text."""
        deadline = deadline or time.monotonic() + self.wait_s
        frame, escaped = bytearray(), False
        while True:
            byte = self._byte(deadline)
            if byte == FLAG:
                if len(frame) > 2 and check_sequence(frame[:-2]) == bytes(frame[-2:]):
                    return frame[0], bytes(frame[1:-2])
                self.text += frame
                frame = bytearray()
            elif byte == ESCAPE:
                escaped = True
            else:
                frame.append(byte ^ 0x20 if escaped else byte)
                escaped = False

    def send(self, kind, *values):
        message = bytes([kind]) + fields(*values)
        message += check_sequence(message)
        stuffed = b''.join(bytes([ESCAPE, b ^ 0x20]) if b in (FLAG, ESCAPE) else bytes([b]) for b in message)
        self.program.stdin.write(bytes([FLAG]) + stuffed + bytes([FLAG]))

    def ask(self, kind, *values):
        """Send a message -> (done, answers): done is (status, cycles, stack), answers the (kind, fields) before it."""
        deadline = time.monotonic() + self.wait_s
        self.send(kind, *values)
        answers = []
        while True:
            kind, data = self.receive(deadline)
            if kind == DONE:
                return struct.unpack('>III', data), answers
            if kind == FAULT:
                self.faults.append(struct.unpack('>II', data))
            else:
                answers.append((kind, data))

    def identify(self):
        """The identity, as a dictionary. What the board said before, running free, is dropped."""
        if not self.text:
            self.wait_for_start()
        _, answers = self.ask(IDENTIFY)
        data = next(data for kind, data in answers if kind == IDENTITY)
        version, fixed, passed, senses, keeps_time = struct.unpack('>5I', data[:20])
        board, protocol, tracker, library, rest = data[20:].split(b'\0', 4)
        reports, neighbours, hz, ram, static = struct.unpack('>5I', rest)
        return dict(version=version, fixed=fixed, passed=passed, senses=senses, keeps_time=keeps_time, board=board.decode(),
                    protocol=protocol.decode(), tracker=tracker.decode(), library=library.decode(), reports_max=reports,
                    neighbours_max=neighbours, cycles_per_s=hz, ram_size=ram, ram_static=static)
