"""A file of another kind: each command names the kind, and the command that takes it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from support.shell import Shell

import fgenv
from fgenv.agents.policies.policy_file import ARCHIVE
from fgenv.envs import Recorder, Simulator
from fgenv.file_kind import kind_of
from fgenv.scenarios import Scenario, frozen

# Name, first words of its message, and a command that takes it.
KINDS = {
    "record.npz": ("a record", "replay"),
    "plan.npz": ("a plan", "verify"),
    "policy.npz": ("a policy", "--policy mlp:"),
    "set.npz": ("a frozen set", "eval"),
    "scenario.yaml": ("a scenario", "validate"),
    "mesh.glb": ("a mesh", "export"),
    "robot.urdf": ("a robot", "robot"),
    "picture.png": ("a picture", "viewer"),
    "pointer.bin": ("a Git LFS pointer", "git lfs pull"),
    "page.html": ("an HTML page", "raw file"),
}
# Command, and the files that it takes.
COMMANDS = {
    "verify {}": ("plan.npz",),
    "replay {}": ("record.npz", "plan.npz"),
    "render {} --png out.png": ("record.npz", "plan.npz"),
    "plot {} --kind clearance --out out.png": ("record.npz", "plan.npz"),
    "validate {}": ("scenario.yaml",),
    "scenarios {}": ("scenario.yaml", "set.npz"),
    "plan {}": ("scenario.yaml", "set.npz"),
    "run {}": ("scenario.yaml", "set.npz"),
    "eval {}": ("scenario.yaml", "set.npz"),
    "run swap --policy mlp:{}": ("policy.npz",),
    "run swap --policy plan:{}": ("plan.npz",),
    "eval swap --policy mlp:{}": ("policy.npz",),
    "mesh {}": ("mesh.glb",),
    "robot {}": ("robot.urdf",),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of each kind."""
    made = tmp_path_factory.mktemp("kinds")
    scenario = Scenario.load("swap", n=2)
    scenario.save(made / "scenario.yaml")
    fgenv.plan(scenario, time_limit=5.0).save(made / "plan.npz")
    recorder, simulator = Recorder(policy="none"), Simulator(scenario, autoreset=False)
    simulator.reset(seed=0)
    recorder.begin(simulator)
    recorder.record().save(made / "record.npz")
    ARCHIVE.save(made / "policy.npz", {"about": "{}"}, {"mean": np.zeros(2)})
    frozen("swap", cases=2).save(made / "set.npz")
    trimesh.creation.box().export(made / "mesh.glb")
    (made / "robot.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    Image.new("RGB", (4, 4)).save(made / "picture.png")
    (made / "pointer.bin").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
    (made / "page.html").write_text("\n<!DOCTYPE html><html><body>404</body></html>")
    return made


@pytest.mark.parametrize("name", KINDS)
def test_each_kind_is_recognised(folder: Path, name: str) -> None:
    kind = kind_of(folder / name)
    assert kind is not None
    assert kind.name == KINDS[name][0]


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_of_another_kind_is_named(
    shell: Shell, folder: Path, command: str, name: str
) -> None:
    if name in COMMANDS[command]:
        pytest.skip("the command takes this kind")
    shutil.copy(folder / name, name)
    code, out, err = shell(*command.format(name).split())
    received, use = KINDS[name]
    assert code in (1, 2)
    assert name in out + err
    assert f"got {received}, expected " in out + err
    assert use in (out + err).partition("got ")[2]
    assert "Traceback" not in err


@pytest.mark.parametrize("content", [b"", b"PK\3\4", b"\0" * 5000, b"text", b"<a/>", b"\xff" * 9])
def test_other_content_has_no_kind(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "file"
    file.write_bytes(content)
    assert kind_of(file) is None
    assert kind_of(tmp_path) is kind_of(tmp_path / "none") is kind_of("/dev/null") is None
