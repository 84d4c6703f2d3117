"""The command line, run in this process: faster than a new process."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from fgenv import cli
from fgenv.cli import progress


class Shell:
    """Runs ``fgenv`` in a folder."""

    def __init__(
        self, folder: Path, patch: pytest.MonkeyPatch, capture: pytest.CaptureFixture[str]
    ) -> None:
        self.patch, self.capture = patch, capture
        patch.chdir(folder)
        patch.delenv("FGENV_DEBUG", raising=False)
        patch.setenv("COLUMNS", "120")
        patch.setattr(progress, "INTERVAL", 1e6)  # s: no lines of progress, however slow the run

    def __call__(self, *words: object) -> tuple[int, str, str]:
        """Return exit code, stdout and stderr."""
        self.patch.setattr(sys, "argv", ["fgenv", *map(str, words)])
        self.capture.readouterr()
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        code = stopped.value.code
        return (0 if code is None else int(code)), *self.capture.readouterr()

    def json(self, *words: object) -> dict[str, Any]:
        """Return the document that --json prints."""
        code, out, _ = self(*words, "--json")
        assert code == 0
        data: dict[str, Any] = json.loads(out)
        return data

    def refuses(self, *words: object) -> str:
        """Return the error of an invalid use: one line on stderr."""
        code, out, err = self(*words)
        assert (code, out, err.count("\n")) == (2, "", 1)
        return err
