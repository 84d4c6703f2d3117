"""``fgenv bench pairs``: fgenv against its peers on pairs of real meshes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from time import perf_counter

import numpy as np

from fgenv.bench.common.poses import NEAR, USUAL
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import race
from fgenv.bench.pairs.catalog import select_pairs
from fgenv.bench.pairs.race import PairRace
from fgenv.bench.peers import peer
from fgenv.collision import collide

REFERENCE = "python-fcl"
LARGE_BATCH = 20_000  # poses, of the comparison of threads


def bench_pairs(
    *,
    which: str = "all",
    peers: Sequence[str],
    poses: int = 4000,
    seed: int = 0,
    near: bool = False,
    threads: bool = True,
) -> Iterator[Record]:
    """Yield one record per pair, times in seconds.

    Args:
        which: all, quick or part of a name.
        peers: names of libraries.
        poses: number of poses per pair.
        seed: of the poses.
        near: only poses within a tenth of the size from contact, down to a ten-millionth.
        threads: also compare two threads with one.
    """
    racing = [peer(name) for name in peers]
    for index, pair in enumerate(select_pairs(which)):
        rng = np.random.default_rng([seed, index])
        pair_race = PairRace(pair, racing, poses, rng, NEAR if near else USUAL)
        record = pair_race.run()
        if "fgenv" in peers and threads:
            record["threads_2"] = _two_threads(pair_race)
        if "fgenv" in peers:
            record["ratio"] = ratios(record)
        yield record


def ratios(record: Record, reference: str = REFERENCE) -> dict[str, float]:
    """Return the speed-ups of fgenv; `build` is its share of the reference's time."""
    own, other = record["peers"]["fgenv"], record["peers"].get(reference)
    if other is None:
        return {}
    ratio = {kind: other["batch"][kind] / own["batch"][kind] for kind in own["batch"]}
    # Single calls from NumPy poses, each in a Python loop.
    ratio["call"] = other["call"]["mean"] / own["call"]["mean"]
    ratio["p99"] = other["call"]["p99"] / own["call"]["p99"]
    ratio["build"] = own["build"] / other["build"]
    if "distance" in own and "distance" in other:
        ratio["distance"] = other["distance"] / own["distance"]
    return ratio


def _two_threads(pair_race: PairRace) -> float:
    """Return the speed-up of two threads over one on a large batch."""
    a, b = pair_race.models["fgenv"]
    poses = np.tile(pair_race.poses, (-(-LARGE_BATCH // len(pair_race.poses)), 1, 1))
    jobs = {
        str(n): (lambda batch, n=n: collide(a, pair_race.pose_a, b, batch, threads=n))
        for n in (1, 2)
    }
    seconds = race(jobs, poses, rounds=5, budget=30.0, chunk=LARGE_BATCH, clock=perf_counter)
    return seconds["1"] / seconds["2"]
