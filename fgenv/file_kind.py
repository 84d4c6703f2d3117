"""The kind of a file by its first bytes, for messages about a file of another kind."""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path

from fgenv.npz import open_npz

HEAD = 4096  # bytes that are read of a file


@dataclass(frozen=True)
class FileKind:
    """A kind of file.

    Attributes:
        name: with its article, e.g. "a record".
        use: what to do with such a file.
    """

    name: str
    use: str


RECORD = FileKind("a record", "use replay, render, plot or view")
PLAN = FileKind("a plan", "use verify, render, plot or view")
POLICY = FileKind("a policy", "use run or eval with --policy mlp:FILE")
FROZEN_SET = FileKind("a frozen set", "use run or eval")
SCENARIO = FileKind("a scenario", "use validate, scenarios, run, eval or plan")
MESH = FileKind("a mesh", "use mesh or export")
ROBOT = FileKind("a robot", "use robot or export")
PICTURE = FileKind("a picture", "open it with a viewer of pictures")
POINTER = FileKind("a Git LFS pointer", "get the file itself with `git lfs pull`")
PAGE = FileKind("an HTML page", "download the raw file")
ARCHIVES = {"record": RECORD, "plan": PLAN, "policy": POLICY, "frozen set": FROZEN_SET}
MARKS = {
    b"version https://git-lfs": POINTER,
    b"<!doctype html": PAGE,
    b"<html": PAGE,
    b"\x89png\r\n": PICTURE,
    b"\xff\xd8\xff": PICTURE,
    b"gif8": PICTURE,
    b"gltf": MESH,
    b"ply\n": MESH,
    b"ply\r": MESH,
    b"solid ": MESH,
    b"off\n": MESH,
}
ROBOT_ELEMENT = re.compile(rb"<(robot|mujoco|sdf)[\s>]")
SCENARIO_KEYS = re.compile(rb"^version: *\d+ *(#.*)?\r?$", re.MULTILINE)


def kind_of(path: str | Path) -> FileKind | None:
    """Return the kind of a file, or None if it is unknown or cannot be read.

    At most the first 4 kB of a file and the format of an .npz file are read.
    """
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            return None
        with open(path, "rb") as file:
            head = file.read(HEAD)
    except (OSError, ValueError):
        return None
    if head.startswith(b"PK\x03\x04"):
        return _archive_kind(path)
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    for mark, kind in MARKS.items():
        if text.startswith(mark):
            return kind
    if text.startswith(b"<"):
        return ROBOT if ROBOT_ELEMENT.search(text) else None
    return SCENARIO if SCENARIO_KEYS.search(text) else None


def other_kind(path: str | Path, expected: FileKind) -> str:
    """Return the message about a file of another kind; '' for the expected or an unknown kind."""
    kind = kind_of(path)
    if kind is None or kind == expected:
        return ""
    return f"got {kind.name}, expected {expected.name}; {kind.use}"


def _archive_kind(path: str | Path) -> FileKind | None:
    try:
        with open_npz(path) as file:
            format = file.text("format")
    except Exception:  # zip, zlib and NumPy each have their own
        return None
    return ARCHIVES.get(format.removeprefix("fgenv ").rpartition(" ")[0])
