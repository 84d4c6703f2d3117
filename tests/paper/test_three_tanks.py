"""The published experiment against python-fcl: masks, collision, path around, figures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from support.planar import Fcl
from typer.testing import CliRunner

from fgenv.arrays import Floats
from fgenv.cli import app
from fgenv.paper.drive import Drive
from fgenv.paper.experiment import Experiment, Replan, run_experiment
from fgenv.paper.figures import draw_figures
from fgenv.paper.report import as_data
from fgenv.paper.scene import masks, model_list, robot_shape, three_tanks
from fgenv.paper.timed_path import as_path, radius_of, refine
from fgenv.planners import Problem

PUBLISHED = {"robot": 1, "tank 1": 0, "tank 2": 1, "tank 3": 1}
NONE = dict.fromkeys(PUBLISHED, 0)


@pytest.fixture(scope="module")
def reported() -> tuple[Experiment, list[Drive | Replan]]:
    results: list[Drive | Replan] = []
    return run_experiment(three_tanks(), seed=0, report=results.append), results


@pytest.fixture
def experiment(reported: tuple[Experiment, list[Drive | Replan]]) -> Experiment:
    return reported[0]


def straight(problem: Problem) -> Floats:
    return np.stack([problem.starts[0], problem.goals[0]])


def test_scene_is_as_published(experiment: Experiment) -> None:
    robot, *tanks = records = model_list(experiment.problem.world)
    for body in records:
        assert body.shape.watertight
        assert 1000 <= len(body.shape.faces) <= 3000
        assert (body.graph.kinds == "valley").any()  # concave
        assert len(body.feature_points) > 100
    assert 0.8 < np.ptp(robot.shape.vertices, axis=0).max() < 1.3
    sizes = {tuple(np.ptp(b.shape.vertices, axis=0).round(3)) for b in tanks}
    assert len(sizes) == 3


def test_masks_before_during_and_after(experiment: Experiment) -> None:
    first, again = experiment.drives
    assert first.before == again.before == NONE
    assert experiment.published is not None
    assert first.during == experiment.published.masks == PUBLISHED
    assert first.after == again.after == NONE
    assert masks(experiment.problem.world) == NONE
    assert again.during["robot"] == 1


def test_masked_pairs_are_not_tested(experiment: Experiment) -> None:
    for drive in experiment.drives:
        masked = sum(drive.during.values()) - 1
        assert 0 < drive.tests <= drive.steps * masked
        assert drive.without_masks == drive.steps * 3


def test_first_contact_agrees_with_fcl(experiment: Experiment) -> None:
    hit = experiment.drives[0].hit
    assert hit is not None
    peer, path = Fcl(experiment.problem), straight(experiment.problem)
    places = refine(path, 0.0, 0.003)
    k = next(k for k, q in enumerate(places) if peer.hits(q))
    free, touching = places[k - 1], places[k]
    while np.linalg.norm(touching - free) > 1e-8:
        middle = (free + touching) / 2
        free, touching = (free, middle) if peer.hits(middle) else (middle, touching)
    assert peer.hits(touching) == [hit.body] == ["tank 2"]
    assert hit.bracket <= 1e-4
    assert np.linalg.norm(np.subtract(hit.after, touching)) < 2e-6
    assert not peer.hits(np.array(hit.before) - (free - path[0]) * 1e-9)
    # The speed along the path is 0.5 m/s.
    assert hit.time == pytest.approx(np.linalg.norm(touching[:2] - path[0, :2]) / 0.5, abs=1e-5)


def test_contact_has_a_feature_edge_and_the_face_that_it_crosses(experiment: Experiment) -> None:
    hit, problem = experiment.drives[0].hit, experiment.problem
    assert hit is not None
    found = hit.contact
    assert found.edge is not None
    assert found.face is not None
    records = {record.name: record for record in model_list(problem.world)}
    poses = {"robot": problem.models[0].forward(hit.after, 0), "tank 2": records["tank 2"].pose}
    shapes = {name: records[name].shape for name in poses}
    owner, other = ("robot", "tank 2") if found.edge_of == "a" else ("tank 2", "robot")
    graph, pose = shapes[owner].graph, poses[owner]
    ends = (graph.points @ pose[:3, :3].T + pose[:3, 3])[graph.edges]
    gaps = np.minimum(
        np.abs(ends - found.edge).max(axis=(1, 2)), np.abs(ends - found.edge[::-1]).max(axis=(1, 2))
    )
    assert gaps.min() < 1e-9
    corners = shapes[other].vertices[shapes[other].faces[found.face]]
    corners = corners @ poses[other][:3, :3].T + poses[other][:3, 3]
    face = trimesh.Trimesh(corners, [[0, 1, 2]], process=False)
    (on_face,), (off,), _ = trimesh.proximity.closest_point_naive(face, [found.point])
    assert off < 1e-6
    start, end = found.edge
    t = np.clip((on_face - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
    assert np.linalg.norm(start + t * (end - start) - found.point) < 1e-6


def test_replanned_path_is_free_by_fcl_at_a_fine_step(experiment: Experiment) -> None:
    problem, replan = experiment.problem, experiment.replan
    assert replan is not None
    first, again = experiment.drives
    path = again.path
    np.testing.assert_allclose(path[0], first.driven[-1], atol=1e-12)
    np.testing.assert_allclose(path[-1], problem.goals[0], atol=1e-12)
    np.testing.assert_allclose(again.driven, path, atol=1e-12)
    peer = Fcl(problem)
    fine = refine(as_path(path), peer.radius, 0.002)
    assert len(fine) > 3000
    assert not any(peer.hits(q) for q in fine)
    assert replan.plan.certificate.proved
    assert 0.03 < replan.plan.certificate.clearance < 0.2
    at = problem.world.configuration(problem.robot_ids[0])
    np.testing.assert_allclose(at, problem.goals[0], atol=1e-12)


def test_results_are_reported_in_order(
    reported: tuple[Experiment, list[Drive | Replan]],
) -> None:
    experiment, results = reported
    first, again = experiment.drives
    assert results == [first, experiment.replan, again]
    assert first.hit is not None
    assert 0 == first.start < first.hit.time == first.end == again.start < again.end
    assert again.hit is None


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_seed_reproduces_the_published_results(seed: int) -> None:
    experiment = run_experiment(three_tanks(), seed=seed)
    assert experiment.as_published, experiment.checks


def test_same_seed_same_results(experiment: Experiment) -> None:
    once, twice = as_data(experiment, 0), as_data(run_experiment(three_tanks(), seed=0), 0)
    assert once.pop("seconds") != twice.pop("seconds")
    assert json.dumps(once) == json.dumps(twice)


def test_loop_method_misses_nothing_before_the_truth(experiment: Experiment) -> None:
    """The published cycle may be late or see nothing; here it has no false hit."""
    hit, published = experiment.drives[0].hit, experiment.published
    assert hit is not None
    assert published is not None
    assert published.time is None or published.time >= hit.time


# Masks -------------------------------------------------------------------------------------------


def random_path(rng: np.random.Generator) -> Floats:
    return rng.uniform((-3, -3, -7), (3, 3, 7), size=(rng.integers(2, 6), 3))


@pytest.mark.parametrize("seed", range(10))
def test_motion_boxes_contain_the_whole_body(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem, path = three_tanks(), as_path(random_path(rng))
    vertices = robot_shape(problem).vertices
    problem.world.set_path("robot", path)
    for leg, (low, high) in enumerate(problem.world.motion_boxes("robot")):
        q = refine(path[leg : leg + 2], radius_of(vertices), 0.02)
        poses = problem.models[0].forward(q, 0)
        corners = vertices @ poses[:, :3, :3].swapaxes(1, 2) + poses[:, None, :3, 3]
        assert (corners >= low).all()
        assert (corners <= high).all()


@pytest.mark.parametrize("seed", range(10))
def test_mask_never_hides_a_collision(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    problem = three_tanks()
    path = as_path(problem.starts[0] + random_path(rng) * (2, 2, 1) + (4, 3, 0))
    problem.world.set_path("robot", path)
    peer, hidden = Fcl(problem), {n for n, mask in masks(problem.world).items() if mask == 0}
    touched = {name for q in refine(path, 1.0, 0.1) for name in peer.hits(q)}
    assert not touched & hidden


def test_a_large_body_beside_the_path_reaches_into_the_box() -> None:
    """The published masks, which compare positions only, miss this body."""
    problem = three_tanks()
    pose = np.eye(4)
    pose[:2, 3] = 4.0, 6.2
    beside = problem.world.add(problem.world.record("tank 1").shape, pose, name="beside")
    assert beside in problem.world.set_path("robot", straight(problem))
    assert masks(problem.world)["beside"] == 1


def test_each_robot_has_its_own_bit() -> None:
    problem = three_tanks()
    world = problem.world
    world.add_robot(problem.models[0], (0.0, 8.0, 0.0), name="other")
    world.set_path("robot", straight(problem))
    world.set_path("other", [(0.0, 8.0, 0.0), (0.0, 0.5, 0.0)])
    expected = {"robot": 3, "tank 1": 2, "tank 2": 1, "tank 3": 1, "other": 3}
    assert masks(world) == expected
    # A robot does not test the tanks of the other robot.
    names = dict(zip(world.ids.tolist(), world.names, strict=True))
    assert "tank 1" not in [names[body] for body in world.candidates("robot").tolist()]
    assert "tank 2" not in [names[body] for body in world.candidates("other").tolist()]
    world.clear_path("robot")
    assert masks(world) == {"robot": 2, "tank 1": 2, "tank 2": 0, "tank 3": 0, "other": 2}


# The command -------------------------------------------------------------------------------------


def fgenv(*arguments: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["run", "three_tanks", *arguments])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.exit_code, done.stdout


def test_json_has_all_results_and_the_exit_code_agrees() -> None:
    code, out = fgenv("--json", "--no-pictures", "--seed", "4")
    data = json.loads(out)
    assert code == 0
    assert data["as_published"] is True
    assert data["seed"] == 4
    first, again = data["drives"]
    assert first["masks"] == {"before": NONE, "during": PUBLISHED, "after": NONE}
    assert np.array(first["motion_boxes"]).shape == (1, 2, 3)
    hit = first["collision"]
    assert hit["pair"] == ["robot", "tank 2"]
    assert hit["bracket"] <= 1e-4
    assert len(hit["point"]) == 3
    assert hit["time"] == first["end_time"] == again["start_time"]
    assert {hit["edge_of"], hit["face_of"]} == {"robot", "tank 2"}
    assert again["collision"] is None
    assert data["plan"]["proved_free"] is True
    assert data["plan"]["length"] > 5.8
    assert data["pictures"] == []


def test_report_has_all_results() -> None:
    code, out = fgenv("--no-pictures")
    assert code == 0
    for words in ("collision of robot with tank 2", "motion box", "arrived", "as published"):
        assert words in out
    assert "tank 1 0, tank 2 1, tank 3 1" in out


def test_pictures_exist_and_are_not_empty(experiment: Experiment, tmp_path: Path) -> None:
    written = list(draw_figures(experiment, tmp_path / "new" / "folder"))
    assert [path.name.split("_")[1] for path in written] == ["3", "4", "5", "7", "8"]
    for path in written:
        pixels = np.asarray(Image.open(path).convert("RGB"))
        assert pixels.shape[0] >= 480
        assert pixels.shape[1] >= 640
        assert pixels[:480].std(axis=(0, 1)).min() > 10
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 200
        assert path.stat().st_size < 100_000


def cart(folder: Path, scale: float = 1.0) -> Path:
    """A user's robot: a cone on a box that is open below, with its lowest point not at 0."""
    mesh = trimesh.creation.box((0.8, 0.5, 0.4))
    mesh.update_faces(mesh.face_normals[:, 2] > -0.5)
    hat = trimesh.creation.cone(radius=0.2, height=0.6)
    both = trimesh.util.concatenate([mesh, hat])
    both.apply_scale(scale)
    both.export(folder / "cart.stl")
    return folder / "cart.stl"


def test_own_mesh(tmp_path: Path) -> None:
    code, out = fgenv("--mesh", str(cart(tmp_path)), "--json", "--no-pictures")
    data = json.loads(out)
    assert code == 0
    assert data["bodies"][0]["size"] == pytest.approx([0.8, 0.5, 0.8], abs=1e-6)
    assert data["bodies"][0]["watertight"] is False
    low, _ = data["drives"][0]["motion_boxes"][0]
    assert low[2] == pytest.approx(0.0, abs=1e-9)  # put on the floor


def test_own_mesh_is_scaled_only_if_asked(tmp_path: Path) -> None:
    mesh = str(cart(tmp_path, scale=1000.0))
    with pytest.raises(ValueError, match=r"800 x 500 x 800 m is too long.*0\.001"):
        fgenv("--mesh", mesh, "--no-pictures")
    code, _ = fgenv("--mesh", mesh, "--scale", "0.001", "--no-pictures")
    assert code == 0


def test_own_mesh_that_collides_at_its_goal_is_an_error(tmp_path: Path) -> None:
    trimesh.creation.box((5.5, 5.5, 0.4)).export(tmp_path / "raft.obj")
    with pytest.raises(ValueError, match=r"raft\.obj.*goal of 'robot': collides with tank 3"):
        three_tanks(tmp_path / "raft.obj")


def test_exit_code_1_if_not_as_published(tmp_path: Path) -> None:
    """The motion box of a wide robot reaches tank 1."""
    trimesh.creation.box((0.2, 4.6, 0.1)).export(tmp_path / "wing.ply")
    code, out = fgenv("--mesh", str(tmp_path / "wing.ply"), "--json", "--no-pictures")
    data = json.loads(out)
    assert code == 1
    assert data["as_published"] is False
    assert data["drives"][0]["masks"]["during"]["tank 1"] == 1
    assert data["drives"][0]["masks"]["after"] == NONE


def test_collisions_are_found_whatever_the_step(tmp_path: Path) -> None:
    """A small sphere, in steps much longer than the foot of the tank that it hits."""
    trimesh.creation.icosphere(radius=0.01).export(tmp_path / "marble.ply")
    mesh, times = str(tmp_path / "marble.ply"), []
    for step in ("0.7", "0.01"):
        code, out = fgenv("--mesh", mesh, "--step", step, "--json", "--no-pictures")
        first = json.loads(out)["drives"][0]
        assert code == 0
        assert first["collision"]["pair"] == ["robot", "tank 2"]
        times.append(first["collision"]["time"])
    assert times[0] == pytest.approx(times[1], abs=1e-5)


@pytest.mark.parametrize("option", [("--step", "0"), ("--scale", "-1"), ("--mesh", "no such file")])
def test_invalid_options_are_errors(option: tuple[str, str]) -> None:
    with pytest.raises((ValueError, FileNotFoundError), match=option[0].strip("-") + "|no such"):
        fgenv(*option, "--no-pictures")


def test_three_tanks_in_python_takes_a_mesh(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="watertight"):
        problem = three_tanks(cart(tmp_path))
    assert problem.world.record("robot").bounds[0, 2] == pytest.approx(0.0, abs=1e-9)
