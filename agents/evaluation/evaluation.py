"""Evaluation of policies on one frozen set, compared on the cases that all policies solve."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from fgenv.agents.evaluation.case_runner import CaseResult, run_cases, run_unobstructed
from fgenv.agents.evaluation.scores import Score, score
from fgenv.envs import policy_of
from fgenv.metrics import Results
from fgenv.scenarios import FrozenSet

BATCH = 25  # cases that are run at once
UNOBSTRUCTED = ""  # name of the baseline in place of a policy's
Batch = list[tuple[int, Any]]  # results by case


@dataclass
class Evaluation:
    """Results of policies on the cases of a set; partial if interrupted.

    Attributes:
        unobstructed: results without obstacles, by case.
        results: of each policy, by case.
    """

    cases: FrozenSet
    policies: tuple[str, ...]
    unobstructed: dict[int, Results] = field(default_factory=dict)
    results: dict[str, dict[int, CaseResult]] = field(default_factory=dict)

    @property
    def done(self) -> list[int]:
        """Cases with results of all policies."""
        rows: list[dict[int, Any]] = [self.results.get(name, {}) for name in self.policies]
        rows.append(self.unobstructed)
        return sorted(set.intersection(*(set(row) for row in rows)))

    @property
    def shared(self) -> list[int]:
        """Cases that all policies solve."""
        return [c for c in self.done if all(self.results[p][c].success for p in self.policies)]

    @property
    def scores(self) -> dict[str, Score]:
        """Score of each policy over the cases that are done."""
        done, shared = self.done, self.shared
        indices, baseline = [done.index(c) for c in shared], [self.unobstructed[c] for c in done]
        rows = {name: [self.results[name][c] for c in done] for name in self.policies if done}
        return {name: score(results, baseline, indices) for name, results in rows.items()}

    def add(self, policy: str, batch: Batch) -> None:
        """Add results of a batch."""
        baseline = policy == UNOBSTRUCTED
        target: Any = self.unobstructed if baseline else self.results.setdefault(policy, {})
        target.update(batch)


def evaluate(
    cases: FrozenSet,
    policies: Sequence[str],
    *,
    seed: int = 0,
    jobs: int = 1,
    clearance: bool = True,
    trust: bool = False,
    progress: Callable[[Evaluation], object] | None = None,
) -> Evaluation:
    """Run policies on all cases.

    The result does not depend on the number of jobs: each batch of 25 cases has new policies.

    Args:
        policies: names, see `policy_of`.
        seed: of random numbers in policies.
        jobs: number of processes; 1: threads on all cores.
        clearance: measure clearances, which takes longer.
        trust: see `policy_of`.
        progress: called with the evaluation so far, which remains valid after an interruption.

    Raises:
        ValueError: a policy is unknown, or does not fit the scenario.
    """
    evaluation = Evaluation(cases, tuple(dict.fromkeys(policies)))
    for policy, batch in run_batches(evaluation, seed, jobs, clearance, trust):
        evaluation.add(policy, batch)
        if progress is not None:
            progress(evaluation)
    return evaluation


def run_batches(
    evaluation: Evaluation, seed: int, jobs: int, clearance: bool = True, trust: bool = False
) -> Iterator[tuple[str, Batch]]:
    """Run all batches; yield policies and results in an order independent of the jobs."""
    cases, n = evaluation.cases, len(evaluation.cases)
    parts = [range(first, min(first + BATCH, n)) for first in range(0, n, BATCH)]
    work = [(policy, part) for part in parts for policy in (UNOBSTRUCTED, *evaluation.policies)]
    if jobs == 1:
        for policy, part in work:
            yield policy, run_batch(cases, policy, part, seed, None, clearance, trust)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        try:
            futures = [
                pool.submit(run_batch, cases, *item, seed, 1, clearance, trust) for item in work
            ]
            for (policy, _), future in zip(work, futures, strict=True):
                yield policy, future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def run_batch(
    cases: FrozenSet,
    policy: str,
    indices: Sequence[int],
    seed: int,
    threads: int | None,
    clearance: bool,
    trust: bool,
) -> Batch:
    """Run a policy, or the unobstructed baseline, on some cases."""
    if policy == UNOBSTRUCTED:
        return list(zip(indices, run_unobstructed(cases, indices, threads=threads), strict=True))
    new = policy_of(policy, seed, trust=trust)
    results = run_cases(cases, new, indices, clearance=clearance, threads=threads)
    return [(result.case, result) for result in results]
