"""Plots of a record: clearances, masks, and positions over time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Record
from fgenv.envs.contact_events import contact_events
from fgenv.envs.state_readers import GONE
from fgenv.scenarios import Built
from fgenv.scenarios.errors import near
from fgenv.view.figures.canvas import check_plot_path, legend_beside, new_figure, save_figure
from fgenv.view.figures.palette import INK, TEAM, robot_color
from fgenv.view.mask_links import present_robots, world_at
from fgenv.view.robot_poses import base_paths

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DASHES = ("-", "--", ":", "-.")  # the next one each time that the colors repeat
MAX_NAMED = 12  # robots in a legend
MIN_CLEARANCE = 1e-4  # meters; smaller clearances are drawn as this


def plot_record(record: Record, kind: str, path: str | Path) -> None:
    """Write a plot of a record.

    Args:
        kind: one of `KINDS`.
        path: file that ends in .png, .svg or .pdf.

    Raises:
        ValueError: an unknown kind or suffix, or a record without the data of that kind.
        ImportError: Matplotlib is missing, with the remedy.
    """
    if kind not in KINDS:
        raise ValueError(f"kind: got {kind!r}; {near(kind, KINDS)}")
    path = check_plot_path(path)
    if len(record) == 0:
        raise ValueError("record: it has no steps, nothing to plot")
    figure = new_figure(7.2, 4.2)
    axes = figure.add_subplot()
    axes.set_title(f"{record.scenario.name}: {record.n_robots} robots, {record.policy}", loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    KINDS[kind](record, axes)
    save_figure(figure, path)


def line_style(i: int) -> dict[str, Any]:
    """Return the style of robot i's line."""
    return {"color": robot_color(i), "linestyle": DASHES[i // len(TEAM) % len(DASHES)], "lw": 1.4}


def name_robots(record: Record, axes: Axes) -> None:
    """Add a grid, and a legend unless there are too many robots."""
    axes.grid(color="0.92")
    if record.n_robots <= MAX_NAMED:
        legend_beside(axes)


def plot_clearances(record: Record, axes: Axes) -> None:
    """Plot each robot's distance to the nearest body; dots at the bottom mark contacts."""
    recorded, events = record["clearances"], contact_events(record)
    gaps = recorded if np.isfinite(recorded).any() else clearances_of(record)
    times = record.dt * np.arange(1, len(record) + 1)
    for i, name in enumerate(record.names):
        row = np.where(np.isfinite(gaps[:, i]), np.maximum(gaps[:, i], MIN_CLEARANCE), np.nan)
        axes.plot(times, row, label=name, **line_style(i))
    for e in events:
        color = robot_color(e.robot)
        axes.plot(e.begin, MIN_CLEARANCE, "o", color=color, mec=INK, ms=5, clip_on=False)
    axes.set_yscale("log")
    least = float(np.min(gaps, initial=np.inf))
    axes.set_ylim(bottom=max(MIN_CLEARANCE, least / 2) if np.isfinite(least) else MIN_CLEARANCE)
    dots = "; dots: a contact begins" if events else ""
    axes.set(xlabel="time (s)", ylabel=f"clearance (m){dots}")
    name_robots(record, axes)


def clearances_of(record: Record) -> Floats:
    """Compute the distance to the nearest body after each step, (steps, robots), meters."""
    built = record.scenario.build()
    clearances = np.full((len(record), record.n_robots), np.inf)
    for k in range(len(record)):
        world = world_at(record, built, k + 1, masks=False)
        for i in present_robots(record, k + 1):
            robot, q = built.robots[i], record["configurations"][k + 1, i]
            clearances[k, i] = float(world.clearance(robot.name, q[: robot.nq]).distance)
    return clearances


def plot_masks(record: Record, axes: Axes) -> None:
    """Plot the number of bodies in each robot's mask for the motion of its next second."""
    from matplotlib.ticker import MaxNLocator

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
    bar.locator = MaxNLocator(integer=True)
    bar.update_ticks()
    if record.n_robots <= 2 * MAX_NAMED:
        axes.set_yticks(range(record.n_robots), record.names)
    axes.set(xlabel="time (s)")


def mask_counts(record: Record, built: Built) -> tuple[Floats, int]:
    """Return the candidates after each step, (steps, robots), and the initial number of bodies."""
    counts = np.zeros((len(record), record.n_robots))
    for k in range(len(record)):
        world = world_at(record, built, k + 1)
        for i in present_robots(record, k + 1):
            counts[k, i] = len(world.candidates(built.robots[i].name))
    return counts, len(built.world())


def plot_space_time(record: Record, axes: Axes) -> None:
    """Plot the position of each mobile robot along the axis of the longest travel, over time."""
    paths = base_paths(record, record.scenario.build())
    if not paths:
        raise ValueError("space-time: expected robots with mobile bases")
    axis = int(np.ptp(np.concatenate(list(paths.values())), axis=0).argmax())
    times, events = record.dt * np.arange(len(record) + 1), contact_events(record)
    for i, path in paths.items():
        row = np.where(record["status"][:, i] != GONE, path[:, axis], np.nan)
        axes.plot(times, row, label=record.names[i], **line_style(i))
    for e in events:
        axes.plot(e.begin, e.point[axis], "o", mfc="none", mec=INK, ms=7)
    rings = "; rings: a contact begins" if events else ""
    axes.set(xlabel="time (s)", ylabel=f"{'xyz'[axis]} (m){rings}")
    name_robots(record, axes)


KINDS: dict[str, Callable[[Record, Axes], None]] = {
    "clearance": plot_clearances,
    "masks": plot_masks,
    "space-time": plot_space_time,
}
