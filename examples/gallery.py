"""Run every example and draw a picture of its result: python examples/gallery.py FOLDER"""

import os
import runpy
import sys
import tempfile
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image
from trimesh.transformations import quaternion_matrix

from fgenv.agents import run_episode
from fgenv.arrays import Floats
from fgenv.collision import BodyRecord as Body
from fgenv.collision import Shape
from fgenv.envs import Record
from fgenv.paper import figures
from fgenv.view import Camera, Floor, Picture, Solid
from fgenv.view.episodes import load_episode, record_of_plan
from fgenv.view.figures.camera import box_corners, overview
from fgenv.view.figures.episode_frames import frames_of
from fgenv.view.figures.palette import BLUE, GREEN, INK, ORANGE, STEEL, VERMILION
from fgenv.view.figures.quantize import quantize
from fgenv.view.figures.record_plots import plot_record
from fgenv.view.figures.scenario_painter import ScenarioPainter
from fgenv.view.figures.scene import outlined_picture, sharp_edges, transform

SIZE = 480, 360
Names = dict[str, Any]  # global names after an example


def ghosts(shape: Shape, poses: Sequence[Floats] | Floats, opacity: float = 0.3) -> list[Solid]:
    """Return translucent copies of a shape at several poses."""
    return [Solid(shape, pose, ORANGE, opacity) for pose in poses]


def overview_of(shapes: Sequence[tuple[Shape, Floats]], azimuth: float, elevation: float) -> Camera:
    """Return an overview of bodies."""
    corners = [transform(box_corners(*shape.bounds), pose) for shape, pose in shapes]
    return overview(np.concatenate(corners), *SIZE, azimuth, elevation)


def draw_edges(picture: Picture, shape: Shape, pose: Floats) -> None:
    """Draw the sharp edges of a body."""
    picture.segments(transform(sharp_edges(shape), pose), INK, width=0.7, opacity=0.6)


def two_meshes(names: Names) -> Image.Image:
    """The first contact of the peg with the ring, and its feature edge."""
    ring, peg, pose, touch = names["a"], names["b"], names["slide"][-1], names["touch"]
    at = names["slide"][names["hits"].argmax()]
    camera = overview_of([(ring, np.eye(4)), (peg, pose)], -0.5, 0.75)
    bodies = [Solid(ring, np.eye(4), STEEL), Solid(peg, at, ORANGE)]
    picture = Picture(camera, bodies, floor=Floor(height=-0.2, grid=0.25))
    draw_edges(picture, peg, at)
    picture.segments([touch.edge], BLUE, width=4, hidden=1.0)
    picture.points([touch.point], VERMILION, radius=5, hidden=1.0)
    return picture.image()


def three_tanks(names: Names) -> Image.Image:
    """The robot at its goal after replanning: the right half of figure 7."""
    figure = figures.start_and_goal(names["experiment"])
    width, height = figures.PANEL
    half = figure.crop((figure.width - width, 0, figure.width, height))
    return half.resize(SIZE, Image.Resampling.LANCZOS)


def own_planner(names: Names) -> Image.Image:
    """The path of the ring off the post."""
    ring, post, way = names["robot"], names["obstacle"], np.array(names["way"])
    poses = np.array([quaternion_matrix(q) for q in way[:, 3:]])
    poses[:, :3, 3] = way[:, :3]
    ends = [Solid(post, np.eye(4), STEEL), Solid(ring, poses[-1], ORANGE)]
    camera = overview_of([(post, np.eye(4)), *((ring, pose) for pose in poses)], -1.2, 0.5)
    low = min(transform(ring.vertices, pose)[:, 2].min() for pose in poses)
    floor = Floor(height=min(-0.5, low), grid=0.5)
    picture = Picture(camera, [*ends, *ghosts(ring, poses[:-1], 0.35)], floor=floor)
    picture.polyline(way[:, :3], GREEN, width=2, hidden=0.5)
    return picture.image()


def world(names: Names) -> Image.Image:
    """The first robot, the crates in its mask, its lane, and the door."""
    every: list[Body] = [names["world"].record(body) for body in names["world"].ids.tolist()]
    bodies = [body for body in every if body.pose[0, 3] < 11 and body.pose[1, 3] < 19]
    marks = {int(body): BLUE for body in names["near"]}
    marks |= {names["first"]: ORANGE, names["door"]: VERMILION}
    colors = {body.name: marks.get(body.id, STEEL) for body in bodies}
    camera = overview_of([(body.shape, body.pose) for body in bodies], -1.9, 0.8)
    picture = outlined_picture(bodies, camera, colors)
    picture.polyline([pose[:3, 3] for pose in names["lane"]], ORANGE, width=3, hidden=0.5)
    return picture.image()


def training(names: Names) -> Image.Image:
    """The reward by generation."""
    figure = Figure(figsize=(4.8, 3.6), dpi=100, layout="constrained")
    axes = figure.subplots()
    axes.plot(names["history"], color=BLUE, marker="o", ms=4)
    axes.set(xlabel="generation", ylabel="reward, mean of 64 policies")
    axes.grid(color="0.92")
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig("curve.png")
    return Image.open("curve.png")


def own_scenario(names: Names) -> Image.Image:
    """Vessels halfway past the quay, with trails."""
    return frame_at(names["record"], 0.5)


def own_reward(names: Names) -> Image.Image:
    """The crowd in the middle that the reward penalizes."""
    simulator = names["simulator"]
    painter = ScenarioPainter(simulator.built, width=SIZE[0], height=SIZE[1])
    return Image.fromarray(painter.paint(simulator.configurations[0], simulator.goals[0]))


def own_ompl_script(names: Names) -> Image.Image:
    """The path of the sofa through the door."""
    way, bodies = names["way"], names["world"]
    sofa, *walls = (bodies.record(body) for body in bodies.ids.tolist())
    robot = names["Robot"].from_mesh(sofa.shape, base="planar")
    between = [robot.interpolate(a, b, np.linspace(0.0, 1.0, 4)) for a, b in pairwise(way)]
    poses = robot.forward(np.concatenate(between), robot.root)
    camera = Camera((-4.2, -5.8, 7.2), (0.0, 0.0, 0.0), 0.6, *SIZE)
    ends = [Solid(sofa.shape, poses[k], ORANGE) for k in (0, -1)]
    solids = [*(Solid(wall.shape, wall.pose, STEEL) for wall in walls), *ends]
    floor = Floor(height=float(sofa.shape.bounds[0, 2]))
    picture = Picture(camera, [*solids, *ghosts(sofa.shape, poses[1:-1], 0.2)], floor=floor)
    picture.polyline(poses[:, :3, 3], GREEN, width=2, hidden=0.5)
    return picture.image()


def warehouse_plan(names: Names) -> Image.Image:
    """The carts on their way, with trails."""
    return frame_at(names["record"], 0.3, azimuth=-np.pi / 2, elevation=1.0)


def four_arms(names: Names) -> Image.Image:
    """The arms in the middle of their plan."""
    return frame_at(record_of_plan(names["plan"]), 0.5)


def verify_plan(names: Names) -> Image.Image:
    """The clearance of each robot of the certified plan."""
    plot_record(load_episode("plan.npz"), "clearance", "clearance.png")
    return Image.open("clearance.png").resize((600, 350), Image.Resampling.LANCZOS)


def policies(names: Names) -> Image.Image:
    """Robots that pass each other on the right."""
    simulator = names["Simulator"](names["cases"][0], autoreset=False)
    return frame_at(run_episode(simulator, names["KeepRight"]()), 0.6)


def frame_at(record: Record, share: float, **look: Any) -> Image.Image:
    """Return the frame of a record after a share of its steps."""
    step = round(share * len(record))
    (frame,) = frames_of(record, [step], *SIZE, notes=["trails"], **look)
    return Image.fromarray(frame)


PICTURES: dict[str, Callable[[Names], Image.Image]] = {
    "01_two_meshes": two_meshes,
    "02_three_tanks": three_tanks,
    "03_own_planner": own_planner,
    "04_world": world,
    "05_training": training,
    "06_own_scenario": own_scenario,
    "07_own_reward": own_reward,
    "08_own_ompl_script": own_ompl_script,
    "09_warehouse_plan": warehouse_plan,
    "10_four_arms": four_arms,
    "11_verify_plan": verify_plan,
    "12_policies": policies,
}


def main(folder: Path, only: str = "") -> None:
    """Run each example in its own temporary folder, and write its picture to `folder`."""
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    here = Path(__file__).resolve().parent
    for name, draw in PICTURES.items():
        if only in name:
            with tempfile.TemporaryDirectory() as place:
                os.chdir(place)
                picture = draw(runpy.run_path(str(here / f"{name}.py")))
                quantize(picture.convert("RGB")).save(folder / f"{name}.png", optimize=True)
                os.chdir(here)
            print(f"written: {folder / name}.png")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: python examples/gallery.py FOLDER [PART OF AN EXAMPLE'S NAME]")
    main(Path(sys.argv[1]), *sys.argv[2:])
