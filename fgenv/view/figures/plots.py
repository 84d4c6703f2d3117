"""Plots of a record by Matplotlib: clearance, masks, and a corridor in space and time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Record
from fgenv.scenarios import Built
from fgenv.view.contact_events import meetings
from fgenv.view.figures.canvas import blank, checked, write
from fgenv.view.figures.palette import INK, robot_color
from fgenv.view.mask_links import GONE, present, world_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DASHES = ("-", "--", ":", "-.")  # one more each time that colors begin anew
COLORS = 7
LEGEND = 12  # robots at most that are named
FLOOR = 1e-4  # meters: less is drawn as that


def plot(record: Record, kind: str, path: str | Path) -> None:
    """Write a plot of a record.

    Args:
        kind: of `KINDS`.
        path: its ending says the format: .png, .svg or .pdf.

    Raises:
        ValueError: no such kind or format; or the record has nothing of that kind.
        ImportError: Matplotlib is missing, with the remedy.
    """
    if kind not in KINDS:
        raise ValueError(f"kind: got {kind!r}, expected {', '.join(KINDS)}")
    path = checked(path)
    if len(record) == 0:
        raise ValueError("record: it has no steps, nothing to plot")
    figure = blank(7.2, 4.2)
    axes = figure.add_subplot()
    axes.set_title(f"{record.scenario.name}: {record.n_robots} robots, {record.policy}", loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    KINDS[kind](record, axes)
    write(figure, path)


def style(i: int) -> dict[str, Any]:
    """How robot i is drawn."""
    return {"color": robot_color(i), "linestyle": DASHES[i // COLORS % len(DASHES)], "lw": 1.4}


def legend(record: Record, axes: Axes) -> None:
    """Beside the plot, where not too many are named."""
    if record.n_robots <= LEGEND:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def clearance(record: Record, axes: Axes) -> None:
    """Each robot's distance to whatever is nearest; contacts as dots at the bottom."""
    measured = record["clearances"]
    gaps = measured if np.isfinite(measured).any() else clearances_of(record)
    times = record.dt * np.arange(1, len(record) + 1)
    for i, name in enumerate(record.names):
        row = np.where(np.isfinite(gaps[:, i]), np.maximum(gaps[:, i], FLOOR), np.nan)
        axes.plot(times, row, label=name, **style(i))
    for m in meetings(record):
        axes.plot(m.begin, FLOOR, "o", color=robot_color(m.robot), mec=INK, ms=5, clip_on=False)
    axes.set_yscale("log")
    least = float(np.min(gaps, initial=np.inf))
    axes.set_ylim(bottom=max(FLOOR, least / 2) if np.isfinite(least) else FLOOR)
    dots = "; dots: a contact begins" if meetings(record) else ""
    axes.set(xlabel="time (s)", ylabel=f"clearance (m){dots}")
    axes.grid(color="0.92")
    legend(record, axes)


def clearances_of(record: Record) -> Floats:
    """What was not recorded: meters to whatever is nearest after each step, (steps, robots)."""
    built = record.scenario.build()
    found = np.full((len(record), record.n_robots), np.inf)
    for k in range(len(record)):
        world = world_at(record, built, k + 1, masks=False)
        for i in present(record, k + 1):
            robot, q = built.robots[i], record["configurations"][k + 1, i]
            found[k, i] = float(world.clearance(robot.name, q[: robot.nq]).distance)
    return found


def masks(record: Record, axes: Axes) -> None:
    """How many bodies each robot's mask leaves, of all there are, by its next second."""
    built = record.scenario.build()
    counts, bodies = mask_counts(record, built)
    shown = axes.imshow(
        counts.T,
        aspect="auto",
        interpolation="nearest",
        cmap="cividis",
        extent=(0.0, len(record) * record.dt, record.n_robots - 0.5, -0.5),
    )
    bar = axes.figure.colorbar(shown, ax=axes)
    bar.set_label(f"bodies with the robot's bit, of {bodies}")
    bar.locator = whole()
    bar.update_ticks()
    if record.n_robots <= 2 * LEGEND:
        axes.set_yticks(range(record.n_robots), record.names)
    axes.set(xlabel="time (s)")


def whole() -> Any:
    """Ticks at whole numbers."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(integer=True)


def mask_counts(record: Record, built: Built) -> tuple[Floats, int]:
    """Candidates after each step, (steps, robots), and bodies that there are at first."""
    counts = np.zeros((len(record), record.n_robots))
    for k in range(len(record)):
        world = world_at(record, built, k + 1)
        for i in present(record, k + 1):
            counts[k, i] = len(world.candidates(built.robots[i].name))
    return counts, len(built.world())


def space_time(record: Record, axes: Axes) -> None:
    """Where along the longest way of the workspace each robot is, over time.

    Where two lines cross, robots passed each other.
    """
    built = record.scenario.build()
    places = [
        robot.forward(record["configurations"][:, i, : robot.nq], robot.root)[:, :3, 3]
        for i, robot in enumerate(built.robots)
        if robot.base != "fixed"
    ]
    if not places:
        raise ValueError("space-time: expected robots whose bases move")
    every = np.concatenate(places)
    axis = int(np.ptp(every, axis=0).argmax())
    times = record.dt * np.arange(len(record) + 1)
    moving = [i for i, robot in enumerate(built.robots) if robot.base != "fixed"]
    for i, place in zip(moving, places, strict=True):
        row = np.where(record["status"][:, i] != GONE, place[:, axis], np.nan)
        axes.plot(times, row, label=record.names[i], **style(i))
    for m in meetings(record):
        axes.plot(m.begin, m.point[axis], "o", mfc="none", mec=INK, ms=7)
    rings = "; rings: a contact begins" if meetings(record) else ""
    axes.set(xlabel="time (s)", ylabel=f"{'xyz'[axis]} (m){rings}")
    axes.grid(color="0.92")
    legend(record, axes)


KINDS: dict[str, Callable[[Record, Axes], None]] = {
    "clearance": clearance,
    "masks": masks,
    "space-time": space_time,
}
