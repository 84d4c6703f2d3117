"""The account of an experiment for a reader, printed as it happens."""

from collections.abc import Mapping, Sequence
from functools import singledispatchmethod

import numpy as np
from rich.console import Console
from rich.table import Table

from fgenv.agents import Arrived, Experiment, Hit, MasksCleared, MasksSet, Replanned
from fgenv.agents.events import Event
from fgenv.scenarios import Scene

COUNTS = ("tests", "without_masks")


class Account:
    """Prints a heading, each event, and the outcome."""

    def __init__(self, console: Console) -> None:
        self.console = console

    def begin(self, scene: Scene, seed: int, notes: Sequence[str] = ()) -> None:
        """The bodies, start and goal, and what there is to say of the meshes."""
        table = Table(title=f"The published experiment: {scene.name}, seed {seed}")
        table.add_column("body")
        for name in ("at (m)", "size (m)", "triangles", "feature\npoints", "feature\nedges"):
            table.add_column(name, justify="right", no_wrap=True)
        for body in scene.records:
            graph = body.graph
            table.add_row(
                body.name,
                f"{body.position[0]:.1f}, {body.position[1]:.1f}",
                " x ".join(f"{s:.2f}" for s in np.ptp(body.shape.vertices, axis=0)),
                str(len(body.shape.faces)),
                str(len(graph.points)),
                str(len(graph.edges)),
            )
        self.console.print(table)
        for note in notes:
            self.console.print(f"note: {note}", markup=False)
        length = np.hypot(*np.subtract(scene.goal[:2], scene.start[:2]))
        self.console.print(
            f"Shortest path: {_point(scene.start[:2])} to {_point(scene.goal[:2])}, {length:.2f} m"
        )

    @singledispatchmethod
    def tell(self, event: Event) -> None:
        """One event, as it happens."""
        raise TypeError(f"event: got {type(event).__name__}, which has no words")

    @tell.register
    def _(self, event: MasksSet) -> None:
        boxes = event.motion_boxes
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        what = "motion box" if len(boxes) == 1 else f"{len(boxes)} motion boxes"
        sides = (
            f"{axis} {least + 0.0:.2f} to {most:.2f}"
            for axis, least, most in zip("xyz", low.round(6), high, strict=True)
        )
        self._line(event.time, f"{what} {', '.join(sides)} m")
        self._line(event.time, f"masks      {_masks(event.masks)}")

    @tell.register
    def _(self, event: Hit) -> None:
        found = event.contact
        self._line(event.time, f"[bold red]collision of {event.mover} with {event.body}[/]")
        self._more(f"at {_point(found.point)}, the robot at {_pose(event.after)}")
        if found.edge is None:
            self._more("one body is inside the other")
        else:
            owner, other = event.mover, event.body
            if found.edge_of == "b":
                owner, other = other, owner
            ends = " to ".join(_point(end) for end in found.edge)
            self._more(f"feature edge of {owner}: {ends}")
            self._more(f"meets face {found.face} of {other}")
        self._more(f"bracketed to {event.bracket * 1e6:.1f} µm of motion")

    @tell.register
    def _(self, event: MasksCleared) -> None:
        self._line(event.time, f"masks      {_masks(event.masks)}")

    @tell.register
    def _(self, event: Replanned) -> None:
        plan, proof = event.plan, event.proof
        length = event.back_off + plan.length
        self._line(event.time, f"path planned anew: {len(event.path)} points, {length:.2f} m")
        self._more(f"{event.back_off:.2f} m back the way it came, then around by OMPL's RRTConnect")
        self._more(f"({plan.checks} states checked in {plan.seconds:.2f} s)")
        self._more(f"proved free edge by edge ({proof.edges}), at least {proof.least * 1e3:.1f} mm")
        self._more(f"from all bodies, the nearest place about {_pose(proof.where)}")

    @tell.register
    def _(self, event: Arrived) -> None:
        self._line(event.time, f"[bold green]arrived[/] at {_pose(event.configuration)}")

    def end(self, experiment: Experiment) -> None:
        """What came out as published, what the published graph says, and the verdict."""
        journey = experiment.journey
        if journey.problem:
            self.console.print(f"no way to the goal: {journey.problem}", style="red", markup=False)
        tests, without = (sum(getattr(d, k) for d in journey.drives) for k in COUNTS)
        self.console.print(f"Pairs tested: {tests}, without masks {without}")
        self.console.print(f"The published cycle {_loop(experiment)}")
        for check, held in experiment.checks.items():
            self.console.print(f"  [{'green]yes' if held else 'red]NO '}[/]  {check}")
        verdict = "as published" if experiment.as_published else "NOT as published"
        self.console.print(f"The experiment came out {verdict} ({experiment.seconds:.2f} s)")

    def _line(self, time: float, text: str) -> None:
        self.console.print(f"[dim]{time:7.3f} s[/]  {text}")

    def _more(self, text: str) -> None:
        self.console.print(f"{'':11}{text}")


def _loop(experiment: Experiment) -> str:
    """What the published graph sees on the first path, against the truth."""
    said, first = experiment.published, experiment.journey.drives[0]
    if said.time is None:
        return "(loop) sees no collision"
    sees = f"(loop) sees one with {said.body} at {said.time:.3f} s"
    if first.hit is None:
        return f"{sees}, and is wrong"
    late = (said.time - first.hit.seen) * first.speed * 1e3
    return f"{sees}, {late:.0f} mm late" if late > 0 else f"{sees}, in the same step"


def _masks(masks: Mapping[str, int]) -> str:
    return ", ".join(f"{name} [bold]{mask}[/]" for name, mask in masks.items())


def _point(point: object) -> str:
    return "(" + ", ".join(f"{v:.3f}" for v in np.asarray(point).tolist()) + ")"


def _pose(q: tuple[float, float, float]) -> str:
    return f"({q[0]:.3f}, {q[1]:.3f}, {np.rad2deg(q[2]):.1f}°)"
