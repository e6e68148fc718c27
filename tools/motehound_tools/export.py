"""LCM logs as CSV, MCAP or rerun's recordings.

Times of a log that `motehound run --log` wrote are simulated; those of lcm-logger are the wall clock's. Every message
of ours carries the simulated time besides.
"""

from __future__ import annotations

import base64
import csv
import json
import math
import os
import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from . import messages
from .event_log import Event, EventLog
from .failure import Failure

UNITS = {"length": "length_bytes", "data": "data_hex"}  # fields whose name does not end in their unit


class Tally:
    """What became of the events of a log."""

    def __init__(self) -> None:
        self.channels: Counter[str] = Counter()
        self.broken = 0
        self.unknown = 0

    def __str__(self) -> str:
        text = f"{self.channels.total():,} messages on {len(self.channels)} channels"
        text += f", {self.unknown:,} of unknown types" if self.unknown else ""
        return text + (f", {self.broken:,} broken" if self.broken else "")


def decoded(log: EventLog, tally: Tally) -> Iterator[tuple[Event, Any | None]]:
    """Each whole event with its message, None where its type is unknown."""
    undecoded = 0
    for event in log:
        try:
            message = messages.decode(event.data)
        except messages.Broken:
            undecoded += 1
            continue
        if message is None:
            tally.unknown += 1
        else:
            tally.channels[event.channel] += 1
        yield event, message
    tally.broken = log.broken + undecoded


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A file to write that takes the place of `path` at the end, if nothing went wrong."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        yield partial
        os.replace(partial, path)
    except OSError as error:
        raise Failure(f"{path}: cannot write: {error.strerror or error}") from error
    finally:
        partial.unlink(missing_ok=True)


def plain(value: Any) -> Any:
    """What JSON and a table's cell can hold."""
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    return value


# CSV


def fixed_length(message: Any, name: str) -> int | None:
    """Of a field that is an array of fixed length, but for bytes."""
    dimensions = message.__dimensions__[message.__slots__.index(name)]
    size = dimensions[0] if dimensions else None
    return size if isinstance(size, int) and not isinstance(getattr(message, name), bytes) else None


def columns(message: Any) -> list[str]:
    """One a field, of an array of fixed length one an element."""
    names: list[str] = []
    for name in message.__slots__:
        size = fixed_length(message, name)
        names += [UNITS.get(name, name)] if size is None else [f"{name}_{index}" for index in range(size)]
    return names


def rows(message: Any) -> Iterator[list[Any]]:
    """One row; where a type has arrays of variable length, one row for each of their elements, and one if there are none."""
    fields = [(name, getattr(message, name), fixed_length(message, name)) for name in message.__slots__]
    lists = [len(value) for _, value, size in fields if size is None and isinstance(value, (list, tuple))]
    for index in range(max([1, *lists])):
        row: list[Any] = []
        for name, value, size in fields:
            row += [cell(message, name, index)] if size is None else value
        yield row


def cell(message: Any, name: str, index: int) -> Any:
    value = getattr(message, name)
    if isinstance(value, (list, tuple)):
        value = value[index] if index < len(value) else ""
    if isinstance(value, bytes):
        return value[: max(0, getattr(message, "length", len(value)))].hex()
    if isinstance(value, bool):
        return int(value)
    return json.dumps(plain(value)) if hasattr(value, "__slots__") else value


def to_csv(log: EventLog, out: Path, tally: Tally) -> None:
    """A folder with one file a channel. A frame's kind comes from the message in it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failure(f"{out}: cannot make this folder: {error.strerror}") from error
    with ExitStack() as files:
        tables: dict[tuple[str, type], Any] = {}
        for event, message in decoded(log, tally):
            if message is None:
                continue
            key = event.channel, type(message)
            framed = type(message).__name__ == "frame_t"
            if key not in tables:
                # a channel of two types, or two channels whose names differ in what no file name may hold
                name = stem = re.sub(r"[^\w.-]", "_", event.channel)
                taken = {table[0] for table in tables.values()}
                while name in taken:
                    name = f"{stem}_{len(taken)}"
                stream = files.enter_context(files.enter_context(whole(out / f"{name}.csv")).open("w", newline=""))
                writer = csv.writer(stream, lineterminator="\n")
                writer.writerow(["log_time_s", *columns(message), *(["kind"] if framed else [])])
                tables[key] = name, writer
            for row in rows(message):
                extra = [messages.radio_kind(message)] if framed else []
                tables[key][1].writerow([event.time_us / 1e6, *row, *extra])


# MCAP

TIME_MAX_NS = 2**63 - 1  # a damaged time may be anything
JSON_TYPES = {"double": "number", "float": "number", "string": "string", "boolean": "boolean"}


def json_schema(message: type) -> dict[str, Any]:
    """The type as JSON Schema, the way Foxglove wants it."""
    properties: dict[str, Any] = {}
    for name, kind, dimensions in zip(message.__slots__, message.__typenames__, message.__dimensions__):  # type: ignore[attr-defined]
        if kind == "byte" and dimensions:
            properties[name] = {"type": "string", "contentEncoding": "base64"}
            continue
        integer = re.fullmatch(r"byte|int\d+_t", kind) is not None
        one: dict[str, Any] = {"type": "integer" if integer else JSON_TYPES.get(kind, "object")}
        for _ in dimensions or []:
            one = {"type": "array", "items": one}
        properties[name] = one
    return {"title": messages.full_name(message), "type": "object", "properties": properties}


def json_value(value: Any) -> Any:
    """As `plain`, with bytes in base64 and null for what JSON cannot say."""
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, (list, tuple)):
        return [json_value(one) for one in value]
    if hasattr(value, "__slots__"):
        return {name: json_value(getattr(value, name)) for name in value.__slots__}
    return value


def to_mcap(log: EventLog, out: Path, tally: Tally) -> None:
    """One topic a channel, messages as JSON; what is of an unknown type keeps its bytes (encoding x-lcm)."""
    from mcap.writer import Writer

    with whole(out) as partial, partial.open("wb") as stream:
        writer = Writer(stream)
        writer.start(library="motehound")
        schemas: dict[type, int] = {}
        topics: dict[tuple[str, type], int] = {}
        for sequence, (event, message) in enumerate(decoded(log, tally)):
            kind = type(message)
            key = event.channel, kind
            if key not in topics and message is None:
                topics[key] = writer.register_channel(event.channel, "x-lcm", 0)
            elif key not in topics:
                if kind not in schemas:
                    schema = json.dumps(json_schema(kind)).encode()
                    schemas[kind] = writer.register_schema(messages.full_name(kind), "jsonschema", schema)
                topics[key] = writer.register_channel(event.channel, "json", schemas[kind])
            data = event.data if message is None else json.dumps(json_value(message), allow_nan=False).encode()
            time_ns = min(max(0, event.time_us) * 1000, TIME_MAX_NS)
            writer.add_message(topics[key], log_time=time_ns, publish_time=time_ns, sequence=sequence, data=data)
        writer.finish()


def to_rerun(log: EventLog, out: Path, tally: Tally) -> None:
    from . import export_rerun

    with whole(out) as partial:
        export_rerun.write(partial, (message for _, message in decoded(log, tally) if message is not None))


FORMATS: dict[str, Callable[[EventLog, Path, Tally], None]] = {"csv": to_csv, "mcap": to_mcap, "rerun": to_rerun}


def write(path: Path, form: str, out: Path) -> Tally:
    log = EventLog(path)
    if not out.parent.is_dir():
        raise Failure(f"{out}: cannot write: no folder {out.parent}")
    tally = Tally()
    FORMATS[form](log, out, tally)
    return tally
