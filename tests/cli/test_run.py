"""``fgenv run`` with a policy: reports, files and errors."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.GifImagePlugin import GifImageFile
from support.episodes import alone
from support.shell import Shell

from fgenv.agents import GoToPolicy, run_episode
from fgenv.cli import errors
from fgenv.envs import Record, Simulator, policy_of, replay
from fgenv.metrics import Results
from fgenv.registry import POLICIES
from fgenv.scenarios import frozen
from fgenv.view.figures.episode_frames import frames_of, steps_shown
from fgenv.view.figures.movie import frame_seconds, write_movie

# Reports


def test_each_robot_has_a_row(shell: Shell) -> None:
    code, out, err = shell(
        "run", "swap", "--policy", "goto", "--n", 2, "--set", "on_collision=pass"
    )
    assert (code, err) == (0, "")
    for text in (
        "robot 1",
        "robot 2",
        "success",
        "arrived (s)",
        "steps in contact",
        "contact events",
        "least clearance",
    ):
        assert text in out
    assert "over after 4.0 s, 40 steps" in out
    assert "success 0 of 2" in out
    assert "makespan 4.0 s" in out


def test_json_equals_the_results_of_the_simulator(shell: Shell) -> None:
    data = shell.json("run", "intersection", "--n", 1, "--seed", 3)
    simulator = Simulator("intersection", n=1, seed=3, autoreset=False, clearance=True)
    run_episode(simulator, GoToPolicy(), seed=3)
    facts = Results.of(simulator).facts
    assert {key: data[key] for key in facts} == facts
    assert (data["policy"], data["seed"], data["ended"]) == ("goto", 3, "terminated")
    assert data["success_rate"] == 1.0


def test_same_arguments_same_result(shell: Shell) -> None:
    runs = [shell.json("run", "random", "--policy", "random", "--steps", 20) for _ in range(2)]
    other = shell.json("run", "random", "--policy", "random", "--steps", 20, "--seed", 1)
    for data in (*runs, other):
        del data["wall_seconds"]
    assert runs[0] == runs[1]
    assert runs[0]["robots"] != other["robots"]


def test_a_failed_episode_is_reported(shell: Shell) -> None:
    data = shell.json("run", "corridor", "--n", 2, "--set", "horizon=3.0")
    assert (data["ended"], data["steps"], data["makespan"]) == ("truncated", 30, None)


def test_three_tanks_is_a_scenario_too(shell: Shell) -> None:
    data = shell.json("run", "three_tanks", "--policy", "rest", "--steps", 5)
    assert (data["policy"], data["steps"], data["ended"]) == ("rest", 5, "stopped")


def test_files_and_frozen_sets_are_run(shell: Shell, tmp_path: Path) -> None:
    alone("holonomic", 4).save(tmp_path / "s.yaml")
    assert shell.json("run", tmp_path / "s.yaml")["success_rate"] == 1.0
    several = frozen("swap", n=3, cases=5)
    several.save(tmp_path / "s.npz")
    data = shell.json(
        "run", tmp_path / "s.npz", "--seed", 2, "--steps", 4, "--record", tmp_path / "r.npz"
    )
    assert data["seed"] == 2
    starts = Record.load(tmp_path / "r.npz")["configurations"][0]
    turns = 2 * np.pi * np.array([0.0, 0.0, 1.0])  # a yaw is reported in [-pi, pi]
    cases = [np.array([robot.start for robot in case.robots]) for case in several]
    off = [np.abs(starts - case).reshape(-1, 3) for case in cases]
    assert any(np.allclose(np.minimum(o, abs(o - turns)), 0.0) for o in off)


# Files


def test_record_and_movie_are_of_the_run(shell: Shell, tmp_path: Path) -> None:
    files = tmp_path / "r.npz", tmp_path / "m.gif"
    data = shell.json(
        "run", "cell", "--steps", 3, "--record", files[0], "--movie", files[1], "--fps", 5
    )
    assert data["written"] == [str(file) for file in files]
    record = Record.load(files[0])
    assert (len(record), record.policy) == (3, "goto")
    facts = json.loads(json.dumps(Results.of(replay(record)).facts))
    assert data["robots"] == facts["robots"]
    with Image.open(files[1]) as movie:
        assert isinstance(movie, GifImageFile)
        assert (movie.size, movie.n_frames) == ((480, 360), 3)  # at 0, 0.2 and 0.3 s


def test_an_interrupted_episode_is_reported_and_recorded(
    shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Tired(GoToPolicy):
        def act(self, observations: np.ndarray) -> np.ndarray:
            if self.view.steps[0] == 7:
                raise KeyboardInterrupt
            return super().act(observations)

    monkeypatch.setitem(POLICIES, "tired", lambda argument, seed: Tired())
    files = tmp_path / "r.npz", tmp_path / "m.gif"
    code, out, _ = shell(
        "run", "swap", "--policy", "tired", "--record", files[0], "--movie", files[1]
    )
    assert code == errors.INTERRUPTED
    assert "stopped before its end after 0.7 s, 7 steps" in out
    assert len(Record.load(files[0])) == 7
    assert not files[1].exists()


# Errors


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("swop", "'swop' is no built-in scenario; did you mean 'swap'?"),
        ("none.yaml", "none.yaml: No such file or directory"),
        ("none.npz", "none.npz: No such file or directory"),
        ("swap --policy gotoo", "policy: got 'gotoo', which is unknown; did you mean 'goto'?"),
        ("swap --set jiter=0.1", "jiter: is no known override; did you mean 'jitter'?"),
        ("swap --set jitter", "--set: got 'jitter', expected KEY=VALUE"),
        ("swap --set horizon=-1", "horizon: is -1, should be greater than 0"),
        ("swap --n 1000", "n: is 1000, should be less than or equal to 64"),
        ("swap --n 0", "--n"),
        ("swap --seed -1", "--seed"),
        ("swap --steps 0", "--steps"),
        ("swap --record r.json", "--record: got r.json, expected a name that ends in .npz"),
        ("swap --record none/r.npz", "none/r.npz: there is no folder none"),
        ("swap --movie m.avi", "movie: got m.avi, expected a name that ends in .gif or .mp4"),
        ("swap --movie none/m.gif", "none/m.gif: there is no folder none"),
        ("swap --movie m.gif --fps 0", "--fps"),
        ("swap --fps 5", "--fps: is of a movie, expected with --movie"),
        ("swap --mesh a.stl", "--mesh: is of fgenv run three_tanks, without --policy"),
        ("three_tanks --policy goto --step 0.1", "--step: is of fgenv run three_tanks"),
        ("three_tanks --record r.npz", "--record: expected with --policy"),
        ("three_tanks --policy goto --n 2", "n: is no known override"),
    ],
)
def test_bad_input_is_2_and_one_line(
    shell: Shell, arguments: str, message: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, err = shell("run", *arguments.split())
    assert (code, out, err.count("\n")) == (errors.BAD_INPUT, "", 1)
    assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.full((1, 2, 2), np.nan), "actions[0, 0, 0]: got nan, expected a number in [-1, 1]"),
        (
            np.zeros((1, 3, 2)),
            "actions: got shape (1, 3, 2), expected (1, 2, 2)",
        ),
        (None, "actions: got dtype object, expected float64"),
    ],
)
def test_invalid_actions_of_a_policy_are_errors(
    shell: Shell, bad: Any, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Bad(GoToPolicy):
        def act(self, observations: np.ndarray) -> Any:
            return bad

    monkeypatch.setitem(POLICIES, "bad", lambda argument, seed: Bad())
    code, out, err = shell("run", "swap", "--n", 2, "--policy", "bad")
    assert (code, out, err.count("\n")) == (errors.BAD_INPUT, "", 1)
    assert message in err


def test_a_missing_encoder_is_reported_before_the_run(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    code, out, err = shell("run", "swap", "--movie", tmp_path / "m.mp4")
    assert (code, out) == (errors.BAD_INPUT, "")
    assert "remedy: pip install 'fgenv[view]', or use a name that ends in .gif" in err


# Movies


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("swap", n=2, on_collision="pass", at_goal="vanish", autoreset=False)
    return run_episode(simulator, policy_of("goto"))


def test_frames_are_in_real_time_and_include_the_end(record: Record) -> None:
    for seconds in (0.01, 0.1, 0.25, 0.4, 3.0, 100.0):
        shown = steps_shown(record, seconds)
        assert shown[0] == 0
        assert shown[-1] == len(record)
        gaps = np.diff(shown) * record.dt
        assert (gaps > 0).all()
        assert gaps.max() <= max(seconds, record.dt) + record.dt / 2 + 1e-9


def test_vanished_robots_are_not_drawn(record: Record) -> None:
    first, again, last = frames_of(record, [0, 0, len(record)], 64, 48)
    assert first.shape == (48, 64, 3)
    assert first.dtype == np.uint8
    np.testing.assert_array_equal(first, again)
    assert (record["status"][-1] == 2).all()
    spread = [np.ptp(frame.astype(int), axis=2).max() for frame in (first, last)]
    assert spread[0] > 1.5 * spread[1]  # only the faint goals remain


def moving(n: int, width: int = 64, height: int = 48) -> list[np.ndarray]:
    """Frames with a red square that moves."""
    frames = np.full((n, height, width, 3), 230, dtype=np.uint8)
    for k, frame in enumerate(frames):
        frame[10:20, 3 * k : 3 * k + 10] = (200, 30, 30)
    return list(frames)


def test_a_gif_shows_the_frames_for_their_time(tmp_path: Path) -> None:
    path, frames = tmp_path / "m.gif", moving(8)
    assert write_movie(path, iter(frames), fps=8) == 8
    with Image.open(path) as movie:
        assert isinstance(movie, GifImageFile)
        assert (movie.n_frames, movie.info["duration"], movie.info["loop"]) == (8, 120, 0)
        for k, frame in enumerate(frames):
            movie.seek(k)
            shown = np.asarray(movie.convert("RGB")).astype(int)
            assert np.abs(shown - frame).max() <= 4


def test_an_mp4_shows_the_frames(tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    path, frames = tmp_path / "m.mp4", moving(10)
    assert write_movie(path, iter(frames), fps=10) == 10
    reader = ffmpeg.read_frames(str(path))
    about = next(reader)
    assert (about["size"], about["fps"], about["codec"]) == ((64, 48), 10.0, "h264")
    shown = [np.frombuffer(frame, np.uint8).reshape(48, 64, 3).astype(int) for frame in reader]
    assert len(shown) == 10
    for a, b in zip(shown, frames, strict=True):
        assert np.abs(a - b).mean() < 6


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_a_failed_movie_keeps_the_old_file(tmp_path: Path, suffix: str) -> None:
    if suffix == ".mp4":
        pytest.importorskip("imageio_ffmpeg")
    path = tmp_path / f"m{suffix}"
    path.write_text("before")
    cases: tuple[tuple[list[Any], str], ...] = (
        ([], "frames: got none"),
        (
            [*moving(2), *moving(1, 32)],
            r"frame: got uint8 \(48, 32, 3\), expected uint8 \(48, 64, 3\)",
        ),
        ([np.zeros((48, 64, 3))], "frame: got float64"),
    )
    for frames, message in cases:
        with pytest.raises(ValueError, match=message):
            write_movie(path, iter(frames))
        assert path.read_text() == "before"
        assert list(tmp_path.iterdir()) == [path]


def test_wrong_frame_rates_and_sizes_are_errors(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="fps: got 0, expected"):
        frame_seconds("m.gif", 0)
    assert frame_seconds("m.gif", 30) == 0.03
    assert frame_seconds("m.gif", 500) == 0.02
    pytest.importorskip("imageio_ffmpeg")
    with pytest.raises(ValueError, match="63 x 48 pixels, expected even numbers for MP4"):
        write_movie(tmp_path / "m.mp4", iter(moving(2, 63)))
