"""Policies that come along do what is told of them, to the digit."""

from __future__ import annotations

import pytest

from fgenv.agents import Trained, policy_of
from fgenv.agents.episodes import run_cases
from fgenv.agents.named import shipped
from fgenv.scenarios import frozen

# Of the first 12 cases of a frozen set of jittered swap: successes, and steps of the longest
KNOWN = {4: (12, 49), 6: (12, 52), 8: (12, 61)}


@pytest.mark.parametrize("name", shipped())
def test_files_are_small_and_tell_where_they_come_from(name: str) -> None:
    policy = policy_of(f"mlp:{name}")
    assert isinstance(policy, Trained)
    assert policy.file.about["command"].startswith(f"fgenv train {name}")
    assert shipped()[name].stat().st_size < 200_000


@pytest.mark.parametrize("n", KNOWN)
def test_swap_scores_as_told(n: int) -> None:
    cases = frozen("swap", n=n, jitter=0.2, cases=12)
    found = run_cases(cases, policy_of("mlp:swap"), range(12), clearance=False)
    steps = max(episode.results.steps for episode in found)
    assert (sum(episode.success for episode in found), steps) == KNOWN[n]
