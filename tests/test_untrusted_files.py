"""Laws of every reader of files: any file is read, or refused by one clear error that names it."""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.small_files import SmallFile, small_files

from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.robots.robot_file import RobotFile
from fgenv.scenarios import Scenario

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
FILES = {file.name: file for file in small_files()}
CUTS, CHANGES = 20, 60
WORDS = (b"-1", b"nan", b"1e999", b"99999999999", b"\0", b"\n", b'"', b"<", b"[", b"\x1b[31m", b"%")
NO_END = (".obj", ".yaml", ".cfg", ".csv", ".scen")  # without a count of rows, or a last row


@pytest.fixture(params=FILES)
def file(request: pytest.FixtureRequest) -> SmallFile:
    return FILES[request.param]


def test_valid_files(file: SmallFile, tmp_path: Path) -> None:
    """All tests below change a file that is read."""
    assert file.read(file.write(tmp_path)) is not None


# Files that are not regular


def test_only_regular_files_with_content_are_read(file: SmallFile, tmp_path: Path) -> None:
    """A pipe without a writer would block for ever, a device would never end."""
    path = file.path(tmp_path)
    path.unlink(missing_ok=True)
    file.assert_refused(path)
    path.mkdir()
    file.assert_refused(path)
    path.rmdir()
    os.mkfifo(path)
    file.assert_refused(path)
    for target in ("/dev/zero", "/dev/null", str(path), str(path) + "/none"):
        path.unlink()
        path.symlink_to(target)
        file.assert_refused(path)
    path.unlink()
    path.touch()
    file.assert_refused(path)


# Damaged files


def test_files_cut_anywhere(file: SmallFile, tmp_path: Path) -> None:
    """Whatever is cut off is missed, where the format allows it."""
    path, whole = file.write(tmp_path), file.content
    expected, end = facts(file.read(path)), len(whole.rstrip(b"\n"))
    text = whole.isascii()
    for size in {int(size) for size in np.linspace(1, len(whole) - 1, CUTS)}:
        path.write_bytes(whole[:size])
        result = file.outcome(path)
        at_row = not text or whole[size - 1 : size] == b"\n"
        if result is not None and size < end and at_row and path.suffix not in NO_END:
            assert facts(result) == expected or noted(result), f"{size} of {len(whole)} bytes"


def facts(result: Any) -> object:
    """Parts of a result that change if part of the file is lost."""
    if isinstance(result, Shape):
        return len(result.faces)
    if isinstance(result, Robot | RobotFile):
        return len(result.links), len(result.joints)
    if isinstance(result, Scenario):
        return result.shapes, result.bodies, result.robots
    return getattr(result, "id", None)


def noted(result: Any) -> bool:
    """Whether the report of a mesh has notes."""
    return isinstance(result, Shape) and result.report is not None and bool(result.report.notes)


def test_files_changed_anywhere(file: SmallFile, tmp_path: Path) -> None:
    """Bits and bytes changed, bytes removed, repeated or inserted."""
    rng = np.random.default_rng(zlib.crc32(file.name.encode()))
    path = file.write(tmp_path)
    for _ in range(CHANGES):
        path.write_bytes(changed(file.content, rng))
        file.outcome(path)


def changed(content: bytes, rng: np.random.Generator) -> bytes:
    """The content with one to three changes."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 4))):
        at, kind = int(rng.integers(len(data))), int(rng.integers(5))
        span = slice(at, at + int(rng.integers(1, 12)))
        if kind == 0:
            data[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            data[at] = int(rng.integers(256))
        elif kind == 2:
            data[span] = WORDS[int(rng.integers(len(WORDS)))]
        elif kind == 3:
            data[at:at] = data[span]
        elif len(data) > 20:
            del data[span]
    return bytes(data)
