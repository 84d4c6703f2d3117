"""Evaluation: intervals against known values, scores of hand-made results, the command."""

from __future__ import annotations

import csv
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binomtest

from fgenv import cli
from fgenv.agents import GoToPolicy, evaluate
from fgenv.agents.evaluation.case_runner import CaseResult, run_cases, run_unobstructed
from fgenv.agents.evaluation.evaluation import Evaluation, run_batches
from fgenv.agents.evaluation.scores import score
from fgenv.confidence import mean, rate
from fgenv.envs import Simulator, policy_of
from fgenv.metrics import Results, RobotResult
from fgenv.scenarios import FrozenSet, frozen


@pytest.fixture(scope="module")
def crossing() -> FrozenSet:
    """Five cases of two robots with jittered starts."""
    return frozen("swap", n=2, jitter=0.5, cases=5, seed=1_000_000)


@pytest.mark.parametrize(("k", "n"), [(0, 10), (3, 10), (10, 10), (81, 263), (500, 500), (1, 1)])
def test_wilson_interval_equals_scipy(k: int, n: int) -> None:
    found, expected = rate(k, n), binomtest(k, n).proportion_ci(method="wilson")
    np.testing.assert_allclose(found, (k / n, expected.low, expected.high), atol=1e-12)


def test_wilson_interval_equals_published_values() -> None:
    """R. Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I."""
    for k, n, low, high in [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (1, 29, 0.0061, 0.1718),
    ]:
        np.testing.assert_allclose(rate(k, n)[1:], (low, high), atol=5e-5)


def test_no_trials_give_nan() -> None:
    assert all(math.isnan(x) for x in (*rate(0, 0), *mean([])))
    with pytest.raises(ValueError, match="successes: got 4, expected 0 to 3"):
        rate(4, 3)


def test_bootstrap_is_near_the_normal_interval_and_repeatable() -> None:
    values = np.random.default_rng(0).normal(5.0, 2.0, 400)
    half = 1.96 * values.std() / 20
    found = mean(values.tolist())
    np.testing.assert_allclose(found, (values.mean(), found[0] - half, found[0] + half), atol=0.03)
    assert found == mean(values.tolist())
    assert mean([2.5]) == (2.5, 2.5, 2.5)


def robot(
    arrival: float | None, hits: int = 0, length: float = 4.0, gap: float = 0.2
) -> RobotResult:
    """Return a hand-made result of a robot."""
    return RobotResult("r", arrival, hits, length, "m", gap)


def episode(case: int, *robots: RobotResult, met: Any = ((0, 0), (0, 0))) -> CaseResult:
    """Return a hand-made result of an episode of 10 s."""
    return CaseResult(case, Results(robots, 100, 10.0), *met)


def test_scores_of_hand_made_episodes() -> None:
    episodes = [
        episode(0, robot(5.0, length=5.0), robot(7.0, length=6.0, gap=0.1)),
        episode(1, robot(4.0), robot(8.0, hits=2), met=((0, 1), (0, 1))),
        episode(2, robot(None, length=1.0), robot(4.0), met=((0, 0), (0, 0))),
        episode(3, robot(4.0), robot(4.0, hits=3), met=((0, 0), (0, 3))),
    ]
    ways = [Results((robot(4.0), robot(4.0)), 40, 4.0)] * 4
    found = score(episodes, ways, shared=[0])
    assert (found.episodes, found.shared) == (4, 1)
    assert found.success == rate(1, 4)
    assert found.robot_success == rate(5 / 2, 4)
    assert found.robot_collision == rate(0.5, 4)
    assert found.body_collision == rate(1.0, 4)
    assert found.time_out == rate(0.5, 4)
    assert found.extra_time.value == pytest.approx((1.0 + 3.0) / 2)
    assert found.extra_distance.value == pytest.approx((1.0 + 2.0) / 2)
    assert found.makespan == (7.0, 7.0, 7.0)
    speeds = [(1.0 + 6 / 7) / 2, (1.0 + 0.5) / 2, (0.1 + 1.0) / 2, 1.0]
    assert found.speed.value == pytest.approx(np.mean(speeds))
    assert found.least_clearance.value == pytest.approx((0.1 + 0.2 + 0.2 + 0.2) / 4)


def test_times_without_shared_cases_are_nan() -> None:
    found = score([episode(0, robot(None))], [Results((robot(4.0),), 40, 4.0)], shared=[])
    assert math.isnan(found.extra_time.value)
    assert found.time_out.value == 1.0


def test_world_k_runs_case_k_like_a_single_simulator(crossing: FrozenSet) -> None:
    found = run_cases(crossing, policy_of("orca"), [3, 0, 4])
    assert [e.case for e in found] == [3, 0, 4]
    for e in found:
        simulator = Simulator(crossing[e.case], clearance=True, autoreset=False)
        from fgenv.agents import run_episode

        run_episode(simulator, policy_of("orca"))
        assert Results.of(simulator) == e.results


def test_self_collisions_are_body_collisions() -> None:
    arms = frozen("cell", n=1, cases=1)  # one arm, which collides with itself at random
    (found,) = run_cases(arms, policy_of("random"), [0], clearance=False, max_steps=150)
    assert found.robot_collisions == (0,)
    simulator = Simulator(arms[0], autoreset=False)
    from fgenv.agents import run_episode

    record = run_episode(simulator, policy_of("random"), steps=150)
    assert (record["hit_robots"] == 0).any(), "it has met itself"
    assert found.body_collisions == ((record["hits"] >= 0).sum(),)


def test_unobstructed_baseline_is_goto_without_obstacles(crossing: FrozenSet) -> None:
    for k, found in enumerate(run_unobstructed(crossing, range(5))):
        for i, one in enumerate(found.robots):
            spec = crossing[k].robots[i]
            only = crossing[k].model_copy(update={"robots": (spec,)})
            simulator = Simulator(only, autoreset=False)
            from fgenv.agents import run_episode

            run_episode(simulator, GoToPolicy())
            alone = Results.of(simulator).robots[0]
            assert (one.arrival, one.path_length) == (alone.arrival, alone.path_length)


@pytest.mark.slow
def test_same_results_for_any_number_of_jobs(crossing: FrozenSet) -> None:
    one = evaluate(crossing, ["random", "goto"], seed=3)
    two = evaluate(crossing, ["random", "goto"], seed=3, jobs=2)
    assert repr(one.scores) == repr(two.scores)  # NaN is not equal to itself
    assert one.results == two.results


def test_partial_results_after_an_interruption(crossing: FrozenSet) -> None:
    result = Evaluation(crossing, ("goto", "orca"))
    work = run_batches(result, 0, 1)
    result.add(*next(work))
    result.add(*next(work))
    assert (result.done, result.scores) == ([], {})
    result.add(*next(work))
    assert result.done == list(range(5))


class Shell:
    """Run `fgenv eval` in this process."""

    def __init__(self, patch: pytest.MonkeyPatch, capture: pytest.CaptureFixture[str]) -> None:
        self.patch, self.capture = patch, capture
        patch.delenv("FGENV_DEBUG", raising=False)
        patch.setenv("COLUMNS", "120")

    def __call__(self, *arguments: object) -> tuple[int, str, str]:
        """Return exit code, stdout, stderr."""
        self.patch.setattr(sys, "argv", ["fgenv", "eval", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        code = stopped.value.code
        return (0 if code is None else int(code)), *self.capture.readouterr()


@pytest.fixture
def fgenv(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Shell:
    return Shell(monkeypatch, capsys)


SWAP = ("swap", "--n", 2, "--set", "jitter=0.5", "--cases", 5)


def test_the_command_prints_and_writes(fgenv: Shell, tmp_path: Path) -> None:
    rows, plot = tmp_path / "rows.csv", tmp_path / "plot.png"
    code, out, _ = fgenv(
        *SWAP, "--policy", "goto", "--policy", "orca", "--csv", rows, "--plot", plot
    )
    assert code == 0
    assert "swap, 2 robots, 60 s, 5 cases from seed 1000000, id " in out
    assert "5 of 5 cases" in out
    assert plot.stat().st_size > 1000
    table = list(csv.DictReader(rows.open()))
    assert len(table) == 2 * 5 * 2
    assert {row["policy"] for row in table} == {"goto", "orca"}
    assert all(float(row["straight_arrival_s"]) > 1 for row in table)


def test_json_is_repeatable(fgenv: Shell) -> None:
    found = []
    for _ in range(2):
        code, out, _ = fgenv(*SWAP, "--policy", "orca", "--json")
        assert code == 0
        document = json.loads(out)
        del document["wall_seconds"]
        found.append(document)
    assert found[0] == found[1]
    assert found[0]["policies"]["orca"]["success"][0] == 1.0
    assert found[0]["done"] == 5


def test_a_set_from_a_file(fgenv: Shell, crossing: FrozenSet, tmp_path: Path) -> None:
    crossing.save(tmp_path / "set.npz")
    code, out, _ = fgenv(tmp_path / "set.npz", "--json")
    assert code == 0
    assert json.loads(out)["id"] == crossing.id
    code, _, message = fgenv(tmp_path / "set.npz", "--cases", 3)
    assert (code, "--cases: a set that is a file has its own" in message) == (2, True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--policy", "gotoo"), "did you mean 'goto'?"),
        (("--policy", "mlp:nothing.npz"), "nothing.npz: No such file"),
        (("--csv", "no/such/folder.csv"), "there is no folder no/such"),
        (
            ("--plot", "scores.xyz"),
            "--plot: got scores.xyz, expected a name that ends in .png, .svg",
        ),
    ],
)
def test_errors_precede_the_cases(
    fgenv: Shell, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], message: str
) -> None:
    monkeypatch.setattr("fgenv.scenarios.frozen_set", lambda *_, **__: pytest.fail("made cases"))
    code, _, said = fgenv(*SWAP, *arguments)
    assert code == 2
    assert message in said
