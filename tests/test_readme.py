"""What the README shows works as shown."""

import re
from pathlib import Path

import numpy as np

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
    names: dict[str, object] = {}
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
