"""The messages of lcm_types/ as Python classes, made by lcm-gen at every start, which takes milliseconds."""

from __future__ import annotations

import importlib
import shutil
import struct
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from .command import ROOT
from .failure import Failure

FINGERPRINT_BYTES = 8
SINK = -1  # the head of a motehound.track_t that is what the sink of clusters has


class Broken(Exception):
    """A message of a known type that cannot be decoded."""


def generate(folder: str) -> list[str]:
    """Python packages for every file of lcm_types/ into `folder`; their names."""
    generator = shutil.which("lcm-gen", path=str(Path(sys.executable).parent)) or shutil.which("lcm-gen")
    if generator is None:
        raise Failure("lcm-gen: not found beside this Python or on the PATH; tools/setup run installs it")
    files = [str(path) for path in sorted((ROOT / "lcm_types").glob("*.lcm"))]
    try:
        done = subprocess.run([generator, "-p", "--ppath", folder, *files], capture_output=True, text=True)
    except OSError as error:  # so does a script whose interpreter is gone
        raise Failure(f"{generator}: cannot run: {error.strerror}; tools/setup run makes it anew") from error
    if done.returncode:
        raise Failure(f"lcm-gen: {(done.stderr or done.stdout).strip() or done.returncode}".replace("\n", "; "))
    return sorted(path.name for path in Path(folder).iterdir() if path.is_dir())


@cache
def types() -> dict[bytes, type]:
    """Every message class by the fingerprint that its messages begin with."""
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, folder)
        try:
            modules = [importlib.import_module(name) for name in generate(folder)]
        finally:
            sys.path.remove(folder)
    classes = [member for module in modules for member in vars(module).values() if isinstance(member, type)]
    return {one._get_packed_fingerprint(): one for one in classes}  # type: ignore[attr-defined]


def named(name: str) -> type:
    """The class of one message, such as motehound.track_t."""
    return next(one for one in types().values() if full_name(one) == name)


def full_name(message: type) -> str:
    return f"{message.__module__.split('.')[0]}.{message.__name__}"


def decode(data: bytes) -> Any | None:
    """The message, or None if its type is none of ours. Raises Broken."""
    found = types().get(data[:FINGERPRINT_BYTES])
    if found is None:
        return None
    try:
        return found.decode(data)  # type: ignore[attr-defined]
    except (struct.error, ValueError, OverflowError, MemoryError, IndexError) as error:
        raise Broken(str(error)) from error


def radio_kind(frame: Any) -> str:
    """What a motehound.frame_t carries: beacon, report, ... or unknown."""
    found = types().get(bytes(frame.data[:FINGERPRINT_BYTES]))
    return found.__name__.removesuffix("_t") if found else "unknown"
