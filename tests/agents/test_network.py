"""The native network against NumPy and PyTorch, and between instruction sets."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from support import TESTS

from fgenv import _core

ACTS: dict[str, Any] = {"tanh": np.tanh, "relu": lambda x: np.maximum(x, 0.0), "none": lambda x: x}
DIGEST = "from test_network import digest; print(digest())"


def layers(*sizes: int, activation: str = "tanh", seed: int = 0) -> list[tuple[Any, Any, str]]:
    """Return random layers; the last has no activation."""
    rng = np.random.default_rng(seed)
    shapes = list(itertools.pairwise(sizes))
    kinds = [activation] * (len(shapes) - 1) + ["none"]
    return [
        (rng.normal(size=(n, m)) / np.sqrt(n), rng.normal(size=m), kind)
        for (n, m), kind in zip(shapes, kinds, strict=True)
    ]


def digest(threads: int | None = None) -> str:
    """Return a hash of the outputs for a thousand rows."""
    import hashlib

    rows = np.random.default_rng(1).normal(size=(1000, 37))
    found = [_core.Network(layers(37, 65, 33, 3, activation=k)).run(rows, threads) for k in ACTS]
    return hashlib.sha256(np.array(found).tobytes()).hexdigest()


@pytest.mark.parametrize("activation", ACTS)
@pytest.mark.parametrize("sizes", [(1, 1), (40, 64, 64, 2), (3, 7, 1), (5, 2)])
def test_outputs_equal_numpy(activation: str, sizes: tuple[int, ...]) -> None:
    given = layers(*sizes, activation=activation)
    rows = np.random.default_rng(1).normal(size=(4, 50, sizes[0]))
    expected = rows
    for weights, offsets, kind in given:
        expected = ACTS[kind](expected @ weights + offsets)
    network = _core.Network(given)
    np.testing.assert_allclose(network.run(rows, None), expected, rtol=0, atol=1e-12)
    assert (network.inputs, network.outputs) == (sizes[0], sizes[-1])


def test_outputs_equal_torch() -> None:
    torch = pytest.importorskip("torch")
    given = layers(40, 64, 64, 2)
    parts: list[Any] = []
    for weights, offsets, kind in given:
        linear = torch.nn.Linear(*weights.shape, dtype=torch.float64)
        linear.weight.data = torch.as_tensor(weights.T.copy())
        linear.bias.data = torch.as_tensor(offsets)
        parts += [linear, *([torch.nn.Tanh()] if kind == "tanh" else [])]
    rows = np.random.default_rng(2).normal(size=(300, 40))
    with torch.no_grad():
        expected = torch.nn.Sequential(*parts)(torch.as_tensor(rows)).numpy()
    np.testing.assert_allclose(_core.Network(given).run(rows, None), expected, rtol=0, atol=1e-12)


def test_hyperbolic_tangent_is_accurate() -> None:
    near = np.linspace(-22.0, 22.0, 200_001)
    far = 10.0 ** np.linspace(-300.0, 300.0, 2_001)
    x = np.concatenate([near, far, -far, [0.0]])
    found = _core.Network([(np.eye(1), np.zeros(1), "tanh")]).run(x[:, None], None)[:, 0]
    np.testing.assert_allclose(found, np.tanh(x), rtol=5e-16, atol=0)
    assert (np.abs(found) <= 1).all()
    assert (np.diff(found[: len(near)]) > -1e-15).all()


def test_same_bits_for_any_number_of_threads_and_instruction_set() -> None:
    expected = digest()
    assert digest(1) == digest(3) == expected
    for isa in {"baseline", _core.isa()}:
        place = f"{TESTS}{os.pathsep}{TESTS / 'agents'}"
        env = {**os.environ, "FGENV_ISA": isa, "FGENV_THREADS": "2", "PYTHONPATH": place}
        command = [sys.executable, "-c", DIGEST]
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == expected, isa


def test_a_row_does_not_depend_on_the_others() -> None:
    network, rows = _core.Network(layers(9, 20, 4)), np.random.default_rng(3).normal(size=(70, 9))
    alone = np.array([network.run(row, None) for row in rows])
    np.testing.assert_array_equal(network.run(rows, None), alone)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "layers: got none, expected at least one"),
        ([(np.ones(3), np.ones(3), "tanh")], r"layers\[0\]: got weights of shape \(3,\)"),
        ([(np.ones((2, 3)), np.ones(2), "tanh")], r"offsets of shape \(2,\), expected \(3,\)"),
        (
            [(np.ones((2, 3)), np.ones(3), "gelu")],
            "activation: got 'gelu', expected tanh, relu or none",
        ),
        ([(np.full((1, 1), np.nan), np.ones(1), "none")], "expected a finite number"),
        (
            [(np.ones((2, 3)), np.ones(3), "tanh"), (np.ones((2, 1)), np.ones(1), "none")],
            r"layers\[1\]: got 2 inputs, expected the 3 outputs",
        ),
    ],
)
def test_invalid_layers_raise(given: list[Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _core.Network(given)


def test_invalid_rows_raise() -> None:
    network = _core.Network(layers(4, 2))
    with pytest.raises(ValueError, match=r"rows: got shape \(3, 5\), expected \(..., 4\)"):
        network.run(np.ones((3, 5)), None)
    with pytest.raises(ValueError, match=r"rows\[1, 2\]: got nan"):
        network.run([[0.0, 0, 0, 0], [0, 0, np.nan, 0]], None)
