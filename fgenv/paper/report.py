"""The experiment's results: as JSON data, and printed for a reader as they are known."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from rich.console import Console
from rich.table import Table

from fgenv.paper.drive import Drive, FirstContact
from fgenv.paper.experiment import Experiment, Replan
from fgenv.paper.scene import model_list
from fgenv.planners import Problem

COLUMNS = ("at (m)", "size (m)", "triangles", "feature\npoints", "feature\nedges")


def as_data(experiment: Experiment, seed: int, pictures: Sequence[str] = ()) -> dict[str, Any]:
    """The results as plain data for JSON: meters, radians, simulated seconds.

    Equal for equal arguments, except for the wall-clock times under "seconds".
    """
    problem, published, replan = experiment.problem, experiment.published, experiment.replan
    return {
        "scenario": problem.scenario.name,
        "seed": seed,
        "as_published": experiment.as_published,
        "checks": experiment.checks,
        "problem": experiment.failure,
        "start": problem.starts[0].tolist(),
        "goal": problem.goals[0].tolist(),
        "bodies": [
            {
                "id": number,
                "name": body.name,
                "triangles": len(body.shape.faces),
                "watertight": body.shape.watertight,
                "size": np.ptp(body.shape.vertices, axis=0).tolist(),
                "feature_points": len(body.feature_points),
                "feature_edges": len(body.graph.edges),
            }
            for number, body in enumerate(model_list(problem.world))
        ],
        "drives": [_drive_data(drive) for drive in experiment.drives],
        "plan": replan and _plan_data(replan),
        "published": published
        and {
            "masks": published.masks,
            "loop_detects": published.body,
            "loop_time": published.time,
        },
        "pictures": list(pictures),
        "seconds": {"run": experiment.seconds, "plan": replan and replan.plan.seconds},
    }


def _plan_data(replan: Replan) -> dict[str, Any]:
    plan = replan.plan
    return {
        "path": replan.path.tolist(),
        "back_off": replan.back_off,
        "length": replan.back_off + plan.length,
        "checks": plan.checks,
        "proved_free": plan.certificate.proved,
        "edges": len(plan.path) - 1,
        "least_clearance": plan.certificate.clearance,
    }


def _drive_data(drive: Drive) -> dict[str, Any]:
    return {
        "path": drive.path.tolist(),
        "motion_boxes": drive.motion_boxes.tolist(),
        "masks": {"before": drive.before, "during": drive.during, "after": drive.after},
        "start_time": drive.start,
        "end_time": drive.end,
        "steps": drive.steps,
        "pairs_tested": drive.tests,
        "pairs_without_masks": drive.without_masks,
        "collision": drive.hit and _contact_data(drive.hit),
    }


def _contact_data(hit: FirstContact) -> dict[str, Any]:
    touch = hit.contact
    edge_of, face_of = _owners(hit)
    return {
        "pair": [hit.robot, hit.body],
        "time": hit.time,
        "noticed": hit.detected,
        "before": hit.before.tolist(),
        "after": hit.after.tolist(),
        "bracket": hit.bracket,
        "point": touch.point.tolist(),
        "normal": touch.normal.tolist(),
        "edge": None if touch.edge is None else touch.edge.tolist(),
        "edge_of": edge_of,
        "face": touch.face,
        "face_of": face_of,
    }


def _owners(hit: FirstContact) -> tuple[str, str]:
    """Names of the bodies that have the contact's edge and its face."""
    return (hit.robot, hit.body) if hit.contact.edge_of == "a" else (hit.body, hit.robot)


class ConsoleReport:
    """Prints a heading, each drive and plan, and the results."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.time = 0.0  # simulated seconds

    def heading(self, problem: Problem, seed: int, notes: Sequence[str] = ()) -> None:
        """Print the bodies, the notes about their meshes, the start and the goal."""
        table = Table(title=f"The published experiment: {problem.scenario.name}, seed {seed}")
        table.add_column("body")
        for name in COLUMNS:
            table.add_column(name, justify="right", no_wrap=True)
        for body in model_list(problem.world):
            table.add_row(
                body.name,
                f"{body.position[0]:.1f}, {body.position[1]:.1f}",
                " x ".join(f"{s:.2f}" for s in np.ptp(body.shape.vertices, axis=0)),
                str(len(body.shape.faces)),
                str(len(body.graph.points)),
                str(len(body.graph.edges)),
            )
        self.console.print(table)
        for note in notes:
            self.console.print(f"note: {note}", markup=False)
        start, goal = problem.starts[0][:2], problem.goals[0][:2]
        length = np.hypot(*(goal - start))
        self.console.print(f"Shortest path: {_point(start)} to {_point(goal)}, {length:.2f} m")

    def progress(self, result: Drive | Replan) -> None:
        """Print one drive or plan."""
        if isinstance(result, Drive):
            self._drive(result)
        else:
            self._replan(result)

    def _drive(self, drive: Drive) -> None:
        boxes, self.time = drive.motion_boxes, drive.start
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        count = "motion box" if len(boxes) == 1 else f"{len(boxes)} motion boxes"
        sides = (
            f"{axis} {least + 0.0:.2f} to {most:.2f}"
            for axis, least, most in zip("xyz", low.round(6), high, strict=True)
        )
        self._line(f"{count} {', '.join(sides)} m")
        self._line(f"masks      {_masks(drive.during)}")
        self.time = drive.end
        if drive.hit is not None:
            self._hit(drive.hit)
        self._line(f"masks      {_masks(drive.after)}")
        if drive.hit is None:
            self._line(f"[bold green]arrived[/] at {_pose(drive.path[-1])}")

    def _hit(self, hit: FirstContact) -> None:
        touch = hit.contact
        self._line(f"[bold red]collision of {hit.robot} with {hit.body}[/]")
        self._more(f"at {_point(touch.point)}, the robot at {_pose(hit.after)}")
        if touch.edge is None:
            self._more("one body is inside the other")
        else:
            edge_of, face_of = _owners(hit)
            self._more(f"feature edge of {edge_of}: {' to '.join(map(_point, touch.edge))}")
            self._more(f"meets face {touch.face} of {face_of}")
        self._more(f"bracketed to {hit.bracket * 1e6:.1f} µm of motion")

    def _replan(self, replan: Replan) -> None:
        plan = replan.plan
        length, edges = replan.back_off + plan.length, len(plan.path) - 1
        self._line(f"path planned anew: {len(replan.path)} points, {length:.2f} m")
        self._more(
            f"{replan.back_off:.2f} m back the way it came, then around by OMPL's RRTConnect"
        )
        self._more(f"({plan.checks} states checked in {plan.seconds:.2f} s)")
        least = plan.certificate.clearance * 1e3
        self._more(f"proved free edge by edge ({edges}), at least {least:.1f} mm")
        self._more(f"from all bodies, the nearest place about {_pose(plan.nearest)}")

    def results(self, experiment: Experiment) -> None:
        """Print the checks, the result of the published graph, and the verdict."""
        if experiment.failure:
            self.console.print(
                f"no path to the goal: {experiment.failure}", style="red", markup=False
            )
        tests = sum(drive.tests for drive in experiment.drives)
        without = sum(drive.without_masks for drive in experiment.drives)
        self.console.print(f"Pairs tested: {tests}, without masks {without}")
        self.console.print(f"The published cycle {_loop(experiment)}")
        for check, held in experiment.checks.items():
            self.console.print(f"  [{'green]yes' if held else 'red]NO '}[/]  {check}")
        verdict = "as published" if experiment.as_published else "NOT as published"
        self.console.print(f"The experiment came out {verdict} ({experiment.seconds:.2f} s)")

    def _line(self, text: str) -> None:
        self.console.print(f"[dim]{self.time:7.3f} s[/]  {text}")

    def _more(self, text: str) -> None:
        self.console.print(f"{'':11}{text}")


def _loop(experiment: Experiment) -> str:
    """The published graph's collision on the first path, compared with the first contact."""
    published, first = experiment.published, experiment.drives[0]
    if published is None or published.time is None:
        return "(loop) sees no collision"
    sees = f"(loop) sees one with {published.body} at {published.time:.3f} s"
    if first.hit is None:
        return f"{sees}, and is wrong"
    late = (published.time - first.hit.detected) * first.speed * 1e3
    return f"{sees}, {late:.0f} mm late" if late > 0 else f"{sees}, in the same step"


def _masks(masks: Mapping[str, int]) -> str:
    return ", ".join(f"{name} [bold]{mask}[/]" for name, mask in masks.items())


def _point(point: ArrayLike) -> str:
    return "(" + ", ".join(f"{v:.3f}" for v in np.asarray(point).tolist()) + ")"


def _pose(q: ArrayLike) -> str:
    x, y, yaw = np.asarray(q).tolist()
    return f"({x:.3f}, {y:.3f}, {np.rad2deg(yaw):.1f}°)"
