"""Set-up of all tests: repeatable hypothesis without deadlines, and the instruction sets."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from support.shell import Shell

os.environ["FGENV_VIEW_PORT"] = "0"  # any that is free
settings.register_profile(
    "fgenv",
    deadline=None,  # the machine may be busy
    derandomize=True,  # same seed, same result, for tests as well
    max_examples=int(os.environ.get("FGENV_FUZZ_EXAMPLES", "60")),
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("fgenv")


@pytest.fixture
def shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Shell:
    """The command line, in a folder of its own."""
    return Shell(tmp_path, monkeypatch, capsys)
