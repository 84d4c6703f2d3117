"""Progress of long commands where stderr is no terminal: a line per interval."""

from __future__ import annotations

import json
from threading import Event

import pytest
from support.shell import Shell

from fgenv.cli import progress
from fgenv.cli.console import console_of, is_quiet, set_quiet

PATIENCE = 60.0  # s


@pytest.fixture
def printed(monkeypatch: pytest.MonkeyPatch) -> Event:
    """Return an event that is set after a line has been printed."""
    event, print_tasks = Event(), progress.print_tasks

    def observed(bar: object) -> None:
        print_tasks(bar)  # type: ignore[arg-type]
        event.set()

    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    monkeypatch.setattr(progress, "print_tasks", observed)
    return event


def test_a_line_has_the_task_and_its_share(
    printed: Event, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress.progress() as bar:
        bar.add_task("making cases", total=500, completed=120)
        assert printed.wait(PATIENCE)
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[0] == "making cases: 120 of 500"


def test_a_status_prints_its_latest_text(
    printed: Event, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress.status("first") as update:
        update("second")
        printed.clear()
        assert printed.wait(PATIENCE)
        assert printed.wait(PATIENCE)
    assert capsys.readouterr().err.splitlines()[-1] == "second"


def test_nothing_is_printed_once_a_task_is_finished(
    printed: Event, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress.progress() as bar:
        bar.add_task("done", total=1, completed=1)
        assert printed.wait(PATIENCE)
    assert capsys.readouterr().err == ""


def test_quiet_prints_no_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    ended = Event()
    set_quiet(True)
    try:
        with progress.progress() as bar:
            bar.add_task("making cases", total=500, completed=120)
            ended.wait(0.1)  # ten intervals
        with progress.status("first"):
            ended.wait(0.1)
    finally:
        set_quiet(False)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("quiet", [False, True])
def test_quiet_hides_tables_beside_a_document(
    quiet: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    set_quiet(quiet)
    try:
        console_of(True).print("a table beside JSON")
        console_of(False).print("a table")
    finally:
        set_quiet(False)
    assert capsys.readouterr() == ("a table\n", "" if quiet else "a table beside JSON\n")


def test_quiet_is_for_one_command(shell: Shell) -> None:
    words = ("run", "swap", "--n", 2, "--policy", "goto", "--steps", 3, "--json")
    code, out, err = shell("--quiet", *words)
    assert (code, err) == (0, "")
    assert json.loads(out)["steps"] == 3
    assert is_quiet()
    shell(*words)
    assert not is_quiet()


def test_quiet_leaves_errors_alone(shell: Shell) -> None:
    code, out, err = shell("--quiet", "run", "swop")
    assert (code, out) == (2, "")
    assert "did you mean 'swap'" in err
