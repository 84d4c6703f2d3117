"""Options with choices, and options without effect: completed, listed in the help, or refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import pytest
from support.shell import Shell

from fgenv.agents.policies.names import policy_names
from fgenv.cli import completion

CHOICES = [
    ("plan swap", "--method", completion.methods),
    ("plan swap", "--planner", completion.planners),
    ("plan swap", "--objective", completion.objectives),
    ("render r.npz --png p.png", "--camera", completion.cameras),
    ("plot r.npz --out p.png", "--kind", completion.plot_kinds),
]


@pytest.mark.parametrize(("command", "option", "choices"), CHOICES)
def test_a_misspelt_choice_is_refused_with_the_nearest(
    shell: Shell, command: str, option: str, choices: Callable[[], Iterable[str]]
) -> None:
    for choice in choices():
        misspelt = choice[:-1] + ("x" if choice[-1] != "x" else "y")
        message = shell.refuses(*command.split(), option, misspelt)
        assert f"{option}: got '{misspelt}'; did you mean" in message
        assert repr(choice) in message


@pytest.mark.parametrize(("command", "option", "choices"), CHOICES)
def test_the_help_lists_all_choices(
    shell: Shell, command: str, option: str, choices: Callable[[], Iterable[str]]
) -> None:
    _, text, _ = shell(command.split()[0], "--help")
    for choice in choices():
        assert choice in text


def test_the_help_lists_all_kinds_of_policies(shell: Shell) -> None:
    for command in ("run", "eval", "view"):
        _, text, _ = shell(command, "--help")
        kinds = {name.partition(":")[0] for name in policy_names()}
        assert all(kind in text for kind in (*kinds, "orca:shortest", "FILE.py:NAME"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("scenarios swap --cases 3", "--cases: expected with --freeze"),
        ("scenarios --n 3", "--n: expected with the NAME of a scenario"),
        ("scenarios --save s.yaml", "--save: expected with the NAME of a scenario"),
        ("scenarios --schema --seed 3", "--seed: has no effect with --schema"),
        ("scenarios swap --freeze s.npz --picture p.png", "--picture: has no effect with --freeze"),
        ("render r.npz --png p.png --fps 3", "--fps: is of a movie, expected with --gif or --mp4"),
        ("render r.npz --png p.png --speed 2", "--speed: is of a movie"),
        ("render r.npz --gif m.gif --at 2", "--at: is of a picture, expected with --png"),
        ("plan swap --n 3 --method conflict_based --objective time", "objective: got 'time' with"),
        ("eval swap --policy goto --policy goto", "--policy: got 'goto' twice, expected each"),
        ("run swap --policy mlp:swop", "policy: got 'mlp:swop', which is no included policy; "),
    ],
)
def test_an_option_without_effect_is_refused(shell: Shell, arguments: str, message: str) -> None:
    assert message in shell.refuses(*arguments.split())


def test_a_time_after_the_end_of_a_record_is_refused(shell: Shell) -> None:
    shell("run", "swap", "--n", 2, "--steps", 5, "--record", "r.npz")
    message = shell.refuses("render", "r.npz", "--png", "p.png", "--at", 999)
    assert "--at: got 999 s, expected up to 0.5 s, the length of the record" in message
