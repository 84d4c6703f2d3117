"""Plots of a record show its data."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support.shell import Shell

from fgenv.agents import run_episode
from fgenv.envs import Record, Simulator, policy_of

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure

from fgenv.view.figures.record_plots import KINDS, clearances_of, mask_counts, plot_record


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("corridor", n=4, clearance=True, autoreset=False)
    return run_episode(simulator, policy_of("goto"), steps=20)


def test_clearances_that_were_not_recorded_are_the_same(record: Record) -> None:
    np.testing.assert_allclose(clearances_of(record), record["clearances"], atol=1e-9)


def test_lines_are_the_robots_own(record: Record) -> None:
    axes = Figure().add_subplot()
    KINDS["space-time"](record, axes)
    lines = {str(line.get_label()): line for line in axes.get_lines()}
    for i, name in enumerate(record.names):
        found = np.asarray(lines[name].get_ydata())
        np.testing.assert_allclose(found, record["configurations"][:, i, 0], atol=1e-12)


def test_masks_count_candidates(record: Record) -> None:
    counts, bodies = mask_counts(record, record.scenario.build())
    assert counts.shape == (len(record), 4)
    assert 0 < counts.max() < bodies
    touched = record["hits"] >= 0
    assert (counts[touched] >= 1).all()  # a body in contact is a candidate


def test_records_without_the_data_are_errors(record: Record, tmp_path: Path) -> None:
    simulator = Simulator("cell", n=2, autoreset=False)
    arms = run_episode(simulator, policy_of("rest"), steps=2)
    with pytest.raises(ValueError, match="expected robots with mobile bases"):
        plot_record(arms, "space-time", tmp_path / "a.png")
    plot_record(arms, "clearance", tmp_path / "a.png")
    arrays = {name: array[:0] for name, array in record.arrays.items()}
    arrays |= {name: record[name][:1] for name in ("configurations", "status")}
    with pytest.raises(ValueError, match="it has no steps"):
        plot_record(replace(record, arrays=arrays), "masks", tmp_path / "a.png")


def test_command(record: Record, shell: Shell) -> None:
    record.save("run.npz")
    for kind in KINDS:
        code, out, err = shell("plot", "run.npz", "--kind", kind, "--out", "a.png")
        assert (code, err) == (0, "")
        assert out == f"written: a.png, {Path('a.png').stat().st_size:,} bytes\n"
        with Image.open("a.png") as picture:
            assert np.ptp(np.asarray(picture.convert("L"))) > 100
    for kind, path, said in (
        ("speed", "a.png", "--kind: got 'speed'; expected one of: clearance, masks, space-time"),
        ("learning", "a.png", "run.npz: expected the evaluations.csv"),
        ("masks", "a.gif", "ends in .png, .svg, .pdf"),
        ("masks", "no/a.png", "there is no folder no"),
    ):
        assert said in shell.refuses("plot", "run.npz", "--kind", kind, "--out", path)
