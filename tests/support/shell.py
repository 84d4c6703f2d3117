"""The command line run in this process: faster than one of its own."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from fgenv import cli


class Shell:
    """Runs ``fgenv`` in a folder."""

    def __init__(
        self, folder: Path, patch: pytest.MonkeyPatch, capture: pytest.CaptureFixture[str]
    ) -> None:
        self.patch, self.capture = patch, capture
        patch.chdir(folder)
        patch.delenv("FGENV_DEBUG", raising=False)

    def __call__(self, *words: object) -> tuple[int, str, str]:
        """Exit code, stdout, stderr."""
        self.patch.setattr(sys, "argv", ["fgenv", *map(str, words)])
        self.capture.readouterr()
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        code = stopped.value.code
        return (0 if code is None else int(code)), *self.capture.readouterr()

    def refuses(self, *words: object) -> str:
        """What a wrong use is told: on stderr, in one line."""
        code, out, err = self(*words)
        assert (code, out, err.count("\n")) == (2, "", 1)
        return err
