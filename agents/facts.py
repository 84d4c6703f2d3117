"""The account of an experiment as plain data, for JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fgenv.agents.drive import Drive
from fgenv.agents.experiment import Experiment


def facts(experiment: Experiment, pictures: Sequence[str] = ()) -> dict[str, Any]:
    """The account as plain data for JSON: meters, radians, seconds of simulated time.

    Equal for equal arguments, but for the wall-clock times under "seconds".
    """
    scene, journey = experiment.scene, experiment.journey
    plan = journey.plans[0] if journey.plans else None
    return {
        "scenario": scene.name,
        "seed": experiment.seed,
        "as_published": experiment.as_published,
        "checks": experiment.checks,
        "problem": journey.problem,
        "start": list(scene.start),
        "goal": list(scene.goal),
        "bodies": [
            {
                "id": body.id,
                "name": body.name,
                "triangles": len(body.shape.faces),
                "watertight": body.shape.watertight,
                "size": np.ptp(body.shape.vertices, axis=0).tolist(),
                "feature_points": len(body.feature_points),
                "feature_edges": len(body.graph.edges),
            }
            for body in scene.records
        ],
        "drives": [_drive_facts(drive) for drive in journey.drives],
        "plan": plan
        and {
            "path": plan.path.tolist(),
            "back_off": plan.back_off,
            "length": plan.back_off + plan.plan.length,
            "checks": plan.plan.checks,
            "proved_free": plan.proof.proved,
            "edges": plan.proof.edges,
            "least_clearance": plan.proof.least,
        },
        "published": {
            "masks": experiment.published.masks,
            "loop_detects": experiment.published.body,
            "loop_time": experiment.published.time,
        },
        "pictures": list(pictures),
        "seconds": {"run": experiment.seconds, "plan": plan and plan.plan.seconds},
    }


def _drive_facts(drive: Drive) -> dict[str, Any]:
    hit = drive.hit
    return {
        "path": drive.masks.path.tolist(),
        "motion_boxes": drive.masks.motion_boxes.tolist(),
        "masks": {
            "before": drive.before,
            "during": drive.masks.masks,
            "after": drive.cleared.masks,
        },
        "start_time": drive.start,
        "end_time": drive.end,
        "steps": drive.steps,
        "pairs_tested": drive.tests,
        "pairs_without_masks": drive.without_masks,
        "collision": hit
        and {
            "pair": [hit.mover, hit.body],
            "time": hit.time,
            "noticed": hit.seen,
            "before": list(hit.before),
            "after": list(hit.after),
            "bracket": hit.bracket,
            "point": hit.contact.point.tolist(),
            "normal": hit.contact.normal.tolist(),
            "edge": None if hit.contact.edge is None else np.asarray(hit.contact.edge).tolist(),
            "edge_of": hit.mover if hit.contact.edge_of == "a" else hit.body,
            "face": hit.contact.face,
            "face_of": hit.body if hit.contact.edge_of == "a" else hit.mover,
        },
    }
