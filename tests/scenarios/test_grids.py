"""Maps of ROS and of MovingAI as walls of merged boxes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from PIL import Image
from typer.testing import CliRunner

from fgenv.cli import app
from fgenv.scenarios import Scenario, ScenarioError, validate
from fgenv.scenarios.shapes.boxes import Boxes, boxes_of_cells

GRIDS = arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9)))
VOLUMES = arrays(np.bool_, st.tuples(*[st.integers(1, 5)] * 3))


@given(GRIDS | VOLUMES)
def test_merged_boxes_cover_exactly_the_cells(cells: NDArray[np.bool_]) -> None:
    covered = np.zeros(cells.shape, dtype=int)
    d = cells.ndim
    for box in boxes_of_cells(cells):
        covered[tuple(slice(box[k], box[k + d]) for k in range(d))] += 1
    assert (covered == cells).all()  # each once


@settings(max_examples=30)
@given(GRIDS)
def test_walls_contain_each_occupied_cell_and_no_free_one(cells: NDArray[np.bool_]) -> None:
    flat = boxes_of_cells(cells)
    if not len(flat):
        return
    rows = [(a, b, 0.0, c, d, 1.0) for a, b, c, d in flat.astype(float).tolist()]
    shape = Boxes.model_validate({"kind": "boxes", "boxes": rows}).shape()
    centers = np.argwhere(np.ones_like(cells)) + 0.5
    points = np.column_stack([centers, np.full(len(centers), 0.5)])
    assert shape.watertight
    assert (shape.contains(points) == cells.ravel()).all()


def test_a_million_cells_are_few_boxes() -> None:
    cells = np.zeros((1024, 1024), dtype=bool)
    cells[::64] = cells[:, ::64] = True
    cells[100:900, 100:120] = True
    boxes = boxes_of_cells(cells)
    assert len(boxes) < 600
    areas = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    assert areas.sum() == cells.sum()


# map_server --------------------------------------------------------------------------------------


def ros_map(folder: Path, pixels: NDArray[np.uint8], name: str = "m.pgm", **fields: Any) -> Path:
    if name:
        Image.fromarray(pixels).save(folder / name)
    data = {"image": name, "resolution": 0.5, "origin": [0, 0, 0], "negate": 0}
    data |= {"occupied_thresh": 0.65, "free_thresh": 0.25}
    data = {key: value for key, value in {**data, **fields}.items() if value is not None}
    (folder / "m.yaml").write_text(yaml.safe_dump(data))
    return folder / "m.yaml"


def blocked(scenario: Scenario, shape: tuple[int, int], edge: float) -> NDArray[np.bool_]:
    """Cells, (rows from the top, columns), whose centers are in a wall."""
    if not scenario.bodies:
        return np.zeros(shape, dtype=bool)
    built = scenario.build()
    rows, columns = np.indices(shape)
    local = np.column_stack([(columns.ravel() + 0.5) * edge,
                             (shape[0] - rows.ravel() - 0.5) * edge,
                             np.full(rows.size, 0.01)])  # fmt: skip
    return np.asarray(built.shapes[0].contains(local).reshape(shape))


def expected_states(color: NDArray[Any], mode: str, negate: int) -> NDArray[Any]:
    """As map_server computes a cell: 100 occupied, 0 free, -1 unknown."""
    result = np.full(color.shape, -1)
    for index, value in np.ndenumerate(color):
        value = 255 - value if negate else value
        occ = value / 100.0 if mode == "raw" else (255 - value) / 255.0
        if occ <= 1.0:
            result[index] = 100 if occ > 0.65 else 0 if occ < 0.25 else -1
    return result


@settings(max_examples=30)
@given(
    arrays(np.uint8, st.tuples(st.integers(1, 5), st.integers(1, 5))),
    st.sampled_from(["trinary", "scale", "raw"]),
    st.integers(0, 1),
    st.sampled_from(["occupied", "free"]),
    st.sampled_from(["m.pgm", "m.png"]),
)
def test_cells_of_a_map_are_as_map_server_reads_them(
    tmp_path_factory: pytest.TempPathFactory,
    pixels: NDArray[np.uint8],
    mode: str,
    negate: int,
    unknown: str,
    name: str,
) -> None:
    path = ros_map(tmp_path_factory.getbasetemp(), pixels, name, mode=mode, negate=negate)
    scenario = Scenario.load(path, unknown=unknown)
    states = expected_states(pixels.astype(int), mode, negate)
    walls = (states == 100) | ((states == -1) & (unknown == "occupied"))
    assert (blocked(scenario, pixels.shape, 0.5) == walls).all()


def test_a_map_is_turned_about_its_origin(tmp_path: Path) -> None:
    pixels = np.full((4, 6), 255, dtype=np.uint8)
    pixels[0, 5] = 0  # the upper right cell
    path = ros_map(tmp_path, pixels, origin=[1.0, 2.0, np.pi / 2])
    scenario = Scenario.load(path, height=2.0)
    (body,) = scenario.bodies
    center = body.pose @ [5.5 * 0.5, 3.5 * 0.5, 1.0, 1.0]
    np.testing.assert_allclose(center[:2], [1 - 1.75, 2 + 2.75], atol=1e-9)
    assert scenario.workspace is not None
    np.testing.assert_allclose(scenario.workspace.low, [1 - 2, 2], atol=1e-9)
    np.testing.assert_allclose(scenario.workspace.high, [1, 2 + 3], atol=1e-9)
    assert scenario.shapes["walls"].shape().bounds[1, 2] == 2.0


def test_transparent_and_colored_pixels(tmp_path: Path) -> None:
    pixels = np.zeros((1, 4, 4), dtype=np.uint8)
    pixels[0, 0] = 255, 255, 255, 255  # free
    pixels[0, 1] = 255, 255, 255, 0  # unknown
    pixels[0, 2] = 0, 0, 0, 255  # occupied
    pixels[0, 3] = 255, 255, 60, 255  # mean 190: 0.2549, unknown
    path = ros_map(tmp_path, pixels, "m.png")
    assert blocked(Scenario.load(path), (1, 4), 0.5).tolist() == [[False, True, True, True]]
    free = blocked(Scenario.load(path, unknown="free"), (1, 4), 0.5)
    assert free.tolist() == [[False, False, True, False]]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"resolutoin": 0.1}, "resolutoin: is no known key; did you mean 'resolution'"),
        ({"negate": None}, "negate: is missing"),
        ({"negate": 2}, "negate: is 2; expected 0 or 1"),
        ({"resolution": 0}, "resolution: is 0; expected a number over 0"),
        ({"resolution": float("nan")}, "resolution: is nan"),
        ({"origin": [0, 0]}, "origin: has 2 numbers; expected 3: x, y, yaw"),
        ({"mode": "trinry"}, "mode: is 'trinry'; did you mean 'trinary'"),
        ({"free_thresh": 0.9}, "free_thresh: is 0.9, with occupied_thresh 0.65"),
        ({"image": "none.pgm"}, "image: 'none.pgm' does not exist"),
        ({"image": "m.yaml"}, "image: 'm.yaml' is no image"),
    ],
)
def test_maps_that_are_refused(fields: Any, message: str, tmp_path: Path) -> None:
    path = ros_map(tmp_path, np.zeros((2, 2), dtype=np.uint8))
    data = yaml.safe_load(path.read_text()) | fields
    path.write_text(yaml.safe_dump({k: v for k, v in data.items() if v is not None}))
    with pytest.raises(ScenarioError, match=message) as caught:
        Scenario.load(path)
    assert caught.value.problems[0].line
    assert message.split("; ")[0] in str(validate(path)[0])


def test_a_truncated_image_is_refused(tmp_path: Path) -> None:
    path = ros_map(tmp_path, np.zeros((20, 20), dtype=np.uint8))
    data = (tmp_path / "m.pgm").read_bytes()
    (tmp_path / "m.pgm").write_bytes(data[:-5])
    with pytest.raises(ScenarioError, match=r"image: .* cannot be read"):
        Scenario.load(path)


# MovingAI ----------------------------------------------------------------------------------------

CELLS = arrays(np.int8, st.tuples(st.integers(1, 6), st.integers(1, 6)), elements=st.integers(0, 6))


def moving_ai(folder: Path, rows: list[str], **head: Any) -> Path:
    text = f"type octile\nheight {len(rows)}\nwidth {len(rows[0])}\nmap\n" + "\n".join(rows) + "\n"
    (folder / "m.map").write_text(text)
    return folder / "m.map"


@settings(max_examples=30)
@given(CELLS, st.sampled_from([0.5, 1.0, 3.0]))
def test_a_map_has_a_wall_where_a_cell_is_blocked(
    tmp_path_factory: pytest.TempPathFactory, cells: NDArray[np.int8], edge: float
) -> None:
    rows = ["".join(".GS@OTW"[k] for k in row) for row in cells]
    scenario = Scenario.load(moving_ai(tmp_path_factory.getbasetemp(), rows), cell=edge)
    assert (blocked(scenario, cells.shape, edge) == (cells > 2)).all()
    assert scenario.workspace is not None
    assert scenario.workspace.high == (cells.shape[1] * edge, cells.shape[0] * edge)


ROOM = ["......", ".@@@..", "......"]
SCEN = "version 1\n0\tm.map\t6\t3\t0\t0\t5\t2\t7.0\n1\tmaps/m.map\t6\t3\t0\t2\t5\t0\t7.0\n"


def scen(folder: Path, text: str = SCEN) -> Path:
    moving_ai(folder, ROOM)
    (folder / "m.scen").write_text(text)
    return folder / "m.scen"


def test_robots_go_from_cell_to_cell(tmp_path: Path) -> None:
    path = scen(tmp_path, SCEN.replace("maps/", ""))
    scenario = Scenario.load(path, n=2, cell=2.0)
    assert [r.start[:2] for r in scenario.robots] == [(1, 5), (1, 1)]  # the first row is the top
    assert [r.goal[:2] for r in scenario.robots] == [(11, 1), (11, 5)]
    assert scenario.problems() == ()
    scenario.save(tmp_path / "saved.yaml")
    assert validate(tmp_path / "saved.yaml") == []
    assert Scenario.load(tmp_path / "saved.yaml").at(None) == scenario.at(None)
    (second,) = Scenario.load(path, first=1).robots
    assert second.start[:2] == (0.5, 0.5)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("version 1\n", "", "line 1: has no version"),
        ("version 1", "version 2", "has version 2; expected 1"),
        ("\t0\t0\t5\t2", "\t1\t1\t5\t2", "line 2: has an end at 1, 1; expected a free cell"),
        ("\t0\t0\t5\t2", "\t6\t0\t5\t2", "line 2: has an end at 6, 0"),
        ("\t0\t0\t5\t2", "\t-1\t0\t5\t2", "line 2: got '-1'; expected a whole number"),
        ("m.map\t6\t3\t0\t0", "m.map\t12\t6\t0\t0", "scaled maps are not supported"),
        ("0\tm.map", "0\tn.map", "its map 'n.map' does not exist"),
        ("\t7.0\n1", "\n1", "line 2: has 8 values; expected 9"),
        ("\t7.0\n1", "\tfar\n1", "line 2: got 'far'; expected a number"),
    ],
)
def test_scenarios_that_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(scen(tmp_path, SCEN.replace(old, new, 1)))


def test_rows_of_several_maps_or_too_few(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="line 3: is on another map"):
        Scenario.load(scen(tmp_path), n=2)
    with pytest.raises(ScenarioError, match="has 2 rows; expected 3"):
        Scenario.load(scen(tmp_path), n=3)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("type octile", "typ octile", "line 1: got 'typ octile'; expected type"),
        ("height 3", "height 4", "has 3 rows; expected 4"),
        ("height 3", "height 3x", "line 2: got '3x'"),
        (".@@@..", ".@@@.", "line 6: has 5 cells; expected 6"),
        (".@@@..", ".@?@..", r"line 6: got '\?'; expected cells of"),
        ("width 6", "width 99999999999", "expected a whole number"),
    ],
)
def test_map_files_that_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = moving_ai(tmp_path, ROOM)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(ScenarioError, match=message):
        Scenario.load(path)


def test_the_command_shows_and_saves_what_was_read(tmp_path: Path) -> None:
    path = scen(tmp_path)
    saved = str(tmp_path / "saved.yaml")
    done = CliRunner().invoke(app, ["scenarios", str(path), "--set", "cell=2.0", "--save", saved])
    assert done.exit_code == 0, done.output
    assert "Map of 6 x 3 cells of 2 m" in done.stdout
    assert "radius=0.3" in done.stdout
    done = CliRunner().invoke(app, ["validate", str(path)])
    assert done.exit_code == 0, done.output
    (tmp_path / "m.map").unlink()
    done = CliRunner().invoke(app, ["validate", str(path)])
    assert (done.exit_code, "line 2: its map" in done.stdout) == (1, True)
    with pytest.raises(ScenarioError, match="cel: is no known override; did you mean 'cell'"):
        Scenario.load(path, cel=2.0)
