"""Tables of records: each column is declared once, by its title, value and format."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from rich.table import Table

from fgenv.bench.common.records import Record

Format = Callable[[Any], str]
Value = str | Callable[[Record], Any]  # path of keys in a row, with dots, or a function of the row
Columns = Mapping[str, tuple[Value, Format]]  # by title


def table(title: str, columns: Columns, rows: Iterable[Record]) -> Table:
    """Return a table with a line per row; texts are aligned to the left.

    A missing value is shown as a dash, and as a blank in rows with a `style` of rich, which are
    headings and summaries.
    """
    result = Table(title=title, box=None, padding=(0, 0, 0, 1), pad_edge=False, title_style="bold")
    for name, (_, form) in columns.items():
        result.add_column(name, justify="left" if form is text else "right", no_wrap=True)
    for row in rows:
        style = row.get("style")
        cells = [
            ("-" if style is None else "")
            if (value := value_of(row, source)) is None
            else form(value)
            for source, form in columns.values()
        ]
        result.add_row(*cells, style=style)
    return result


def value_of(row: Record, source: Value) -> Any:
    """Return the value of a column in a row; None if the row has none."""
    if callable(source):
        return source(row)
    value: Any = row
    for key in source.split("."):
        value = value.get(key) if isinstance(value, Mapping) else None
    return value


def grouped(key: str, groups: Iterable[tuple[str, Iterable[Record]]]) -> Iterable[Record]:
    """Yield the rows of all groups, with the group's title under `key` in its first row."""
    for title, rows in groups:
        for k, row in enumerate(rows):
            yield {**row, key: "" if k else title}


def goals_table(records: Iterable[Record]) -> Table:
    """Return a table of goals and measured values, of the last part of a benchmark."""
    columns: Columns = {
        "": ("goal", text),
        "expected": (
            lambda g: f"{'at most' if g.get('at_most') else 'at least'} {g['expected']:.3g}",
            str,
        ),
        "measured": ("measured", number()),
        "reached": (lambda g: "yes" if reached(g) else "no", str),
    }
    rows = ({"goal": name, **goal} for record in records for name, goal in record.items())
    return table("Goals", columns, rows)


def reached(goal: Record) -> bool:
    """Return whether a goal is reached."""
    expected, measured = goal["expected"], goal["measured"]
    return bool(measured <= expected if goal.get("at_most") else measured >= expected)


def text(value: object) -> str:
    """Format a text."""
    return str(value)


def count(value: float) -> str:
    """Format a whole number with commas."""
    return f"{value:,.0f}"


def number(unit: float = 1.0) -> Format:
    """Return a format with three digits; `unit` is the factor to the unit that is shown."""
    return lambda value: f"{v:,.0f}" if abs(v := value * unit) >= 100 else f"{v:.3g}"


def fixed(digits: int, unit: float = 1.0) -> Format:
    """Return a format with a number of decimals."""
    return lambda value: f"{value * unit:.{digits}f}"


def ratio(value: float) -> str:
    """Format a ratio with two digits: timings on a busy machine have no more."""
    return f"{value:.1f}" if value >= 1 else f"{value:.2f}"


micros, millis = number(1e6), number(1e3)
