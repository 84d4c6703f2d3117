"""Records: round trip and replay, bit for bit."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from fgenv.agents import GoToPolicy, run_episode
from fgenv.envs import Record, Recorder, RecordError, Simulator, View, policy_of, replay
from fgenv.envs.record import ARRAYS
from fgenv.scenarios import Scenario, frozen

CASES: list[tuple[str, dict[str, Any]]] = [
    ("three_tanks", {}),
    ("cell", {}),
    ("corridor", {"at_goal": "vanish", "on_collision": "pass"}),
    ("doorway", {"n": 1}),
    ("forest", {"n": 3, "cases": 4}),
    ("intersection", {"n": 4, "on_collision": "terminate"}),
    ("random", {"n": 5, "starts": "random"}),
    ("swap", {"n": 4, "actions": "way_points", "way_point_seconds": 0.5}),
    ("warehouse", {"n": 6, "at_goal": "vanish"}),
]


def recorded(name: str | Scenario, policy: str = "goto", steps: int = 40, **options: Any) -> Record:
    simulator = Simulator(name, autoreset=False, **options)
    return run_episode(simulator, policy_of(policy, 1), seed=5, steps=steps)


@pytest.fixture(scope="module")
def record() -> Record:
    return recorded("swap", "random", n=3, clearance=True)


def same(a: Record, b: Record) -> bool:
    return a.id == b.id and all(a[k].tobytes() == b[k].tobytes() for k in ARRAYS)


@pytest.mark.parametrize("policy", ["goto", "random"])
@pytest.mark.parametrize(("name", "options"), CASES, ids=[name for name, _ in CASES])
def test_round_trip_and_replay_are_equal_bit_for_bit(
    name: str, options: dict[str, Any], policy: str, tmp_path: Path
) -> None:
    record = recorded(name, policy, **options)
    record.save(tmp_path / "run.npz")
    again = Record.load(tmp_path / "run.npz")
    assert same(again, record)
    assert again.scenario.at(None) == record.scenario.at(None)
    assert again.about == record.about
    end = replay(again, threads=2)
    np.testing.assert_array_equal(end.configurations[0], record["configurations"][-1])
    assert end.steps[0] == len(record)


def test_contents_of_a_record(record: Record) -> None:
    simulator = Simulator("swap", n=3, autoreset=False, clearance=True)
    simulator.reset(seed=5)
    assert (record.n_robots, record.names, record.dt) == (3, simulator.names, simulator.dt)
    assert (record.policy, record.about["seed"], record.about["episode"]) == ("RandomPolicy", 5, 0)
    assert record.about["ended"] == "stopped"
    for k, actions in enumerate(record["actions"]):
        assert record["configurations"][k].tobytes() == simulator.configurations[0].tobytes()
        step = simulator.step(actions[None])
        assert record["rewards"][k].tobytes() == step.rewards[0].tobytes()
        assert record["clearances"][k].tobytes() == simulator.clearances[0].tobytes()


def test_collisions_have_names() -> None:
    record = recorded("doorway", n=2, steps=60)
    step, robot = np.argwhere(record["hits"] >= 0)[0]
    name = record.about["names"][str(record["hits"][step, robot])]
    assert name in {*record.names, *(body.name for body in record.scenario.bodies)}
    other = record["hit_robots"][step, robot]
    assert other == -1 or record.names[other] == name
    assert 0 <= record["hit_times"][step, robot] <= record.dt


@pytest.mark.parametrize(
    ("options", "ended"),
    [
        ({"on_collision": "terminate"}, "terminated"),
        ({"on_collision": "pass"}, "terminated"),
        ({"horizon": 2.0}, "truncated"),
    ],
)
def test_end_of_the_episode(options: dict[str, Any], ended: str) -> None:
    record = recorded("swap", n=2, steps=600, **options)
    assert record.about["ended"] == ended
    replay(record)


def test_a_case_of_a_frozen_set_is_a_scenario() -> None:
    several = frozen("random", n=3, cases=6)
    for seed in range(4):
        simulator = Simulator(several, autoreset=False)
        record = run_episode(simulator, GoToPolicy(), seed=seed, steps=5)
        case = several[int(simulator.case_numbers[0])]
        assert record.scenario == case
        replay(record)


def test_recording_one_of_several_worlds() -> None:
    simulator = Simulator("swap", 3, n=2, jitter=0.3, autoreset=False, starts="random")
    recorder, policy = Recorder("goto"), GoToPolicy()
    observations = simulator.reset(seed=7)
    recorder.begin(simulator, 2)
    policy.reset(View(simulator))
    for _ in range(10):
        actions = policy.act(observations)
        step = simulator.step(actions)
        observations = step.observations
        recorder.add(actions, step)
    record = recorder.record()
    assert record.about["seed"] == 9
    np.testing.assert_array_equal(record["configurations"][-1], simulator.configurations[2])
    replay(record)


def test_arrays_are_read_only(record: Record) -> None:
    with pytest.raises(ValueError, match="read-only"):
        record["actions"][:] = 0


def test_a_record_of_an_interrupted_episode(tmp_path: Path) -> None:
    class Tired(GoToPolicy):
        left = 6

        def act(self, observations: np.ndarray) -> np.ndarray:
            self.left -= 1
            if self.left < 0:
                raise KeyboardInterrupt
            return super().act(observations)

    recorder = Recorder("tired")
    with pytest.raises(KeyboardInterrupt):
        run_episode(Simulator("swap", n=2, autoreset=False), Tired(), recorder=recorder)
    recorder.record().save(tmp_path / "run.npz")
    record = Record.load(tmp_path / "run.npz")
    assert (len(record), record.about["ended"]) == (6, "stopped")
    replay(record)


def test_a_record_without_steps(tmp_path: Path) -> None:
    record = recorded("cell", steps=0)
    record.save(tmp_path / "run.npz")
    again = Record.load(tmp_path / "run.npz")
    assert (len(again), again["configurations"].shape, again["actions"].shape) == (
        (0, (1, 2, 6), (0, 2, 6))
    )
    replay(again)


def test_files_are_compact(tmp_path: Path) -> None:
    record = recorded("warehouse", "goto", steps=300)
    record.save(tmp_path / "run.npz")
    assert (tmp_path / "run.npz").stat().st_size < 0.1 * sum(record[k].nbytes for k in ARRAYS)


# Files of the scenario


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with a scenario file, a mesh and a URDF."""
    trimesh.creation.box((0.5, 0.4, 0.3)).export(tmp_path / "cart.stl")
    library = Path(str(__import__("fgenv").__file__)).parent / "scenarios" / "library"
    shutil.copy(library / "arm.urdf", tmp_path / "arm.urdf")
    text = """
version: 1
name: own
shapes: {cart: {kind: mesh, file: cart.stl}}
models:
  cart: {shape: cart, drive: {kind: holonomic, speed: 1.0, turn_rate: 1.0}}
  arm: {urdf: arm.urdf, drive: {kind: joint_velocity}}
robots:
- {name: a, model: cart, start: [0, 0, 0], goal: [2, 1, 1]}
- name: b
  model: arm
  start: [0, -1, 1.5, 0, 0.5, 0]
  goal: [1, -1, 1.5, 0, 0.5, 0]
  mount: {position: [5, 5, 0]}
"""
    (tmp_path / "own.yaml").write_text(text, encoding="utf-8")
    return tmp_path


def test_mesh_paths_are_relative_to_the_record(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = recorded(Scenario.load(folder / "own.yaml"))
    (folder / "runs").mkdir()
    record.save(folder / "runs" / "run.npz")
    monkeypatch.chdir("/")
    again = Record.load(folder / "runs" / "run.npz")
    assert again.scenario.shapes["cart"].file == "../cart.stl"  # type: ignore[union-attr]
    replay(again)
    shutil.move(folder / "runs", folder / "else")
    replay(Record.load(folder / "else" / "run.npz"))


@pytest.mark.parametrize("name", ["cart.stl", "arm.urdf"])
def test_a_changed_file_raises(folder: Path, name: str) -> None:
    record = recorded(Scenario.load(folder / "own.yaml"))
    record.save(folder / "run.npz")
    (folder / name).write_bytes((folder / name).read_bytes() + b"\n")
    with pytest.raises(RecordError, match=r"sha256 of cart.stl|URDF file of 'arm' has changed"):
        replay(Record.load(folder / "run.npz"))
    (folder / name).unlink()
    with pytest.raises((RecordError, FileNotFoundError), match=name):
        replay(Record.load(folder / "run.npz"))


# Damage


@pytest.fixture(scope="module")
def saved(record: Record, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("record") / "run.npz"
    record.save(path)
    return path.read_bytes()


@settings(max_examples=150)
@given(st.data())
def test_a_damaged_file_raises_or_is_equal(saved: bytes, record: Record, data: Any) -> None:
    path = Path(tempfile.gettempdir()) / f"damaged-{os.getpid()}.npz"
    at = data.draw(st.integers(0, len(saved) - 1))
    cut = data.draw(st.booleans())
    bad = saved[:at] if cut else saved[:at] + bytes([saved[at] ^ 0xFF]) + saved[at + 1 :]
    path.write_bytes(bad)
    message = ""
    try:
        assert same(Record.load(path), record)
    except RecordError as error:
        message = str(error)
    finally:
        path.unlink()
    assert message in ("", f"{path}: is damaged, or no record; record the run again")


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x03\x04", b"\x93NUMPY"])
def test_other_contents_raise(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(RecordError, match="is damaged, or no record"):
        Record.load(path)


def test_other_kinds_of_files_raise(tmp_path: Path, saved: bytes) -> None:
    with pytest.raises(FileNotFoundError):
        Record.load(tmp_path / "none.npz")
    frozen("swap", n=2, cases=2).save(tmp_path / "set.npz")
    with pytest.raises(RecordError, match="got a frozen set, expected a record; use run or eval"):
        Record.load(tmp_path / "set.npz")
    np.save(tmp_path / "a.npy", np.zeros(3))
    with pytest.raises(RecordError, match="no record"):
        Record.load(tmp_path / "a.npy")
    (tmp_path / "run.npz").write_bytes(saved)
    with np.load(tmp_path / "run.npz") as file:
        parts = {name: file[name] for name in file.files}
    for change, message in (
        ({"format": "fgenv record 2"}, "got 'fgenv record 2', expected 'fgenv record 1'; use the"),
        ({"actions": parts["actions"] * 0.5}, "is damaged"),
        ({"scenario": str(parts["scenario"]).replace("swap", "swop")}, "is damaged"),
        ({"rewards": np.array(["x"])}, "rewards: got <U1"),
    ):
        np.savez_compressed(tmp_path / "other.npz", **{**parts, **change})
        with pytest.raises(RecordError, match=message):
            Record.load(tmp_path / "other.npz")


def test_names_without_npz_raise(record: Record, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"expected a name that ends in \.npz"):
        record.save(tmp_path / "run.json")
    with pytest.raises(FileNotFoundError):
        record.save(tmp_path / "none" / "run.npz")


def test_saving_is_atomic(record: Record, tmp_path: Path) -> None:
    for _ in range(2):
        record.save(tmp_path / "run.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


# Replay


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("actions", "step 8: configurations of 'robot 2'"),
        ("configurations", "step 7: configurations of 'robot 2'"),
        ("hit_times", "step 8: hit_times of 'robot 2'"),
    ],
)
def test_replay_names_the_first_step_that_differs(record: Record, name: str, message: str) -> None:
    arrays = {key: np.array(record[key]) for key in ARRAYS}
    arrays[name][7, 1] = np.nextafter(arrays[name][7, 1], 2.0) if name != "actions" else 0.1
    other = Record(record.scenario, record.about, arrays)
    with pytest.raises(RecordError, match=message):
        replay(other)


def test_inconsistent_arrays_raise(record: Record) -> None:
    arrays = {key: np.array(record[key]) for key in ARRAYS}
    arrays["hits"] = arrays["hits"][:-1]
    with pytest.raises(RecordError, match=r"hits: got shape \(39, 3\), expected \(40, 3\)"):
        Record(record.scenario, record.about, arrays)


# Errors of the recorder


def test_wrong_use_raises() -> None:
    recorder = Recorder()
    with pytest.raises(RuntimeError, match="nothing is recorded"):
        recorder.record()
    with pytest.raises(ValueError, match="autoreset=True, expected False"):
        recorder.begin(Simulator("swap", n=2))
    simulator = Simulator("swap", n=2, autoreset=False)
    with pytest.raises(ValueError, match="call reset"):
        recorder.begin(simulator)
    simulator.reset(seed=0)
    with pytest.raises(ValueError, match="world: got 1, expected 0 to 0"):
        recorder.begin(simulator, 1)
    actions = simulator.sample(np.random.default_rng(0))
    step = simulator.step(actions)
    with pytest.raises(RuntimeError, match=r"expected begin\(\)"):
        recorder.add(actions, step)
    with pytest.raises(ValueError, match="got a running episode, expected its start"):
        recorder.begin(simulator)
    simulator.reset(seed=0)
    recorder.begin(simulator)
    recorder.add(actions, simulator.step(actions))
    simulator.step(actions)
    with pytest.raises(RuntimeError, match=r"add\(\) for each step"):
        recorder.add(actions, simulator.step(actions))
    assert len(recorder.record()) == 1
