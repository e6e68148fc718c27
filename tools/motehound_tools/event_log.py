"""LCM event logs that may be damaged.

The format is LCM's: each event is a sync word, a number, a time, two lengths, the channel's name and the data, all
big-endian. LCM's own reader ends at the first broken event; this one counts it and goes on at the next sync word.
"""

from __future__ import annotations

import mmap
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .failure import Failure

SYNC = b"\xed\xa1\xda\x01"
HEADER = struct.Struct(">4sqqii")  # sync word, number, microseconds, length of the channel's name, length of the data
CHANNEL_MAX = 63  # LCM_MAX_CHANNEL_NAME_LENGTH


@dataclass(frozen=True, slots=True)
class Event:
    channel: str
    time_us: int
    data: bytes


class EventLog:
    """Iterate over it for the events that are whole; `broken` counts the others so far, `share` has been read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.broken = 0
        self.share = 0.0
        try:
            with path.open("rb") as stream:
                self.size = os.fstat(stream.fileno()).st_size
                self._bytes = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) if self.size else b""
        except (OSError, ValueError) as error:
            raise Failure(f"{path}: cannot read: {getattr(error, 'strerror', None) or error}") from error
        if self._bytes.find(SYNC) < 0:
            raise Failure(f"{path}: expected an LCM event log, found no event in its {self.size} bytes")

    def _at(self, begin: int) -> tuple[Event, int] | None:
        """The event that begins there and where it ends, or None if it is not whole."""
        if begin + HEADER.size > self.size:
            return None
        sync, _, time_us, channel_length, data_length = HEADER.unpack_from(self._bytes, begin)
        data = begin + HEADER.size + channel_length
        end = data + data_length
        if sync != SYNC or not 0 < channel_length <= CHANNEL_MAX or data_length < 0 or end > self.size:
            return None
        if end < self.size and not SYNC.startswith(self._bytes[end : end + len(SYNC)]):
            return None  # a wrong length: what follows is no event
        try:
            channel = self._bytes[begin + HEADER.size : data].decode()
        except UnicodeDecodeError:
            return None
        return Event(channel, time_us, self._bytes[data:end]), end

    def __iter__(self) -> Iterator[Event]:
        position = 0
        while position < self.size:
            found = self._at(position)
            if found is None:
                self.broken += 1
                position = self._bytes.find(SYNC, position + 1)
                if position < 0:
                    break
                continue
            event, position = found
            self.share = position / self.size
            yield event
        self.share = 1.0
