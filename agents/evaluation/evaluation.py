"""Evaluation: policies on one frozen set, compared where all of them succeed."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from fgenv.agents.evaluation.episodes import Episode, run_cases, straight
from fgenv.agents.evaluation.scores import Score, score
from fgenv.envs import policy_of
from fgenv.metrics import Results
from fgenv.scenarios import FrozenSet

WORLDS = 25  # cases that are run at once
STRAIGHT = ""  # in place of a policy: nothing in the way


@dataclass
class Evaluation:
    """What is known of policies on the cases of a set; parts of it after an interruption.

    Attributes:
        straight: by case, how it goes with nothing in the way.
        episodes: of each policy, by case.
    """

    cases: FrozenSet
    policies: tuple[str, ...]
    straight: dict[int, Results] = field(default_factory=dict)
    episodes: dict[str, dict[int, Episode]] = field(default_factory=dict)

    @property
    def done(self) -> list[int]:
        """Cases that all policies have run."""
        rows: list[dict[int, Any]] = [self.episodes.get(name, {}) for name in self.policies]
        rows.append(self.straight)
        return sorted(set.intersection(*(set(row) for row in rows)))

    @property
    def shared(self) -> list[int]:
        """Cases that all policies solve."""
        return [c for c in self.done if all(self.episodes[p][c].success for p in self.policies)]

    @property
    def scores(self) -> dict[str, Score]:
        """Of each policy, over the cases that are done."""
        done, shared = self.done, self.shared
        places, ways = [done.index(c) for c in shared], [self.straight[c] for c in done]
        rows = {name: [self.episodes[name][c] for c in done] for name in self.policies if done}
        return {name: score(episodes, ways, places) for name, episodes in rows.items()}

    def add(self, policy: str, found: Sequence[tuple[int, Any]]) -> None:
        """What a unit of work has found."""
        into: Any = self.straight if policy == STRAIGHT else self.episodes.setdefault(policy, {})
        into.update(found)


def evaluate(
    cases: FrozenSet,
    policies: Sequence[str],
    *,
    seed: int = 0,
    jobs: int = 1,
    clearance: bool = True,
    progress: Callable[[Evaluation], object] | None = None,
) -> Evaluation:
    """Run policies through all cases.

    The same for any number of jobs: policies are made anew for every 25 cases.

    Args:
        policies: names, see `policy_of`.
        seed: of what is random in a policy.
        jobs: processes; one: all cores by threads.
        clearance: measure the least one, which takes longer.
        progress: called with what there is, now and then; keep it for when you interrupt.

    Raises:
        ValueError: a policy is not known, or does not fit the scenario.
    """
    result = Evaluation(cases, tuple(dict.fromkeys(policies)))
    for policy, found in units(result, seed, jobs, clearance):
        result.add(policy, found)
        if progress is not None:
            progress(result)
    return result


def units(
    result: Evaluation, seed: int, jobs: int, clearance: bool = True
) -> Iterator[tuple[str, list[tuple[int, Any]]]]:
    """Parts of the work, in one order, whoever does them."""
    n = len(result.cases)
    parts = [range(first, min(first + WORLDS, n)) for first in range(0, n, WORLDS)]
    expected = [(policy, part) for part in parts for policy in (STRAIGHT, *result.policies)]
    if jobs == 1:
        for policy, part in expected:
            yield policy, unit(result.cases, policy, part, seed, None, clearance)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        try:
            made = [pool.submit(unit, result.cases, *work, seed, 1, clearance) for work in expected]
            for (policy, _), future in zip(expected, made, strict=True):
                yield policy, future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def unit(
    cases: FrozenSet,
    policy: str,
    which: Sequence[int],
    seed: int,
    threads: int | None,
    clearance: bool,
) -> list[tuple[int, Any]]:
    """A policy's episodes of some cases."""
    if policy == STRAIGHT:
        return list(zip(which, straight(cases, which, threads=threads), strict=True))
    found = run_cases(cases, policy_of(policy, seed), which, clearance=clearance, threads=threads)
    return [(episode.case, episode) for episode in found]
