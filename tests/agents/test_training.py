"""Training: files, determinism, and resuming."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from fgenv import cli
from fgenv.agents import PolicyFile, run_episode
from fgenv.agents.policies.network import NetworkPolicy
from fgenv.agents.policies.sb3 import Sb3Policy
from fgenv.agents.training.config import Recipe, Stage, TrainingConfig
from fgenv.agents.training.recipes import RECIPES, recipe_of, three_stages
from fgenv.agents.training.training import Training
from fgenv.envs import Simulator, View, policy_of
from fgenv.scenarios import Scenario

SMALL: dict[str, Any] = {
    "cases": 3,
    "rows": 16,
    "n_steps": 32,
    "n_epochs": 2,
    "batch_size": 128,
    "max_steps": 40,
    "net_arch": (8,),
}
FEW = three_stages(*({"n": n} for n in (4, 6, 8)), jitter=0.3)
SWAP = replace(recipe_of("swap"), **SMALL, stages=FEW)


def trained(
    folder: Path, recipe: Recipe = SWAP, *, resume: bool = False, **fields: Any
) -> PolicyFile:
    """Run a training of some thousand steps."""
    given = {"scenario": "swap", "steps": 2_000, "every": 1_000, **fields}
    return Training(TrainingConfig(recipe=recipe, **given), folder, resume=resume).run()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a training."""
    made = tmp_path_factory.mktemp("training")
    trained(made)
    return made


def test_files_of_a_training(folder: Path) -> None:
    rows = (folder / "evaluations.csv").read_text().splitlines()
    assert rows[0].startswith("steps,success")
    assert [row.split(",")[0] for row in rows] == ["steps", "1152", "2304"]
    state = json.loads((folder / "training.json").read_text())
    assert state["steps"] >= 2_000
    assert list((folder / "log").rglob("progress.csv"))


def test_the_policy_runs_without_torch(folder: Path) -> None:
    code = (
        "import sys; from fgenv.agents import run_episode; from fgenv.envs import policy_of;"
        "from fgenv.envs import Simulator;"
        f"p = policy_of('mlp:{folder / 'policy.npz'}');"
        "s = Simulator('swap', n=5, observation=p.observation, autoreset=False);"
        "run_episode(s, p, steps=5); assert s.traveled.min() > 0;"
        "assert not {'torch', 'stable_baselines3'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_exported_network_equals_the_model(folder: Path) -> None:
    model = Sb3Policy(folder / "model.zip")
    acts: list[list[np.ndarray]] = []
    training = Training(TrainingConfig("swap", SWAP, steps=2_000, every=1_000), folder, resume=True)
    training.begin_stage(0)
    for policy in (NetworkPolicy(training.export()), model):
        simulator = Simulator("swap", 4, n=6, jitter=0.3, observation=policy.observation)
        rows = simulator.reset(seed=0)
        policy.reset(View(simulator))
        acts.append([])
        for k in range(20):
            acts[-1].append(policy.act(rows))
            rows = simulator.step(np.full((4, 6, 2), 0.1 * (k % 5))).observations
    np.testing.assert_allclose(acts[0], acts[1], atol=2e-5)


@pytest.mark.slow
def test_over_orca_with_held_noise_the_exported_network_equals_the_model(tmp_path: Path) -> None:
    recipe = replace(recipe_of("doorway"), **{**SMALL, "rows": 12}, sde_sample_freq=8)
    assert recipe.orca
    given: dict[str, Any] = {
        "recipe": recipe,
        "scenario": "doorway",
        "overrides": {"drive": "holonomic"},
    }
    file = trained(tmp_path / "one", **given)
    assert trained(tmp_path / "two", **given).id == file.id
    training = Training(
        TrainingConfig(steps=2_000, every=1_000, **given), tmp_path / "one", resume=True
    )
    training.begin_stage(0)
    assert training.model.use_sde
    assert training.model.sde_sample_freq == recipe.sde_sample_freq
    acts = []
    for policy in (NetworkPolicy(training.export()), Sb3Policy(tmp_path / "one" / "model.zip")):
        simulator = Simulator("doorway", 2, n=3, drive="holonomic", observation=policy.observation)
        rows = simulator.reset(seed=0)
        policy.reset(View(simulator))
        acts.append([policy.act(rows)])
        for _ in range(20):
            rows = simulator.step(acts[0][len(acts[-1]) - 1]).observations
            acts[-1].append(policy.act(rows))
    np.testing.assert_allclose(acts[0], acts[1], atol=2e-5)
    policy = NetworkPolicy(file)
    assert policy.observation is not None
    seen = replace(policy.observation, pad=False)  # two neighbors instead of six
    simulator = Simulator("doorway", 2, n=3, drive="holonomic", observation=seen)
    rows = simulator.reset(seed=0)
    policy.reset(View(simulator))
    padded = Simulator("doorway", 2, n=3, drive="holonomic", observation=policy.observation)
    other, expected = NetworkPolicy(file), padded.reset(seed=0)
    other.reset(View(padded))
    assert (policy.act(rows) == other.act(expected)).all()


def test_same_seed_same_file(folder: Path, tmp_path: Path) -> None:
    assert trained(tmp_path / "again").id == PolicyFile.load(folder / "policy.npz").id
    assert trained(tmp_path / "other", seed=1).id != PolicyFile.load(folder / "policy.npz").id


def test_resume_continues(tmp_path: Path) -> None:
    recipe = replace(SWAP, stages=(Stage(1.0, base={"n": 2}),))
    trained(tmp_path, recipe, steps=1_000)
    trained(tmp_path, recipe, steps=3_000, resume=True)
    steps = [row.split(",")[0] for row in (tmp_path / "evaluations.csv").read_text().splitlines()]
    assert steps == ["steps", "1024", "2048", "3072"], "none twice"
    with pytest.raises(ValueError, match="--resume: seed: got another value, expected 0 as before"):
        trained(tmp_path, recipe, seed=5, resume=True)
    with pytest.raises(ValueError, match="which has no training"):
        trained(tmp_path / "empty", recipe, resume=True)


def test_training_on_a_scenario_file(tmp_path: Path) -> None:
    Scenario.load("swap", n=2).save(tmp_path / "two.yaml")
    recipe = replace(recipe_of("swap"), **SMALL, stages=(Stage(1.0, "random"),))
    file = trained(tmp_path, recipe, scenario=str(tmp_path / "two.yaml"), steps=600, every=512)
    assert file.about["steps"] >= 512


def test_recipes_are_complete() -> None:
    for name, _, recipe in RECIPES:
        assert sum(stage.share for stage in recipe.stages) == pytest.approx(1.0), name
        assert recipe.observation.pad, name


def test_the_most_specific_recipe_is_used() -> None:
    assert recipe_of("swap", {"n": 4, "drive": "holonomic"}) == recipe_of(
        "swap", {"drive": "holonomic"}
    )
    bars = recipe_of("swap", {"body": "long"})
    assert recipe_of("swap", {"body": "long", "drive": "holonomic"}).near < bars.near
    assert recipe_of("swap", {"body": "l"}).near < bars.near
    assert recipe_of("swap", {"body": "l", "drive": "differential"}) == bars
    assert recipe_of("mine.yaml", {"n": 4}) == recipe_of("other")


def test_the_learning_rate_decreases_to_zero(tmp_path: Path) -> None:
    falling = replace(SWAP, anneal=True)
    training = Training(TrainingConfig("swap", falling, {"n": 3}, 2000, 0, "", 1000), tmp_path)
    rates = []
    training.run(lambda steps, check: rates.append(training.learning_rate(0.0)))
    assert rates[0] > 0.9 * SWAP.learning_rate
    assert rates == sorted(rates, reverse=True)
    assert rates[-1] == 0.0
    used = training.model.policy.optimizer.param_groups[0]["lr"]
    assert used < 0.5 * SWAP.learning_rate


def test_the_command_trains_and_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("fgenv.agents.training.recipes.RECIPES", (("swap", {}, SWAP),))
    found = []
    for line in (
        f"train swap --n 3 --steps 600 --every 512 --out {tmp_path} --json",
        f"run swap --n 3 --policy mlp:{tmp_path / 'policy.npz'} --steps 3 --json",
        f"run swap --n 3 --policy sb3:{tmp_path / 'model.zip'} --steps 3 --json",
    ):
        monkeypatch.setattr(sys, "argv", ["fgenv", *line.split()])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        assert not stopped.value.code
        found.append(json.loads(capsys.readouterr().out))
    assert found[0]["command"] == "fgenv train swap --n 3 --steps 600 --every 512 --seed 0"
    assert found[1]["steps"] == found[2]["steps"] == 3


def test_an_older_policy_in_the_folder_is_not_reported(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    (tmp_path / "policy.npz").write_bytes((folder / "policy.npz").read_bytes())
    monkeypatch.setattr("fgenv.agents.training.recipes.RECIPES", (("swap", {}, SWAP),))
    monkeypatch.setattr(Training, "run", interrupt)
    for extra in ([], ["--json"]):
        arguments = ["train", "swap", "--n", "2", "--out", str(tmp_path), *extra]
        monkeypatch.setattr(sys, "argv", ["fgenv", *arguments])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        assert stopped.value.code == 130
        output = capsys.readouterr()
        assert "written" not in output.out
        assert "before the first steps" in output.out + output.err
    assert json.loads(output.out)["policy"] is None


@pytest.mark.parametrize("at", [100, 700, 1_500])
def test_an_interrupted_training_goes_on_where_it_was(at: int, tmp_path: Path) -> None:
    """Before its first evaluation, nothing of it was kept."""

    def interrupt(steps: int, result: Any) -> None:
        if steps >= at and result is None:
            raise KeyboardInterrupt

    config = TrainingConfig("swap", SWAP, steps=2_000, every=1_000)
    training = Training(config, tmp_path)
    with pytest.raises(KeyboardInterrupt):
        training.run(interrupt)
    assert training.steps >= at
    about = PolicyFile.load(tmp_path / "policy.npz").about
    assert about["steps"] == (training.steps if training.best is None else training.best.steps)
    again = Training(config, tmp_path, resume=True)
    assert (again.steps, again.best) == (training.steps, training.best)
    assert again.run().about["steps"] >= about["steps"]
    assert again.steps >= 2_000


def test_a_new_training_removes_the_older_one(folder: Path, tmp_path: Path) -> None:
    there = tmp_path / "there"
    shutil.copytree(folder, there)
    expected = TrainingConfig("swap", SWAP, steps=2_000, every=1_000)
    assert Training(expected, there, resume=True).steps > 0
    assert Training(expected, there).steps == 0  # interrupted before its first evaluation
    with pytest.raises(ValueError, match="which has no training"):
        Training(expected, there, resume=True)


@pytest.mark.parametrize("suffix", [".pkl", ".json"])
def test_damaged_files_beside_a_model_raise(folder: Path, tmp_path: Path, suffix: str) -> None:
    (tmp_path / "model.zip").write_bytes((folder / "model.zip").read_bytes())
    for junk in (b"junk", b"", b"[1]"):
        (tmp_path / f"model{suffix}").write_bytes(junk)
        with pytest.raises(ValueError, match=f"model{suffix} is damaged; remove it"):
            Sb3Policy(tmp_path / "model.zip", trust=True)


def test_other_robots_raise(folder: Path) -> None:
    policy = policy_of(f"mlp:{folder / 'policy.npz'}")
    assert isinstance(policy, NetworkPolicy)
    for scenario, message in (
        (Simulator("swap", n=4, observation=None), r"observes .*lidar \(36\).*expected goal \(4\)"),
        (
            Simulator("swap", n=4, body="l", observation=policy.observation),
            r"velocity \(3\).*expected .*velocity \(2\)",
        ),
    ):
        scenario.reset(seed=0)
        with pytest.raises(ValueError, match=message):
            policy.reset(View(scenario))
    for model in (Sb3Policy(folder / "model.zip"),):
        simulator = Simulator("swap", n=4)
        simulator.reset(seed=0)
        with pytest.raises(ValueError, match=r"numbers \(goal \(4\)"):
            model.reset(View(simulator))


def test_fewer_robots_are_padded(folder: Path) -> None:
    policy = NetworkPolicy.load(folder / "policy.npz")
    assert policy.observation is not None
    seen = []
    for pad in (True, False):
        seeing = replace(policy.observation, pad=pad)
        simulator = Simulator("swap", n=2, observation=seeing, autoreset=False)
        seen.append(run_episode_actions(simulator, policy))
    np.testing.assert_array_equal(seen[0], seen[1])


def run_episode_actions(simulator: Simulator, policy: Any) -> Any:
    """Return the actions of a policy in ten steps."""
    return run_episode(simulator, policy, steps=10)["actions"]
