"""Speed-ups of fgenv in each benchmark, by row and library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fgenv.bench.common.records import OWN, Record, without_own

Ratios = dict[str, dict[str, float]]  # by row and library: how many times faster fgenv is
CERTIFIED = "certified"


def speed_ups(seconds: Mapping[str, float | None], own: str = OWN) -> dict[str, float]:
    """Return the seconds of the others over our own; libraries without a result are left out."""
    base = seconds.get(own)
    return {name: s / base for name, s in without_own(seconds, own).items() if s and base}


def of_pairs(records: Sequence[Record]) -> Ratios:
    """Return ratios of `bench pairs`, per query in one batch."""
    return {
        r["pair"]: speed_ups({name: peer["batch"]["mean"] for name, peer in r["peers"].items()})
        for r in records
    }


def of_steps(records: Sequence[Record]) -> Ratios:
    """Return ratios of `bench world`, per step of all bodies."""
    return {
        f"{r['bodies']:,} bodies, {r['triangles']} triangles": speed_ups(
            {name: peer.get("step") for name, peer in r["peers"].items()}
        )
        for r in records
    }


def of_rates(records: Sequence[Record]) -> Ratios:
    """Return ratios of `bench env`, robot-steps per CPU second."""
    return {f"{r['worlds']:,} worlds, {r['robots']} robots": dict(r["ratio"]) for r in records}


def of_problems(records: Sequence[Record]) -> Ratios:
    """Return ratios of `bench planners`, time to the first solution where all searches succeed."""
    return {
        r["problem"]: speed_ups({n: w["seconds"] for n, w in r["ways"].items()}, CERTIFIED)
        for r in records
    }


def of_training(records: Sequence[Record]) -> Ratios:
    """Return ratios of `bench train`, samples per CPU second."""
    return {
        title: speed_ups({r["name"]: 1.0 / r[key] for r in records})
        for key, title in (("gather", "gathered"), ("learn", "learned from"))
    }
