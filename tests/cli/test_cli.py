"""The command line in a shell: help, exit codes, errors of one line."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from fgenv import __version__, cli
from fgenv.cli import errors

SCRIPT = Path(sys.executable).with_name("fgenv")
COMMANDS = ("run", "scenarios", "compare", "bench", "bench pairs", "bench world", "bench env")


def fgenv(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the installed console script."""
    return subprocess.run(
        [SCRIPT, *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "100", "TERM": "dumb", **environment},
        timeout=60,
    )


def raising(error: BaseException) -> Callable[..., None]:
    def app(**_: bool) -> None:
        raise error

    return app


def ending(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> int | str | None:
    """Return the exit code of the process if a command raises an error."""
    monkeypatch.delenv("FGENV_DEBUG", raising=False)
    monkeypatch.setattr(cli, "app", raising(error))
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    return stopped.value.code


def test_version_is_the_installed_one() -> None:
    done = fgenv("--version")
    assert (done.returncode, done.stdout) == (0, f"fgenv {__version__}\n")


def test_help_has_examples_and_exit_codes() -> None:
    done = fgenv("--help")
    assert done.returncode == 0
    for text in (*COMMANDS, "fgenv run three_tanks", "Exit codes", "--install-completion"):
        assert text in done.stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_help_with_a_machine_readable_form(command: str) -> None:
    done = fgenv(*command.split(), "--help")
    assert done.returncode == 0
    assert f"fgenv {command}" in done.stdout
    assert "--seed" in done.stdout
    assert "--json" in done.stdout


def test_validate_reports_lines(tmp_path: Path) -> None:
    assert "--json" in fgenv("validate", "--help").stdout
    file = tmp_path / "s.yaml"
    file.write_text("version: 1\nname: s\nrobot: []\n", encoding="utf-8")
    done = fgenv("validate", str(file))
    assert (done.returncode, done.stderr) == (errors.FAILED_CHECK, "")
    assert "line 3: robot: is no known key; did you mean 'robots'?" in done.stdout
    done = fgenv("validate", str(tmp_path / "none.yaml"))
    assert (done.returncode, done.stdout) == (errors.BAD_INPUT, "")
    assert done.stderr.count("\n") == 1


def test_tab_completes_commands() -> None:
    done = fgenv(_FGENV_COMPLETE="complete_bash", COMP_WORDS="fgenv ", COMP_CWORD="1")
    assert {command.split()[0] for command in COMMANDS} <= set(done.stdout.split())


def test_help_imports_nothing_heavy() -> None:
    code = "import sys, fgenv.cli; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"ompl", "matplotlib", "scipy", "fcl", "coal", "mujoco", "pybullet", "trimesh"}
    assert not heavy & set(done.stdout.split())


@pytest.mark.parametrize(
    "arguments", [("--no-such-option",), ("no-such-command",), ("run", "no_such_scenario")]
)
def test_wrong_use_is_2_and_one_line(arguments: tuple[str, ...]) -> None:
    done = fgenv(*arguments)
    assert (done.returncode, done.stdout) == (errors.BAD_INPUT, "")
    assert done.stderr.count("\n") == 1
    assert arguments[-1] in done.stderr
    assert "--help" in done.stderr


def test_no_command_is_2_and_help() -> None:
    done = fgenv()
    assert done.returncode == errors.BAD_INPUT
    assert "Exit codes" in done.stdout


def test_missing_mesh_is_2_and_one_line_with_its_name(tmp_path: Path) -> None:
    missing = str(tmp_path / "missing.stl")
    done = fgenv("run", "three_tanks", "--mesh", missing, "--out", str(tmp_path))
    assert done.returncode == errors.BAD_INPUT
    assert done.stderr.count("\n") == 1
    assert missing in done.stderr


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (ValueError("scale: got 0,\n  want > 0"), 2, "fgenv: scale: got 0, want > 0\n"),
        (TypeError("faces: got str"), 2, "fgenv: faces: got str\n"),
        (FileNotFoundError(2, "No such file", "a.stl"), 2, "fgenv: a.stl: No such file\n"),
        (FileNotFoundError("a.stl: no such file"), 2, "fgenv: a.stl: no such file\n"),
        (PermissionError(13, "Permission denied", "a"), 2, "fgenv: a: Permission denied\n"),
        (
            ModuleNotFoundError("No module named 'fcl'", name="fcl"),
            2,
            "fgenv: fcl is not installed; remedy: pip install 'fgenv[bench]'\n",
        ),
        (
            ModuleNotFoundError("No module named 'matplotlib.pyplot'", name="matplotlib.pyplot"),
            2,
            "fgenv: matplotlib.pyplot is not installed; remedy: pip install 'fgenv[view]'\n",
        ),
        (
            ModuleNotFoundError("No module named 'scipy'"),
            2,
            "fgenv: scipy is not installed; remedy: pip install 'fgenv[bench]'\n",
        ),
        (ImportError("hulls want: pip install x"), 2, "fgenv: hulls want: pip install x\n"),
        (
            RuntimeError("odd"),
            3,
            "fgenv: RuntimeError: odd (unforeseen; FGENV_DEBUG=1 shows where)\n",
        ),
        (
            ImportError("cannot import name 'x'", name="fgenv"),
            3,
            "fgenv: ImportError: cannot import name 'x' (unforeseen; FGENV_DEBUG=1 shows where)\n",
        ),
    ],
)
def test_an_error_is_one_line_and_a_code(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    error: Exception,
    code: int,
    line: str,
) -> None:
    assert ending(monkeypatch, error) == code
    assert capsys.readouterr() == ("", line)


def test_interrupted_is_130(monkeypatch: pytest.MonkeyPatch) -> None:
    assert ending(monkeypatch, KeyboardInterrupt()) == errors.INTERRUPTED


def test_debug_shows_the_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FGENV_DEBUG", "1")
    monkeypatch.setattr(cli, "app", raising(ValueError("scale")))
    with pytest.raises(ValueError, match="scale"):
        cli.main()


def test_every_extra_named_as_remedy_exists() -> None:
    from importlib.metadata import metadata

    assert set(errors.EXTRA_OF.values()) <= set(metadata("fgenv").get_all("Provides-Extra") or [])
