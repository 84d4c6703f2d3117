"""Pickles of models: code in them runs only for files that the user trusts."""

from __future__ import annotations

import json
import os
import pickle
import stat
import zipfile
from pathlib import Path
from typing import Any

import pytest
from support.shell import Shell

from fgenv import trust
from fgenv.envs import policy_of
from fgenv.trust import TrustError


class Attack:
    """Writes a file once it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.path,)


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "fgenv" / "trusted"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model of Stable-Baselines3 whose normalization runs code."""
    path = tmp_path / "model.zip"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("data", json.dumps({"clip_range": {}}))
    path.with_suffix(".pkl").write_bytes(pickle.dumps(Attack(tmp_path / "attacked")))
    return path


@pytest.mark.parametrize("prefix", ["sb3:", "safe:sb3:"])
def test_a_foreign_model_is_refused_with_reason_and_remedy(
    model: Path, state: Path, prefix: str
) -> None:
    with pytest.raises(TrustError, match=r"holds a pickle, .* use --trust \(trust=True"):
        policy_of(f"{prefix}{model}")
    assert not model.with_name("attacked").exists()
    assert not state.exists()


def test_the_normalization_beside_a_trusted_model_is_checked_too(model: Path, state: Path) -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3 import PPO

    with trust.written(model) as partial:
        PPO("MlpPolicy", "Pendulum-v1", n_steps=8, batch_size=8).save(partial)
    with pytest.raises(TrustError, match=r"model\.pkl holds a pickle"):
        policy_of(f"sb3:{model}")
    assert not model.with_name("attacked").exists()
    policy_of(f"sb3:{model}", trust=True)
    assert model.with_name("attacked").exists()
    model.with_suffix(".pkl").unlink()
    policy_of(f"sb3:{model}")
    content = bytearray(model.read_bytes())
    content[-1:] = b"\x01\x00A"  # a comment: another content
    model.write_bytes(content)
    with pytest.raises((TrustError, ValueError)):
        policy_of(f"sb3:{model}")


def test_the_list_is_private_and_bounded(
    tmp_path: Path, state: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trust, "MAX_HASHES", 3)
    for k in range(5):
        trust.remember(str(k).encode())
    assert len(state.read_text().split()) == 3
    assert stat.S_IMODE(state.parent.stat().st_mode) == 0o700
    trust.check(tmp_path, b"4")
    with pytest.raises(TrustError):
        trust.check(tmp_path, b"0")
    with trust.trusting(), trust.trusting(False):
        trust.check(tmp_path, b"0")
    with pytest.raises(TrustError):
        trust.check(tmp_path, b"0")


def test_only_regular_files_are_read(tmp_path: Path, state: Path) -> None:
    os.mkfifo(tmp_path / "model.zip")
    with pytest.raises(ValueError, match="expected a regular file"):
        policy_of(f"sb3:{tmp_path / 'model.zip'}", trust=True)


def test_the_commands_need_the_option(model: Path, state: Path, shell: Shell) -> None:
    for line in (
        f"run swap --policy sb3:{model}",
        f"eval swap --cases 1 --policy sb3:{model}",
        f"view swap --policy sb3:{model}",
    ):
        assert "--trust" in shell.refuses(*line.split()), line
    assert "--trust: expected with" in shell.refuses(
        *["run", "swap", "--policy", "goto", "--trust"]
    )
    assert not model.with_name("attacked").exists()
