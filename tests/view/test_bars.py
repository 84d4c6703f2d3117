"""Bars of ratios and learning curves show all their data."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure
from PIL import Image
from support.shell import Shell

from fgenv.bench.common import ratios
from fgenv.view.figures import bars, learning_curves

TIMES = {"a": {"fcl": 4.0, "coal": 0.5}, "b": {"coal": 120.0}}


def test_there_is_a_bar_for_every_ratio_and_a_line_at_one() -> None:
    axes = Figure().add_subplot()
    bars.draw_bars(axes, TIMES)
    bars.style_axes(axes, TIMES)
    groups = {str(g.get_label()): [b.get_x() + b.get_width() for b in g] for g in axes.containers}
    assert groups == {"fcl": [4.0], "coal": [0.5, 120.0]}
    places = [b.get_y() for group in axes.containers for b in group]
    assert len(set(places)) == 3
    assert [text.get_text() for text in axes.get_yticklabels()] == ["a", "b"]
    assert {text.get_text() for text in axes.texts} == {"4", "0.5", "120"}
    (line,) = axes.get_lines()
    assert np.all(np.asarray(line.get_xdata()) == 1.0)
    low, high = axes.get_xlim()
    assert low < 0.5 < 120.0 < high


def test_invalid_ratios_and_paths_are_errors(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    with pytest.raises(ValueError, match="no other library took part"):
        bars.plot_ratios({"a": {}}, "", path)
    with pytest.raises(
        ValueError, match=r"ratios\['a'\]\['fcl'\]: got nan, expected a number over 0"
    ):
        bars.plot_ratios({"a": {"fcl": np.nan}}, "", path)
    with pytest.raises(ValueError, match=r"--plot: .*a.gif, expected a name that ends in .png"):
        bars.plot_ratios(TIMES, "", tmp_path / "a.gif")
    bars.plot_ratios(TIMES, "", path)
    with Image.open(path) as picture:
        assert np.ptp(np.asarray(picture.convert("L"))) > 100


def test_ratios_are_those_of_the_measurements() -> None:
    peers = {"fgenv": {"batch": {"mean": 2.0}}, "fcl": {"batch": {"mean": 8.0}}}
    assert ratios.of_pairs([{"pair": "p", "peers": peers}]) == {"p": {"fcl": 4.0}}
    steps = {"fgenv": {"step": 2.0}, "coal": {"step": 1.0}, "mujoco": {"refused": "no"}}
    row = {"bodies": 1000, "triangles": 12, "peers": steps}
    assert ratios.of_steps([row]) == {"1,000 bodies, 12 triangles": {"coal": 0.5}}
    ways = {"certified": {"seconds": 0.5}, "coal": {"seconds": 2.0}, "fcl": {"seconds": None}}
    assert ratios.of_problems([{"problem": "x", "ways": ways}]) == {"x": {"coal": 4.0}}
    rates = [{"name": "fgenv", "gather": 30.0, "learn": 8.0}]
    rates += [{"name": "SuperSuit", "gather": 10.0, "learn": 4.0}]
    found = ratios.of_training(rates)
    assert found["gathered"]["SuperSuit"] == pytest.approx(3.0)
    assert found["learned from"]["SuperSuit"] == pytest.approx(2.0)


def test_a_wrong_plot_path_is_refused_before_the_race(shell: Shell) -> None:
    for race in ("pairs", "world", "env", "planners", "train"):
        assert "ends in .png, .svg, .pdf" in shell.refuses("bench", race, "--plot", "a.gif")
    assert "there is no folder no" in shell.refuses("bench", "env", "--plot", "no/a.png")


def test_learning_curves_are_the_trainings_own(shell: Shell) -> None:
    text = "steps,success,robot_success,collision,seconds\n100,0.1,0.5,0.4,9\n200,0.6,0.8,0.1,8\n"
    Path("e.csv").write_text(text)
    assert learning_curves.evaluations("e.csv")["success"] == [0.1, 0.6]
    code, _, err = shell("plot", "e.csv", "--kind", "learning", "--out", "a.png")
    assert (code, err) == (0, "")
    with Image.open("a.png") as picture:
        assert np.ptp(np.asarray(picture.convert("L"))) > 100
    for content, said in (
        ("a,b\n1,2\n", "expected the evaluations.csv"),
        (text[:46], "it has no evaluations yet"),
        (text[:46] + "100,x,1,1,1\n", "line 2 is not of numbers"),
    ):
        Path("e.csv").write_text(content)
        assert said in shell.refuses("plot", "e.csv", "--kind", "learning", "--out", "a.png")
