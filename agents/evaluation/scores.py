"""What is told of a policy over many episodes, and how sure it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

from fgenv.agents.evaluation.episodes import Episode
from fgenv.confidence import Estimate, mean, rate
from fgenv.metrics import Results


@dataclass(frozen=True)
class Score:
    """Over all episodes, each with its 95 % interval: Wilson's of rates, a bootstrap's of means.

    An episode is a trial; robots of one are not independent, so that the interval of a share of
    robots is that of as many trials as there are episodes, rather too wide than too narrow.

    Attributes:
        success: share of episodes in which every robot came to its goal in time and met nothing.
        robot_success: share of robots that came to their goals in time and met nothing.
        robot_collision: share of robots that ran into another robot.
        body_collision: share of robots that ran into anything else: an obstacle, or themselves.
        time_out: share of robots that were not at their goals when the episode ended.
        extra_time: seconds from the start until a robot is at its goal, less those that it takes
            straight there with nothing in the way. Mean over the robots of episodes that all
            policies solve; so are the next two.
        extra_distance: meters (of a fixed base: radians) that it goes farther than straight.
        makespan: seconds until the last robot of an episode is at its goal.
        speed: meters (radians) a second of a robot until it is there, or the episode ends.
        least_clearance: meters to whatever is nearest, the least of an episode; mean over episodes.
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


NAMES = tuple(field.name for field in fields(Score))[2:]
RATES = NAMES[:5]


def score(episodes: Sequence[Episode], straight: Sequence[Results], shared: Sequence[int]) -> Score:
    """The score of a policy.

    Args:
        episodes: of the policy.
        straight: of the same cases, with nothing in the way.
        shared: places among them of those that all policies solve.
    """
    n = len(episodes)
    both = [(episodes[k], straight[k]) for k in shared]
    clearances = [episode.results.least_clearance for episode in episodes]
    return Score(
        n,
        len(both),
        rate(sum(episode.success for episode in episodes), n),
        rate(math.fsum(e.results.success_rate for e in episodes), n),
        rate(math.fsum(share(e.met_robots) for e in episodes), n),
        rate(math.fsum(share(e.met_bodies) for e in episodes), n),
        rate(math.fsum(1 - e.results.arrived / len(e.results.robots) for e in episodes), n),
        mean([x for pair in both if not math.isnan(x := extra(*pair, "arrival"))]),
        mean([x for pair in both if not math.isnan(x := extra(*pair, "path_length"))]),
        mean([e.results.makespan for e, _ in both if e.results.makespan is not None]),
        mean([speed(episode.results) for episode in episodes]),
        mean([x for x in clearances if math.isfinite(x)]),
    )


def share(counts: Sequence[int]) -> float:
    """Of those that are over 0."""
    return sum(count > 0 for count in counts) / len(counts)


def extra(episode: Episode, straight: Results, what: str) -> float:
    """How much more it took than straight, mean over robots; NaN where straight leads nowhere."""
    pairs = zip(episode.results.robots, straight.robots, strict=True)
    more = [getattr(a, what) - getattr(b, what) for a, b in pairs if b.arrival is not None]
    return math.fsum(more) / len(more) if more else math.nan


def speed(results: Results) -> float:
    """Mean over robots of the way gone by the time that it took."""
    times = [r.seconds_on_way(results.seconds) for r in results.robots]
    rates = [r.path_length / t for r, t in zip(results.robots, times, strict=True) if t > 0]
    return math.fsum(rates) / len(rates) if rates else 0.0
