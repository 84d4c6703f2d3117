"""Policy files: round trip, verification, and errors."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fgenv.agents import NetworkPolicy, PolicyError, PolicyFile, RandomPolicy, RestPolicy
from fgenv.envs import Observation, Simulator, View, policy_of
from fgenv.registry import POLICIES

SEEN = Observation(lidar=False, neighbors=2, pad=True)


def made(near: float = 0.0, **about: Any) -> PolicyFile:
    """Return a small policy for `swap` of discs."""
    rng, sizes = np.random.default_rng(0), (20, 5, 2)
    layers = tuple((rng.normal(size=s), rng.normal(size=s[1])) for s in zip(sizes, sizes[1:]))  # noqa: B905, RUF007
    about = {
        "observation": asdict(SEEN),
        "parts": [["goal", 4], ["velocity", 2], ["neighbors", 14]],
        "actions": "drive",
        "action_names": [["v", "m/s", -1.0, 1.0], ["yaw_rate", "rad/s", -2.0, 2.0]],
        "near": near,
        "activation": "tanh",
        "clip": 10.0,
        **about,
    }
    return PolicyFile(about, rng.normal(size=20), rng.uniform(0.5, 2.0, 20), layers)


def test_save_and_load(tmp_path: Path) -> None:
    file = made(name="mine", command="by hand", seed=7)
    file.save(tmp_path / "policy.npz")
    again = PolicyFile.load(tmp_path / "policy.npz")
    assert (again.id, again.about) == (file.id, file.about)
    for name, array in file.arrays.items():
        np.testing.assert_array_equal(again.arrays[name], array)
    assert (tmp_path / "policy.npz").stat().st_size < 5_000


def test_actions_follow_from_the_weights() -> None:
    file = made()
    policy, simulator = NetworkPolicy(file), Simulator("swap", 3, n=4, observation=SEEN)
    rows = simulator.reset(seed=0)
    policy.reset(View(simulator))
    hidden = np.clip((rows - file.mean) / file.std, -10, 10)
    (w0, b0), (w1, b1) = file.layers
    expected = np.clip(np.tanh(hidden @ w0 + b0) @ w1 + b1, -1, 1)
    np.testing.assert_allclose(policy.act(rows), expected, atol=1e-12)


def test_goto_acts_near_the_goal() -> None:
    file = made(near=4.0)
    plain, added = NetworkPolicy(made()), NetworkPolicy(file)
    simulator = Simulator("swap", n=4, jitter=0.3, seed=5, observation=SEEN)
    rows = simulator.reset(seed=0)
    for policy in (plain, added):
        policy.reset(View(simulator))
    goto, there = simulator.toward(simulator.goals), simulator.remaining[..., None] < 4.0
    assert 0 < there.sum() < 4
    np.testing.assert_array_equal(added.act(rows), np.where(there, goto, plain.act(rows)))


def test_way_points_have_another_action_size(tmp_path: Path) -> None:
    """Way points are configurations: three numbers for a drive with two."""
    file = made(actions="way_points")
    (first, (w, b)) = file.layers
    wider = (np.concatenate([w, w[:, :1]], axis=1), np.concatenate([b, b[:1]]))
    replace(file, layers=(first, wider)).save(tmp_path / "policy.npz")
    policy = NetworkPolicy.load(tmp_path / "policy.npz")
    simulator = Simulator("swap", n=3, observation=SEEN, actions="way_points")
    rows = simulator.reset(seed=0)
    policy.reset(View(simulator))
    assert policy.act(rows).shape == (1, 3, simulator.action_size) == (1, 3, 3)


def test_damaged_files_raise(tmp_path: Path) -> None:
    path = tmp_path / "policy.npz"
    made().save(path)
    whole = path.read_bytes()
    for bad in (whole[:-30], b"", whole[:100] + b"\0" * 20 + whole[120:]):
        path.write_bytes(bad)
        with pytest.raises(PolicyError, match="is damaged, or no policy"):
            PolicyFile.load(path)
    with np.load(_saved(tmp_path)) as file:
        arrays = dict(file)
    np.savez(path, **{**arrays, "offsets_1": arrays["offsets_1"] + 1})
    with pytest.raises(PolicyError, match="is damaged"):
        PolicyFile.load(path)
    np.savez(path, **{**arrays, "format": "fgenv policy 2"})
    with pytest.raises(PolicyError, match="got 'fgenv policy 2', expected 'fgenv policy 1'"):
        PolicyFile.load(path)


def _saved(folder: Path) -> Path:
    made().save(folder / "good.npz")
    return folder / "good.npz"


def test_inconsistent_contents_raise(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        PolicyFile.load(tmp_path / "none.npz")
    with pytest.raises(ValueError, match=r"expected a name that ends in \.npz"):
        made().save(tmp_path / "policy.zip")
    with pytest.raises(PolicyError, match="activation: got 'gelu', expected tanh or relu"):
        made(activation="gelu")
    with pytest.raises(PolicyError, match=r"mean, std: expected \(6,\)"):
        made(parts=[["goal", 4], ["velocity", 2]])
    for change, message in (
        ({"layers": ()}, "layers: got none, expected from 20 to 2"),
        ({"layers": made().layers[:1]}, "layers: got from 20 to 5 numbers, expected from 20 to 2"),
        ({"mean": np.full(20, np.nan)}, "mean, std: expected finite numbers"),
        ({"about": {"near": 0.0}}, "action_names, actions, activation, clip, .* missing"),
    ):
        with pytest.raises(PolicyError, match=message):
            replace(made(), **change)
    with pytest.raises(
        ValueError, match="policy: got 'mlp:', expected mlp:FILE or an included policy: mlp:"
    ):
        policy_of("mlp:")
    (tmp_path / "model.zip").write_bytes(b"no zip")
    pytest.importorskip("stable_baselines3")
    with pytest.raises(ValueError, match="expected a model that Stable-Baselines3 saved"):
        policy_of(f"sb3:{tmp_path / 'model.zip'}")


def test_policies_of_entry_points(monkeypatch: pytest.MonkeyPatch) -> None:
    class Point:
        @staticmethod
        def load() -> Any:
            return lambda argument, seed: RandomPolicy(seed + len(argument))

    asked = []

    def points(*, group: str, name: str) -> list[type[Point]]:
        asked.append((group, name))
        return [Point] if name == "mine" else []

    monkeypatch.setattr("fgenv.envs.policy.entry_points", points)
    assert isinstance(policy_of("mine:abc", 4), RandomPolicy)
    assert asked == [("fgenv.policies", "mine")]
    with pytest.raises(ValueError, match="policy: got 'yours', which is unknown"):
        policy_of("yours")


def test_a_registered_factory_must_make_a_policy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICIES, "three", lambda argument, seed: 3)
    with pytest.raises(TypeError, match="'three' makes a int, expected one with"):
        policy_of("three")
    monkeypatch.setitem(POLICIES, "three", "fgenv.agents.policies.rest:rest")
    assert isinstance(policy_of("three"), RestPolicy)
