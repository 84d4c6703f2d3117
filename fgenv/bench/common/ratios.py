"""What each benchmark measured, as how many times fgenv is faster: row by row, peer by peer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Record = Mapping[str, Any]
Times = dict[str, dict[str, float]]
OWN = "fgenv"
CERTIFIED = "certified"


def faster(own: float | None, others: Mapping[str, float | None]) -> dict[str, float]:
    """The others' seconds over our own; those that have none are left out."""
    return {name: took / own for name, took in others.items() if took and own}


def of_pairs(records: Sequence[Record]) -> Times:
    """Of `bench pairs`: a query in one batch."""
    took = {r["pair"]: {n: p["batch"]["mean"] for n, p in r["peers"].items()} for r in records}
    return {pair: faster(t.get(OWN), without(t, OWN)) for pair, t in took.items()}


def of_steps(records: Sequence[Record]) -> Times:
    """Of `bench world`: a step of all bodies."""
    found = {}
    for r in records:
        took = {name: peer.get("step") for name, peer in r["peers"].items()}
        name = f"{r['bodies']:,} bodies, {r['triangles']} triangles"
        found[name] = faster(took.get(OWN), without(took, OWN))
    return found


def of_rates(records: Sequence[Record]) -> Times:
    """Of `bench env`: robot-steps in a CPU second."""
    return {f"{r['worlds']:,} worlds, {r['robots']} robots": dict(r["ratio"]) for r in records}


def of_problems(records: Sequence[Record]) -> Times:
    """Of `bench planners`: the time to the first solution, of searches that were all solved."""
    took = {r["problem"]: {n: w["seconds"] for n, w in r["ways"].items()} for r in records}
    return {name: faster(t.get(CERTIFIED), without(t, CERTIFIED)) for name, t in took.items()}


def of_training(records: Sequence[Record]) -> Times:
    """Of `bench train`: samples in a CPU second."""
    kinds = {"gather": "gathered", "learn": "learned from"}
    seconds = {kind: {r["name"]: 1.0 / r[kind] for r in records} for kind in kinds}
    return {
        title: faster(seconds[kind].get(OWN), without(seconds[kind], OWN))
        for kind, title in kinds.items()
    }


def without(took: Mapping[str, float | None], own: str) -> dict[str, float | None]:
    """Of the others."""
    return {name: seconds for name, seconds in took.items() if name != own}
