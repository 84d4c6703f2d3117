"""Saving: complete or not at all, for links, devices, permissions, several processes, and kills."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fgenv.saving import atomic, save_bytes, save_text


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def fail(path: Path, error: type[BaseException]) -> None:
    with atomic(path) as partial:
        partial.write_text("half")
        raise error


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    save_text(path, "old\n")
    for error in (ValueError, KeyboardInterrupt):
        with pytest.raises(error):
            fail(path, error)
    assert path.read_text() == "old\n"
    assert names(tmp_path) == ["a.txt"]


def test_a_symbolic_link_stays_and_its_target_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    target, link = tmp_path / "real" / "a.txt", tmp_path / "link.txt"
    link.symlink_to(target)
    for text in ("new", "newer"):  # the target does not exist at first
        save_text(link, text)
        assert link.is_symlink()
        assert target.read_text() == text
    assert names(tmp_path) == ["link.txt", "real"]
    assert names(target.parent) == ["a.txt"]


def test_permissions_are_those_of_the_old_file_or_of_the_umask(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    before = os.umask(0o027)
    try:
        save_text(path, "new")
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    path.chmod(0o604)
    save_text(path, "newer")
    assert stat.S_IMODE(path.stat().st_mode) == 0o604


def test_a_pipe_is_written_directly(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    save_bytes(path, b"text")
    assert os.read(reader, 10) == b"text"
    os.close(reader)
    assert stat.S_ISFIFO(path.stat().st_mode)
    save_text("/dev/null", "text")


def test_errors_name_the_users_path(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"missing/a\.txt'"):
        save_text(tmp_path / "missing" / "a.txt", "")
    with pytest.raises(IsADirectoryError, match="pytest"):
        save_text(tmp_path, "")


@pytest.mark.parametrize("name", ["a" * 250 + ".npz", "é" * 125 + ".txt", ".hidden", "no suffix"])
def test_any_name_that_the_folder_can_hold(tmp_path: Path, name: str) -> None:
    save_text(tmp_path / name, "text")
    assert names(tmp_path) == [name]


WRITER = """
import sys
from fgenv.saving import atomic
for k in range(40):
    with atomic(sys.argv[1]) as partial, open(partial, "w") as file:
        for _ in range(50):
            file.write(sys.argv[2] * 100)
            file.flush()
"""


def test_two_processes_save_to_one_path(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    save_text(path, "x" * 5000)
    writers = [subprocess.Popen([sys.executable, "-c", WRITER, path, c]) for c in "ab"]
    seen = set()
    while any(writer.poll() is None for writer in writers):
        text = path.read_text()
        assert len(text) == 5000
        assert len(set(text)) == 1
        seen.add(text[0])
    assert [writer.returncode for writer in writers] == [0, 0]
    assert path.read_text()[0] in "ab"
    assert names(tmp_path) == ["a.txt"]


HANGING = """
import sys, time
from fgenv.saving import atomic
with atomic(sys.argv[1]) as partial:
    partial.write_text("half")
    print("begun", flush=True)
    time.sleep(60)
"""


def test_a_killed_process_leaves_the_old_file_and_the_next_save_cleans_up(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    save_text(path, "old")
    command = [sys.executable, "-c", HANGING, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        writer.stdout.readline()
        (partial,) = [p for p in tmp_path.iterdir() if p != path]
        hour_ago = time.time() - 3600
        os.utime(partial, (hour_ago, hour_ago))
        save_text(path, "other")
        assert partial.exists()  # in use, however old
        writer.send_signal(signal.SIGKILL)
        writer.wait()
    assert path.read_text() == "other"
    save_text(path, "new")
    assert names(tmp_path) == ["a.txt"]
