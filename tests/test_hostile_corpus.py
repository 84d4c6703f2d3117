"""Hundreds of hostile files of all formats, each read in bounded time and memory."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from support import TESTS


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory and time are Linux's")
def test_each_file_of_the_corpus_is_answered_within_its_bounds() -> None:
    """Loaded, or refused by one clear error: no other exception, no end of the process."""
    done = subprocess.run(
        [sys.executable, "-m", "support.hostile_files"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )
    last = done.stdout.splitlines()[-1:]
    assert done.returncode == 0, f"{last}: {done.stderr[-2000:]}"
