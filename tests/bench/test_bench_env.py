"""`fgenv bench env`, with an injected clock and in one round of each library."""

from __future__ import annotations

import json
import sys
from importlib.metadata import PackageNotFoundError
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fgenv.bench.common.records import geometric_means
from fgenv.bench.env import fgenv_, libraries
from fgenv.bench.env.batch import Batch, Library, race
from fgenv.bench.env.libraries import LIBRARIES
from fgenv.bench.env.report import NOTES, table_of
from fgenv.bench.env.run import CARTS, bench_env, rates, view_cost
from fgenv.cli import app, errors
from fgenv.scenarios import Scenario


class Clock:
    """Shows the seconds that steps said they took."""

    now = 0.0

    def __call__(self) -> float:
        return self.now

    def batch(self, robots: int, worlds: int, seconds: float, log: list[int]) -> Batch:
        """Takes this many seconds per robot-step, and ten times as many the first time."""

        def step(k: int) -> None:
            self.now += seconds * robots * worlds * (10.0 if not log else 1.0)
            log.append(k)

        return Batch(robots, worlds, step)

    def peer(self, name: str, seconds: float, batched: bool = True) -> Library:
        return Library(name, name, "json", batched, lambda n, e, _: self.batch(n, e, seconds, []))


class FakeSimulator:
    """Stands in for the simulator; a step takes 1 ms per robot, and 10 µs for each other robot."""

    action_size = 2

    def __init__(self, clock: Clock, scene: Scenario, worlds: int) -> None:
        self.clock, self.n_robots, self.n_worlds = clock, len(scene.robots), worlds
        self.fresh = False

    def reset(self, seed: int) -> None:
        self.fresh = True

    def step(self, actions: np.ndarray) -> None:
        assert self.fresh
        assert actions.shape == (self.n_worlds, self.n_robots, self.action_size)
        assert actions.dtype == np.float64
        assert np.abs(actions).max() <= 1.0
        cost = 1e-3 + 1e-5 * (self.n_robots - 1)
        self.clock.now += cost * self.n_robots * self.n_worlds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Rates of a stand-in simulator, and of the libraries beside it."""
    clock = Clock()
    monkeypatch.setattr(fgenv_, "simulator", lambda scene, e: FakeSimulator(clock, scene, e))
    monkeypatch.setattr(fgenv_, "views", lambda robots, seed: {})
    return clock


def test_a_race_tells_seconds_a_robot_step_and_takes_turns() -> None:
    clock, logs = Clock(), {"a": list[int](), "b": list[int]()}
    a, b = clock.batch(2, 3, 1e-3, logs["a"]), clock.batch(5, 1, 4e-3, logs["b"])
    times = race({"a": a, "b": b}, 3, 0.6, clock=clock)
    assert times["a"] == pytest.approx([1e-3] * 3)
    assert times["b"] == pytest.approx([4e-3] * 3)
    assert logs["a"][-100:] == list(range(100))  # 0.6 s at 6 ms
    assert logs["b"][-30:] == list(range(30))


def test_a_step_longer_than_a_round_is_done_once() -> None:
    clock, log = Clock(), list[int]()
    assert race({"a": clock.batch(1, 1, 5.0, log)}, 2, 0.1, clock=clock)["a"].tolist() == [5.0] * 2
    assert log == [0] * 4  # warm-up, trial, two rounds


def test_a_restart_is_not_timed() -> None:
    clock, begun = Clock(), list[float]()

    def restart() -> None:
        clock.now += 1.0
        begun.append(clock.now)

    made = clock.batch(1, 1, 1e-2, [])
    times = race({"a": Batch(1, 1, made.step, restart)}, 4, 0.1, clock=clock)
    assert times["a"] == pytest.approx([1e-2] * 4)
    assert len(begun) >= 4


def test_a_load_that_comes_and_goes_leaves_the_ratio() -> None:
    load = np.array([1.0, 2.0, 2.0, 1.0, 2.0])
    row = rates(4, 1, {"fgenv": 1e-6 * load, "VMAS": 8e-6 * load})
    assert row["ratio"] == pytest.approx({"VMAS": 8.0})
    found = row["peers"]["fgenv"]
    assert [found[k] for k in ("least", "rate", "most")] == pytest.approx([5e5, 5e5, 1e6])


def test_rows_ratios_and_tables(clock: Clock) -> None:
    racing = [LIBRARIES[0], clock.peer("VMAS", 8e-3), clock.peer("MPE2", 50e-3, batched=False)]
    done: dict[str, list[dict[str, Any]]] = {}
    for kind, record in bench_env(racing, quick=False, clock=clock):
        done.setdefault(kind, []).append(record)
    assert list(done) == ["rates", "warehouse", "growth"]
    rows = done["rates"]
    assert [(r["worlds"], r["robots"]) for r in rows] == [
        (worlds, robots) for worlds in (1, 32, 1024) for robots in (4, 10)
    ]
    for row in rows:
        others = ["VMAS", "MPE2"] if row["worlds"] == 1 else ["VMAS"]
        own = 1e-3 + 1e-5 * (row["robots"] - 1)
        assert list(row["peers"]) == ["fgenv", *others]
        assert row["peers"]["fgenv"]["rate"] == pytest.approx(1 / own)
        assert row["peers"]["VMAS"]["rate"] == pytest.approx(1 / 8e-3)
        assert row["ratio"] == pytest.approx(
            dict(zip(others, (8e-3 / own, 50e-3 / own), strict=False))
        )
    assert [r["robots"] for r in done["warehouse"]] == [CARTS] * 2
    (grown,) = done["growth"]
    assert grown["times"] == pytest.approx(1.63 / 1.07)
    overall = geometric_means(rows)
    assert overall["VMAS"]["worst"] == pytest.approx(8 / 1.09)
    json.dumps([done, overall])
    for kind, records in done.items():
        assert table_of(kind, records).row_count == (1 if kind == "growth" else len(records))
        assert NOTES[kind]


def test_without_fgenv_the_others_are_timed_alone() -> None:
    clock = Clock()
    done = list(bench_env([clock.peer("VMAS", 8e-3)], quick=True, clock=clock))
    assert [kind for kind, _ in done] == ["rates"] * 4
    assert done[0][1]["ratio"] == {}
    assert table_of("rates", [record for _, record in done]).row_count == 4


def test_a_view_costs_what_it_adds(clock: Clock) -> None:
    view = clock.batch(10, 1, 3e-6, [0])
    times = race({"view": view, "simulator": clock.batch(10, 1, 1e-6, [0])}, 1, 0.1, clock=clock)
    cost = view_cost("parallel_env", view, times)
    assert cost["overhead"] == pytest.approx(20e-6)
    assert cost["rate"] == pytest.approx(1 / 3)
    assert table_of("views", [cost]).row_count == 1


@pytest.mark.parametrize("robots", [4, 10, 64])
def test_our_scenes_are_sound_and_of_real_meshes(robots: int) -> None:
    scenes = [fgenv_.random_scene(robots, 0), fgenv_.warehouse_scene(robots, 0)]
    for scene in scenes:
        assert len(scene.robots) == robots
        assert scene.problems() == ()
        (model,) = scene.models.values()
        assert model.lidar is not None
        assert model.lidar.rays == fgenv_.RAYS
        assert len(scene.shapes[model.shape or ""].shape().faces) >= 200


@pytest.mark.parametrize(("name", "worlds"), [("VMAS", 1), ("VMAS", 3), ("MPE2", 1)])
def test_each_library_runs_a_round(name: str, worlds: int) -> None:
    library = next(one for one in LIBRARIES if one.name == name)
    pytest.importorskip(library.module)
    batch = library.make(4, worlds, 0)
    assert batch.size == 4 * worlds
    times = race({name: batch}, 2, 0.01)
    assert times[name].shape == (2,)
    assert (times[name] > 0).all()


def first_seen(out: Any) -> np.ndarray:
    """Observations (worlds, size) of the first agent."""
    return np.asarray(out[0][0])


def test_vmas_senses_and_collides_and_the_same_actions_do_the_same() -> None:
    pytest.importorskip("vmas")
    batch = libraries.navigation(4, 3, 0)
    outs = []
    for _ in range(2):
        batch.restart()
        outs.append([first_seen(batch.step(k)) for k in range(5)])
    assert outs[0][0].shape == (3, 2 + 2 + 2 + fgenv_.RAYS)
    assert np.array_equal(outs[0], outs[1])
    assert "pyglet.window" not in sys.modules  # needs a display


def test_mpe2_steps_one_world() -> None:
    pytest.importorskip("mpe2")
    with pytest.raises(ValueError, match="expected 1"):
        libraries.spread(4, 2, 0)


@pytest.mark.parametrize("name", ["vmas", "mpe2"])
def test_what_is_not_installed_is_told_with_the_remedy(name: str) -> None:
    told = errors.describe(PackageNotFoundError(name))
    assert told == f"{name} is not installed; remedy: pip install 'fgenv[bench]'"


def test_the_command_gives_one_document(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    made = [LIBRARIES[0], clock.peer("VMAS", 8e-3)]
    monkeypatch.setattr(libraries, "installed", lambda: made)
    monkeypatch.setattr(libraries, "versions", lambda: {"fgenv": "1", "vmas": "2"})
    defaults = dict(bench_env.__kwdefaults__ or {}, clock=clock)
    monkeypatch.setattr(bench_env, "__kwdefaults__", defaults)
    done = CliRunner().invoke(app, ["bench", "env", "--quick", "--json", "--seed", "3"])
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert said["settings"] == {"seed": 3, "quick": True}
    assert said["versions"]["vmas"] == "2"
    assert [row["worlds"] for row in said["rates"]] == [1, 1, 32, 32]
    assert said["summary"]["VMAS"]["mean"] > 1
    assert "VMAS" in done.stderr


@pytest.mark.slow
def test_the_command_races_the_libraries() -> None:
    pytest.importorskip("vmas")
    pytest.importorskip("mpe2")
    done = CliRunner().invoke(app, ["bench", "env", "--quick", "--json"])
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert {"vmas", "mpe2", "torch"} <= set(said["versions"])
    assert all(found["rate"] > 0 for row in said["rates"] for found in row["peers"].values())
