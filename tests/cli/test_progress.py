"""Progress of long commands where stderr is no terminal: a line per interval."""

from __future__ import annotations

from threading import Event

import pytest

from fgenv.cli import progress

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
