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


@pytest.fixture(autouse=True, scope="session")
def _state_folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep the hashes of trusted files out of the user's own state folder."""
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))


@pytest.fixture
def shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Shell:
    """The command line, in a folder of its own."""
    return Shell(tmp_path, monkeypatch, capsys)
