"""Every example is short, has its picture in the README, and draws its own result."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("matplotlib")
ROOT = Path(__file__).parent.parent
NAMES = sorted(path.stem for path in (ROOT / "examples").glob("[0-9]*.py"))
GALLERY = runpy.run_path(str(ROOT / "examples" / "gallery.py"))


def test_examples_are_numbered_short_and_shown() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [int(name[:2]) for name in NAMES] == list(range(1, len(NAMES) + 1))
    assert list(GALLERY["PICTURES"]) == NAMES
    for name in NAMES:
        lines = (ROOT / "examples" / f"{name}.py").read_text(encoding="utf-8").count("\n")
        assert lines < 60, name
        assert re.search(rf"!\[{name}\]\(examples/pictures/gallery/{name}\.png\)", readme)
        assert f"[{name}](examples/{name}.py)" in readme
        assert (ROOT / f"examples/pictures/gallery/{name}.png").stat().st_size < 60_000


@pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
@pytest.mark.parametrize("name", ["01_two_meshes", "07_own_reward", "08_own_ompl_script"])
def test_pictures_committed_are_those_drawn(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    GALLERY["main"](tmp_path, name)
    (drawn,) = tmp_path.glob("*.png")
    kept = ROOT / "examples" / "pictures" / "gallery" / drawn.name
    a, b = (np.asarray(Image.open(p).convert("RGB")).astype(int) for p in (drawn, kept))
    assert a.shape == b.shape
    assert (np.abs(a - b).max(axis=2) > 8).mean() < 0.01
