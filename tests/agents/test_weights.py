"""The included policies have exactly the scores of the benchmark."""

from __future__ import annotations

from typing import Any

import pytest

from fgenv.agents import NetworkPolicy
from fgenv.agents.evaluation.case_runner import run_cases
from fgenv.agents.weights import included
from fgenv.bench.policies.run import select_trials
from fgenv.envs import policy_of
from fgenv.scenarios import frozen

# For the first 12 cases of a set of `fgenv bench policies`: successes, and steps of the longest
KNOWN = {
    "swap 4 jittered holonomic": (12, 56),
    "swap 8 jittered holonomic": (12, 58),
    "swap 8 symmetric holonomic": (12, 57),
    "swap 12 jittered holonomic": (12, 66),
    "swap 12 symmetric holonomic": (12, 64),
    "swap 20 jittered holonomic": (12, 119),
    "swap 20 symmetric holonomic": (12, 117),
    "long 4 holonomic": (12, 48),
    "long 8 holonomic": (12, 79),
    "l 4 holonomic": (12, 50),
    "l 8 holonomic": (12, 70),
    "doorway 4 holonomic": (11, 600),
    "doorway 8 holonomic": (9, 600),
    "intersection 4 holonomic": (11, 600),
    "intersection 8 holonomic": (1, 600),
    "random 10 holonomic": (12, 398),
    "random 20 holonomic": (12, 396),
    "swap 4 jittered differential": (12, 67),
    "swap 8 jittered differential": (12, 93),
    "swap 8 symmetric differential": (12, 91),
    "swap 12 jittered differential": (12, 105),
    "swap 12 symmetric differential": (12, 105),
    "swap 20 jittered differential": (12, 152),
    "swap 20 symmetric differential": (12, 150),
    "long 4 differential": (12, 82),
    "long 8 differential": (12, 222),
    "l 4 differential": (12, 77),
    "l 8 differential": (0, 600),
    "doorway 4 differential": (9, 600),
    "doorway 8 differential": (2, 600),
    "intersection 4 differential": (5, 600),
    "intersection 8 differential": (0, 600),
    "random 10 differential": (12, 375),
    "random 20 differential": (8, 600),
    "forest 6": (5, 600),
}


@pytest.mark.parametrize("name", included())
def test_files_are_small_and_have_their_command(name: str) -> None:
    policy = policy_of(f"mlp:{name}")
    assert isinstance(policy, NetworkPolicy)
    assert policy.file.about["command"].startswith("fgenv train ")
    assert included()[name].stat().st_size < 200_000


def test_all_sets_have_scores() -> None:
    assert {trial.name for trial in select_trials("shipped")} == set(KNOWN)


def marked(name: str) -> Any:
    """20 robots among clutter take half a minute."""
    return pytest.param(name, marks=[pytest.mark.slow] if name.startswith("random 20") else [])


@pytest.mark.parametrize("name", [marked(name) for name in KNOWN])
def test_scores_are_unchanged(name: str) -> None:
    (trial,) = (trial for trial in select_trials("shipped") if trial.name == name)
    cases = frozen(trial.scenario, cases=12, **trial.overrides)
    found = run_cases(cases, policy_of(f"mlp:{trial.policy}"), range(12), clearance=False)
    steps = max(episode.results.steps for episode in found)
    assert (sum(episode.success for episode in found), steps) == KNOWN[name]
