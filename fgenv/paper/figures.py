"""The pictures of the published experiment: the paper's figures 3, 4, 5, 7 and 8."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from fgenv.arrays import Floats
from fgenv.collision import FeatureGraph
from fgenv.collision.world import BodyRecord
from fgenv.paper.drive import FirstContact
from fgenv.paper.experiment import Experiment
from fgenv.paper.scene import model_list, robot_shape
from fgenv.paper.timed_path import TimedPath
from fgenv.planners import Problem
from fgenv.robots.primitives import box
from fgenv.saving import atomic
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.layout import beside, captioned
from fgenv.view.figures.palette import (
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    STEEL,
    VERMILION,
    Color,
)
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.quantize import quantize
from fgenv.view.figures.scene import close_up, outlined_picture, portrait, sharp_edges, transform
from fgenv.view.figures.surfaces import Solid

LIFT = 0.01  # meters that lines on the floor are above it
PANEL = (640, 480)


def draw_figures(experiment: Experiment, folder: str | Path) -> Iterator[Path]:
    """Draw the five pictures into the folder (made if missing); yields each as it is written."""
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    for name, figure in FIGURES.items():
        with atomic(target / name) as partial:
            quantize(figure(experiment)).save(partial, optimize=True)
        yield target / name


def feature_points(experiment: Experiment) -> Image.Image:
    """Figure 3: the published feature points on the robot and on tank 2."""
    panels, counts = [], []
    robot, _, tank, _ = model_list(experiment.problem.world)
    for body in (robot, tank):
        graph = _graph(body, "loop")
        picture = _alone(body)
        picture.points(transform(graph.points, body.pose), VERMILION, radius=2.2)
        panels.append(picture.image())
        counts.append(f"{len(graph.points)} of {len(body.shape.vertices)} on {body.name}")
    text = "End points of the edges that bend more than 30 degrees: " + ", ".join(counts)
    return captioned(beside(panels), "Figure 3. Feature points", text)


def feature_graph(experiment: Experiment) -> Image.Image:
    """Figure 4: the robot's graph as published, and the lossless one that decides here."""
    body = model_list(experiment.problem.world)[0]
    cycle, exact = _graph(body, "loop"), _graph(body, "exact")
    left, right = _alone(body, ghost=True), _alone(body)
    left.segments(_edges(cycle, body), VERMILION, width=0.8, hidden=0.6)
    edges = _edges(exact, body)
    for kind, color in (("ridge", BLUE), ("valley", VERMILION), ("border", GREEN)):
        right.segments(edges[exact.kinds == kind], color, width=1.1)
    text = (
        f"(a) as published: one cycle of {len(cycle.edges)} chords.  (b) exact: "
        f"{len(exact.edges)} edges that are not flat, ridges blue, valleys orange"
    )
    return captioned(beside([left.image(), right.image()]), "Figure 4. Feature graph", text)


def motion_box(experiment: Experiment) -> Image.Image:
    """Figure 5: the straight path, its motion box, and the masks that it sets."""
    problem, drive = experiment.problem, experiment.drives[0]
    low, high = drive.motion_boxes[0]  # the path has one leg
    ghosts = _ghosts(problem, drive.path, 8)
    hull, center = box(high - low), np.eye(4)
    center[:3, 3] = (low + high) / 2
    haze = Solid(hull, center, PURPLE, opacity=0.13)
    bodies = _bodies(experiment, problem.starts[0])
    colors = {b.name: SKY if drive.during[b.name] else STEEL for b in bodies} | {"robot": ORANGE}
    picture = outlined_picture(bodies, _overview(1000, 640), colors, extra=[*ghosts, haze])
    picture.segments(transform(sharp_edges(hull), center), PURPLE, width=2, hidden=0.3)
    picture.polyline(_on_floor(drive.path), GREEN, width=2.5, hidden=0.4)
    for body in bodies:
        picture.label(_above(body), f"{body.name}: mask {drive.during[body.name]}", size=17)
    text = (
        "The robot stays in the box all along the straight path; bodies that reach into the box "
        "are tested (mask 1), all others are not (mask 0)"
    )
    return captioned(picture.image(), "Figure 5. Motion box and masks", text)


def start_and_goal(experiment: Experiment) -> Image.Image:
    """Figure 7: (a) before the motion, (b) after it, with the driven path."""
    problem, drives = experiment.problem, experiment.drives
    straight = np.stack([problem.starts[0], problem.goals[0]])
    passed = drives[-1].driven if len(drives) > 1 else None
    panels = [
        _panel(experiment, straight[0], [straight]),
        _panel(experiment, _end(experiment), [drive.driven for drive in drives], passed),
    ]
    end = "(b) goal" if drives[0].hit is None else "(b) where the motion ended"
    if len(drives) > 1:
        end = "(b) goal, reached by the path planned anew (green)"
    text = f"(a) start, with the shortest path.  {end}"
    return captioned(beside([panel.image() for panel in panels]), "Figure 7. The scene", text)


def collision(experiment: Experiment) -> Image.Image:
    """Figure 8: the moment of the collision, with a close-up of its feature edge and face."""
    hit = experiment.drives[0].hit
    if hit is None:
        picture = outlined_picture(_bodies(experiment, _end(experiment)), _overview(*PANEL), {})
        return captioned(picture.image(), "Figure 8. Collision", "There was no collision")
    colors = {hit.robot: ORANGE, hit.body: VERMILION}
    wide = _panel(experiment, hit.after, [experiment.drives[0].driven], colors=colors)
    wide.points([hit.contact.point], INK, radius=4, hidden=1.0)
    near = _near(_bodies(experiment, hit.after), hit, colors)
    x, y, z = hit.contact.point
    text = (
        f"{hit.robot} and {hit.body} meet {hit.time:.2f} s after the start at "
        f"({x:.3f}, {y:.3f}, {z:.3f}) m: a feature edge (blue) crosses a face (black)"
    )
    return captioned(beside([wide.image(), near.image()]), "Figure 8. Collision", text)


def _panel(
    experiment: Experiment,
    at: Floats,
    paths: Sequence[Floats],
    passed: Floats | None = None,
    colors: dict[str, Color] | None = None,
) -> Picture:
    """The scene with the robot at a configuration (3,), paths on the floor, and names.

    The robot is shown at six places of the path `passed` too.
    """
    bodies = _bodies(experiment, at)
    ghosts = [] if passed is None else _ghosts(experiment.problem, passed, 6)
    picture = outlined_picture(bodies, _overview(*PANEL), colors or {"robot": ORANGE}, extra=ghosts)
    for path, color in zip(paths, (BLUE, GREEN), strict=False):
        picture.polyline(_on_floor(path), color, width=2, hidden=0.4)
    for body in bodies:
        picture.label(_above(body), body.name, size=15)
    return picture


def _near(bodies: list[BodyRecord], hit: FirstContact, colors: dict[str, Color]) -> Picture:
    solids = [Solid(b.shape, b.pose, STEEL) for b in bodies]
    point, pair = np.asarray(hit.contact.point), {b.name: b for b in bodies}
    camera = close_up(point, np.asarray(hit.contact.normal), solids, 1.1, *PANEL)
    picture = outlined_picture(bodies, camera, colors, grid=0.25)
    if hit.contact.face is not None:
        body = pair[hit.body if hit.contact.edge_of == "a" else hit.robot]
        face = transform(body.shape.vertices[body.shape.faces[hit.contact.face]], body.pose)
        picture.polyline(face[[0, 1, 2, 0]], INK, width=2, hidden=0.5)
    if hit.contact.edge is not None:
        picture.segments([hit.contact.edge], BLUE, width=3, hidden=0.5)
    picture.points([point], INK, radius=4, hidden=1.0)
    return picture


def _alone(body: BodyRecord, ghost: bool = False) -> Picture:
    camera = portrait(body, *PANEL)
    size = float(np.ptp(body.bounds, axis=0).max())
    grid = float(10.0 ** np.floor(np.log10(size)) / 4)
    if not ghost:
        return outlined_picture([body], camera, {body.name: STEEL}, grid=grid)
    solid = Solid(body.shape, body.pose, STEEL, opacity=0.35)
    return outlined_picture([], camera, {}, extra=[solid], grid=grid)


def _graph(body: BodyRecord, method: str) -> FeatureGraph:
    return FeatureGraph(body.shape.vertices, body.shape.faces, method=method)


def _edges(graph: FeatureGraph, body: BodyRecord) -> Floats:
    return transform(graph.points[graph.edges], body.pose)


def _end(experiment: Experiment) -> Floats:
    """The robot's last configuration, (3,)."""
    return np.asarray(experiment.drives[-1].driven[-1])


def _bodies(experiment: Experiment, at: Floats) -> list[BodyRecord]:
    """All bodies, the robot first, at a configuration (3,)."""
    robot, *tanks = model_list(experiment.problem.world)
    return [replace(robot, pose=experiment.problem.models[0].forward(at, 0)), *tanks]


def _overview(width: int, height: int) -> Camera:
    return Camera((-2.0, -7.6, 6.6), (4.0, 3.1, 0.2), 0.6, width, height)


def _ghosts(problem: Problem, path: Floats, count: int) -> list[Solid]:
    """The robot, translucent, at `count` places along a path."""
    timed = TimedPath(path, speed=1.0, radius=0.0)
    q = timed.at(np.linspace(0, timed.duration, count + 1)[1:])
    shape, poses = robot_shape(problem), problem.models[0].forward(q, 0)
    return [Solid(shape, pose, ORANGE, opacity=0.3) for pose in poses]


def _on_floor(path: Floats) -> Floats:
    return np.column_stack([path[:, :2], np.full(len(path), LIFT)])


def _above(body: BodyRecord) -> Floats:
    low, high = body.bounds
    middle = (low + high) / 2
    return np.array([middle[0], middle[1], high[2] + 0.3])


FIGURES: dict[str, Callable[[Experiment], Image.Image]] = {
    "figure_3_feature_points.png": feature_points,
    "figure_4_feature_graph.png": feature_graph,
    "figure_5_motion_box.png": motion_box,
    "figure_7_start_and_goal.png": start_and_goal,
    "figure_8_collision.png": collision,
}
