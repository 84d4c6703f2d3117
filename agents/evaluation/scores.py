"""Scores of policies over many episodes, with confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

from fgenv.agents.evaluation.case_runner import CaseResult
from fgenv.confidence import Estimate, mean, rate
from fgenv.metrics import Results


@dataclass(frozen=True)
class Score:
    """Statistics over all episodes with 95 % intervals: Wilson's of rates, a bootstrap's of means.

    An episode is one trial: since robots of an episode are not independent, the interval of a share
    of robots uses the number of episodes, which is conservative.

    Attributes:
        success: share of episodes in which every robot reached its goal in time, without collision.
        robot_success: share of robots that reached their goals in time, without collision.
        robot_collision: share of robots that collided with another robot.
        body_collision: share of robots that collided with an obstacle or themselves.
        time_out: share of robots that were not at their goals when the episode ended.
        extra_time: arrival time minus that of the unobstructed baseline, s. Mean over the robots of
            episodes that all policies solve, like the next two.
        extra_distance: distance minus that of the baseline, m (of a fixed base: rad).
        makespan: time until the last robot of an episode is at its goal, s.
        speed: mean speed of a robot until its arrival or the end of the episode, m/s (rad/s).
        least_clearance: least distance to another body in an episode, m; mean over episodes.
    """

    episodes: int
    shared: int  # episodes that all policies solve
    success: Estimate
    robot_success: Estimate
    robot_collision: Estimate
    body_collision: Estimate
    time_out: Estimate
    extra_time: Estimate
    extra_distance: Estimate
    makespan: Estimate
    speed: Estimate
    least_clearance: Estimate


NAMES = tuple(column.name for column in fields(Score))[2:]
RATES = NAMES[:5]


def score(
    episodes: Sequence[CaseResult], baseline: Sequence[Results], shared: Sequence[int]
) -> Score:
    """Return the score of a policy.

    Args:
        episodes: of the policy.
        baseline: unobstructed results of the same cases.
        shared: indices of the episodes that all policies solve.
    """
    n = len(episodes)
    pairs = [(episodes[k], baseline[k]) for k in shared]
    clearances = [episode.results.least_clearance for episode in episodes]
    return Score(
        n,
        len(pairs),
        rate(sum(episode.success for episode in episodes), n),
        rate(math.fsum(e.results.success_rate for e in episodes), n),
        rate(math.fsum(positive_share(e.robot_collisions) for e in episodes), n),
        rate(math.fsum(positive_share(e.body_collisions) for e in episodes), n),
        rate(math.fsum(1 - e.results.arrived / len(e.results.robots) for e in episodes), n),
        mean([x for pair in pairs if not math.isnan(x := mean_excess(*pair, "arrival"))]),
        mean([x for pair in pairs if not math.isnan(x := mean_excess(*pair, "path_length"))]),
        mean([e.results.makespan for e, _ in pairs if e.results.makespan is not None]),
        mean([mean_speed(episode.results) for episode in episodes]),
        mean([x for x in clearances if x is not None]),
    )


def positive_share(counts: Sequence[int]) -> float:
    """Return the share of positive counts."""
    return sum(count > 0 for count in counts) / len(counts)


def mean_excess(episode: CaseResult, baseline: Results, attribute: str) -> float:
    """Return the mean difference to the baseline over robots that arrive in it; NaN if none do."""
    pairs = zip(episode.results.robots, baseline.robots, strict=True)
    excess = [
        getattr(a, attribute) - getattr(b, attribute) for a, b in pairs if b.arrival is not None
    ]
    return math.fsum(excess) / len(excess) if excess else math.nan


def mean_speed(results: Results) -> float:
    """Return the mean over robots of distance per time until arrival, m/s (rad/s)."""
    times = [r.seconds_on_way(results.seconds) for r in results.robots]
    rates = [r.path_length / t for r, t in zip(results.robots, times, strict=True) if t > 0]
    return math.fsum(rates) / len(rates) if rates else 0.0
