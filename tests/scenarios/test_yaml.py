"""YAML: values of the core schema of YAML 1.2, or an error; aliases, keys, tags and documents."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st

from fgenv.scenarios import Scenario, ScenarioError, validate
from fgenv.scenarios.errors import short
from fgenv.scenarios.yaml_core import FastLoader, Loader, load_value
from fgenv.scenarios.yaml_io import parse

HERE = Path("file.yaml")
LOADERS = (Loader, FastLoader)
PLAIN = st.one_of(
    st.text("0123456789+-._:eExob", min_size=1, max_size=8),
    st.from_regex(r"\A[-+]?[0-9]{1,3}(:[0-9]{1,2}){0,2}(\.[0-9]{0,2})?\Z"),
    st.sampled_from(
        [*"yYnN~=", "yes", "No", "ON", "off", "true", "False", "null", "NULL", ".inf", "-.Inf"]
        + [".NaN", "<<", "0o17", "0x1F", "0b11", "1_000", "1e3", "1.e5", "2001-12-14", "1e-3"]
        + ["2001-12-14t21:59:43.10-05:00", "010", "08", "-0", "+12", "1:30", "190:20:30.15"]
    ),
)


def core_value(text: str) -> Any:
    """The value of a plain scalar by the table in section 10.3.2 of the specification."""
    if text in ("null", "Null", "NULL", "~", ""):
        return None
    if text in ("true", "True", "TRUE", "false", "False", "FALSE"):
        return text.lower() == "true"
    if re.fullmatch(r"[-+]?[0-9]+", text):
        return int(text)
    for prefix, digits, base in (("0o", "[0-7]+", 8), ("0x", "[0-9a-fA-F]+", 16)):
        if re.fullmatch(prefix + digits, text):
            return int(text[2:], base)
    if re.fullmatch(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", text):
        return float(text)
    if re.fullmatch(r"[-+]?\.(inf|Inf|INF)", text):
        return -math.inf if text[0] == "-" else math.inf
    return math.nan if text in (".nan", ".NaN", ".NAN") else text


def older_value(text: str) -> Any:
    """The value by YAML 1.1, which PyYAML reads; text where it has none."""
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError):
        return ValueError


def same(a: Any, b: Any) -> bool:
    both_nan = isinstance(a, float) and isinstance(b, float) and math.isnan(a) and math.isnan(b)
    return both_nan or (type(a) is type(b) and a == b)


@given(PLAIN)
@example("-.5")
@example("1:30")
@example("0o7")
@example("1._5")
@example("-.Inf")
@example("+.INF")
def test_a_plain_value_has_its_type_of_yaml_1_2_or_is_refused(text: str) -> None:
    try:
        events = list(yaml.parse(f"a: {text}"))
    except yaml.YAMLError:
        return
    plain = [e for e in events if isinstance(e, yaml.ScalarEvent)]
    if len(plain) != 2 or plain[1].value != text:
        return  # another construct, such as "- x"
    older, core = older_value(text), core_value(text)
    for loader in LOADERS:
        try:
            value = parse(f"a: {text}", HERE, loader).data["a"]
        except ScenarioError:
            # Numbers with leading zeros, colons or underscores are refused in all forms.
            odd = re.fullmatch(r"[-+]?[0-9._:]*[0-9_:][0-9._:]*([eE][-+]?[0-9]+)?", text)
            assert odd or not same(older, core), (text, older, core)
        else:
            assert same(value, core)
            assert same(older, core) or isinstance(older, str), (text, older, core)


@pytest.mark.parametrize("loader", LOADERS)
def test_all_ambiguous_values_are_reported_with_their_lines(loader: type[Any]) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse("a: 1:30\nb: [on, {c: 010}]\nd: 'yes'\n", HERE, loader)
    assert [problem.line for problem in caught.value.problems] == [1, 2, 2]
    assert all("quote text" in problem.remedy for problem in caught.value.problems)


@pytest.mark.parametrize("loader", LOADERS)
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: &a [*a]", "holds itself, by an alias"),
        ("a: !!float '1:30'", "expected a value of the tag float"),
        ("a: !!python/name:os.system x", "could not determine a constructor"),
        ("a: !!binary AA==", "could not determine a constructor"),
        ("a: !" + "x" * 5000, "could not determine a constructor"),
        ("b: &b {c: 1}\na: {<<: *b}", "got <<"),
        ("!!merge <<: {a: 1}", "could not determine a constructor"),
        ("a: 1\n---\nb: 2\n", "line 3: is not YAML: holds several documents"),
        ("[" * 5000, "deep|depth"),
        ("a: " + "9" * 5000, "too long"),
        ("? [a]\n: 1", "unhashable key"),
    ],
)
def test_what_is_not_plain_yaml_is_one_short_error(
    text: str, message: str, loader: type[Any]
) -> None:
    with pytest.raises(ScenarioError, match=message) as caught:
        parse(text, HERE, loader)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("loader", LOADERS)
@pytest.mark.parametrize("end", ["---\n", "---\n---\n", "...\n", ""])
def test_empty_documents_may_follow(end: str, loader: type[Any]) -> None:
    assert parse("a: 1\n" + end, HERE, loader).data == {"a": 1}


@pytest.mark.parametrize("keys", ["a: 1\na: 2", "a: 1\n'a': 2", "b: {c: 1, c: 1}", "1: a", "~: a"])
def test_keys_are_text_and_stand_once(keys: str) -> None:
    (problem,) = parse(keys, HERE).problems
    assert problem.line == (2 if "\n" in keys else 1)


def bomb(width: int, depth: int) -> str:
    lines = ["a0: &a0 [" + ", ".join("x" * width) + "]"]
    for i in range(1, depth):
        lines.append(f"a{i}: &a{i} [" + ", ".join([f"*a{i - 1}"] * width) + "]")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("key", ["name", "bodies", "shapes", "[x]"])
@pytest.mark.parametrize(("width", "depth"), [(9, 10), (2, 60), (100, 3), (10, 4)])
def test_aliases_are_bounded_wherever_they_stand(
    width: int, depth: int, key: str, tmp_path: Path
) -> None:
    (tmp_path / "s.yaml").write_text(f"version: 1\n{bomb(width, depth)}'{key}': *a{depth - 1}\n")
    problems = validate(tmp_path / "s.yaml")
    assert problems
    assert max(len(str(problem)) for problem in problems) < 400
    if width**depth > 10**6:
        assert "aliases add over 100000 values" in problems[0].text


def test_aliases_of_a_common_value_are_read() -> None:
    assert parse("a: &p [1, 2]\nb: [*p, *p]", HERE).data == {"a": [1, 2], "b": [[1, 2], [1, 2]]}


@given(st.text(max_size=30) | PLAIN)
def test_a_saved_name_is_read_back(tmp_path_factory: pytest.TempPathFactory, name: str) -> None:
    path = tmp_path_factory.getbasetemp() / "named.yaml"
    scenario = Scenario(version=1, name="s", description=name)
    scenario.save(path)
    assert Scenario.load(path).description == name
    assert yaml.safe_load(path.read_text(encoding="utf-8")).get("description", "") == name


@given(
    st.recursive(st.integers() | st.text(), lambda x: st.lists(x) | st.dictionaries(st.text(), x))
)
def test_values_in_messages_are_short(value: Any) -> None:
    assert len(short(value)) <= 60


@pytest.mark.parametrize(
    ("text", "value"), [("0.5", 0.5), ("l", "l"), ("[1, 2]", [1, 2]), ("", None)]
)
def test_values_of_options(text: str, value: Any) -> None:
    assert load_value(text) == value


@pytest.mark.parametrize("text", ["1:30", "yes", "[1", "&a [*a]", "a: b: c", "1\n---\n2"])
def test_values_of_options_that_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="got"):
        load_value(text)
