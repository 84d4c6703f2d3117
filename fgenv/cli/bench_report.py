"""Common parts of the benchmark commands: machine, progress, plots, JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fgenv.cli.console import console_of
from fgenv.cli.progress import status

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.confidence import Estimate

Rows = dict[str, list[dict[str, Any]]]  # by part of a benchmark


class BenchReport:
    """Output of one benchmark: tables for a reader, or one JSON document.

    Args:
        as_json: print the document on stdout, and tables on stderr.
        plots: files to write by option; they are checked at once.

    Raises:
        ValueError: a wrong plot path.
    """

    def __init__(self, as_json: bool, **plots: Path | None) -> None:

        from fgenv.view.figures.canvas import check_plot_path

        for option, path in plots.items():
            if path is not None:
                check_plot_path(path, f"--{option}")
        self.as_json, self.plots = as_json, plots
        self.console: Console = console_of(as_json)
        self.document: dict[str, Any] = {}

    def machine(self, versions: Mapping[str, str] | None = None) -> None:
        """Print and store the machine and the versions of the libraries."""
        from fgenv.bench.common.machine import machine

        about = machine()
        self.console.print(
            f"{about['processor']}, {about['cores']} cores, {about['system']},", end=" "
        )
        self.console.print(f"Python {about['python']}, NumPy {about['numpy']}")
        self.document["machine"] = about
        if versions is not None:
            self.console.print(", ".join(f"{name} {number}" for name, number in versions.items()))
            self.document["versions"] = dict(versions)

    def collect(
        self,
        records: Callable[[Callable[[str], None]], Iterable[tuple[str, dict[str, Any]]]],
        show: Callable[[Console, str, list[dict[str, Any]]], None],
        first: str,
    ) -> Rows:
        """Run a benchmark of several parts, and print the tables of each part once it is done.

        Args:
            records: makes the iterator of parts and their rows; receives a function that shows
                progress.
            show: prints the tables of a part.
            first: status at the beginning.
        """
        rows: Rows = {}
        with status(first) as update:
            for done, (part, record) in enumerate(records(update), 1):
                if rows and part not in rows:
                    last = list(rows)[-1]
                    show(self.console, last, rows[last])
                rows.setdefault(part, []).append(record)
                update(f"{part}: {done} rows done")
        last = list(rows)[-1]
        show(self.console, last, rows[last])
        return rows

    def plot_ratios(self, ratios: Mapping[str, Mapping[str, float]], title: str) -> None:
        """Draw the ratios as bars if --plot is given."""
        from fgenv.view.figures.bars import plot_ratios

        if (path := self.plots.get("plot")) is not None:
            plot_ratios(ratios, title, path)

    def plot_shares(self, shares: Mapping[str, Mapping[str, Estimate]], label: str) -> None:
        """Draw the shares with their intervals if --plot is given and there are any."""
        from fgenv.view.figures.interval_plot import plot_shares

        if (path := self.plots.get("plot")) is not None and shares:
            plot_shares(shares, label, path)

    def finish(self, **more: Any) -> None:
        """Print the document if it was requested."""
        if self.as_json:
            typer.echo(json.dumps({**self.document, **more}, indent=1))
