"""The README's examples work as shown."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from support.robots import urdf
from support.scene_files import box_object, model, threemf

from fgenv.bench.common.meshes import folder
from fgenv.metrics import Results

PANDA = "panda_description/urdf/panda.urdf"
README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def block(tag: str) -> str:
    """The code block that follows the comment `tag`."""
    found = re.search(rf"^<!-- {tag} -->\n```\w+\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
    assert found, f"README.md has no block '{tag}'"
    return found[1]


def test_set_up_commands_are_one_line_each() -> None:
    assert block("setup: use").count("\n") == 1
    assert block("setup: develop").count("\n") == 1


def test_tour_says_the_truth() -> None:
    names: dict[str, Any] = {}
    exec(block("tour"), names)
    hits, gaps = np.asarray(names["hits"]), np.asarray(names["gaps"])
    assert hits.shape == gaps.shape == (1000,)
    assert 0 < hits.sum() < 1000
    assert np.array_equal(hits, gaps == 0)
    assert np.isclose(names["gap"], gaps[-1])
    assert np.isclose(np.linalg.norm(np.asarray(names["normal"])), 1)
    assert names["touch"] is not None
    assert np.isclose(np.asarray(names["ranges"])[0], 0.6, atol=0.01)
    assert np.asarray(names["inside"]).tolist() == [True, False]


@pytest.mark.filterwarnings("ignore")
def test_files_are_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("part.3mf").write_bytes(threemf(model(box_object())))
    names: dict[str, Any] = {}
    exec(block("files").replace("panda.urdf", str(urdf(PANDA)), 1), names)
    assert names["part"].report.faces == 12
    written = {path.name for path in tmp_path.iterdir()}
    assert {"part.glb", "panda.obj", "copy.urdf", "copy.srdf"} <= written


def test_masks_are_as_shown() -> None:
    names: dict[str, Any] = {}
    exec(block("masks"), names)
    world, robot, truck, crates = (names[k] for k in ("world", "robot", "truck", "crates"))
    assert names["near"].tolist() == [crates[3]]
    assert names["masks"] == [0, 0, 0, 1, 0, 0, 0, 2, 2]
    assert names["hits"].tolist() == [False, True, False]
    assert names["met"] == crates[3]
    assert world.mask(robot) == 0
    assert [world.mask(crate) for crate in crates] == [0] * 7 + [2] * 2
    assert world.candidates(truck).tolist() == crates[7:]


def test_environments_are_as_shown() -> None:
    pytest.importorskip("stable_baselines3")
    names: dict[str, Any] = {}
    exec(block("environments"), names)
    assert names["picture"].shape == (360, 480, 3)
    assert set(names["observations"]) == {f"robot {i}" for i in range(1, 9)}
    assert names["many"].num_envs == 64
    assert names["rows"].num_envs == 256
    assert names["seen"].shape == (16, 32, names["simulator"].observation_size)
    assert names["step"].rewards.shape == (16, 32)
    names["simulator"].set_state(names["state"])


def test_planning_is_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(block("planning"), names)
    assert names["proof"].proved
    assert names["proof"].clearance > 0.001
    assert names["again"] == names["proof"]
    assert len(names["ways"]) == 4
    assert names["off"] < 1e-9
    assert Results.of(names["record"]).success_rate == 1
    assert 0 < names["makespan"] < 60
    assert "no path for robot 1" in names["why"]
    assert names["ready"].haveExactSolutionPath()


def test_records_are_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(block("records"), names)
    steps, robots = names["ways"].shape[:2]
    assert (steps, robots) == (len(names["record"]) + 1, 6)
    assert names["results"].success_rate > 0
    size = (tmp_path / "run.npz").stat().st_size
    assert size < 40 * steps * robots


@pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
def test_robots_are_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder("example-robot-data").parents[1]))
    Path("panda.urdf").write_text(urdf(PANDA).read_text())
    trimesh.creation.box((600, 400, 200)).export("cart.stl")
    trimesh.creation.box((30, 30, 100)).export("peg.stl")
    names: dict[str, Any] = {}
    exec(block("robots"), names)
    arm, world, found = (names[k] for k in ("arm", "world", "found"))
    assert names["cart"].dof == 3
    assert names["way"].shape == (50, arm.nq)
    assert arm.self_collisions() == ()
    assert 20 < names["hits"].sum() < 1000
    assert not found.unresolved
    assert world.parts("panda").tolist()[-1] == world.ids[-1]
    at_rest = arm.forward(arm.rest, "panda_hand")
    world.set_configuration("panda", names["q"][0])
    carried = names["hands"][0] @ np.linalg.inv(at_rest) @ names["pose"]
    np.testing.assert_allclose(world.poses("peg"), carried, atol=1e-9)


def test_scenarios_are_as_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(block("scenarios"), names)
    assert names["problems"] == []
    assert len(names["built"].robots) == len(names["world"]) == 8
    assert len(names["world"].contact_pairs()) == 0
    assert len(names["cases"]) == 100
    assert Path("swap-8.npz").stat().st_size < 100 * 170
    assert names["frozen"]("swap-8.npz", id=names["cases"].id).id == names["cases"].id


def test_motions_are_as_shown() -> None:
    names: dict[str, Any] = {}
    exec(block("motion"), names)
    hit, both = names["hit"], names["both"]
    assert not hit.free
    assert hit.other == names["door"]
    # The ball's foremost vertex meets the plate's face.
    assert hit.free_until * 2.0 == pytest.approx(1.005 - 5e-5 - 0.002, abs=2e-6)
    assert 0 < (hit.contact_by - hit.free_until) * 2.0 <= 1e-6
    assert names["steps"].free
    assert both.free.tolist() == [False, False]
    assert both.other.tolist() == [names["door"], names["bullet"]]
    assert names["later"].free


def test_pictures_are_there_and_small() -> None:
    """Exactly the committed pictures are shown, and a clone stays small."""
    shown = set(re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README))
    root = Path(__file__).parent.parent
    kept = {
        path.relative_to(root).as_posix() for path in (root / "examples").rglob("*.[pg][ni][gf]")
    }
    assert shown == kept
    sizes = {name: (root / name).stat().st_size for name in shown}
    assert max(sizes.values()) < 1_000_000
    assert max(size for name, size in sizes.items() if name.endswith(".png")) < 100_000
