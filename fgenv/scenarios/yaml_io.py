"""Reads and writes YAML: keeps line numbers, and writes a short, stable form."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import yaml

from fgenv.file_kind import SCENARIO, other_kind
from fgenv.saving import save_text

from .errors import Problem, ScenarioError, cut
from .schema import ScenarioSpec
from .shapes.bodies import MeshFile
from .yaml_core import (
    AMBIGUOUS,
    DIFFERENCE,
    TEXT,
    FastLoader,
    Loader,
    check_aliases,
    implicit_resolvers,
    remedy_of,
    single_document,
)

LONGEST = 50_000_000  # characters of a file
LARGE = 100_000  # characters from which libyaml reads a file
WIDTH = 100
Location = Sequence[str | int]
AnyScenario = TypeVar("AnyScenario", bound=ScenarioSpec)


@dataclass(frozen=True)
class Document:
    """The values of a file, with their lines."""

    data: Any
    root: yaml.Node | None = None
    problems: Sequence[Problem] = field(default=())  # repeated keys

    def line(self, location: Location) -> int | None:
        """The line (from 1) of a location, or of its nearest ancestor in the file."""
        node, line = self.root, None
        for step in location:
            if isinstance(node, yaml.MappingNode):
                found = next(((k, v) for k, v in node.value if k.value == str(step)), None)
            elif isinstance(node, yaml.SequenceNode) and isinstance(step, int):
                found = (node.value[step],) * 2 if step < len(node.value) else None
            else:
                break
            if found is not None:  # otherwise a schema tag or a missing key
                key, node = found
                line = key.start_mark.line + 1
        return 1 if line is None and self.root is not None else line


def read(path: Path, loader: type[Any] | None = None) -> Document:
    """Parse a file.

    Args:
        loader: see `parse`.

    Raises:
        ScenarioError: not a regular file, too large, not text, or not YAML; with the line.
        OSError: the file cannot be opened.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise ScenarioError(path, [Problem("is no regular file", "copy its content to a file")])
    if path.is_file() and path.stat().st_size > 4 * LONGEST:  # of UTF-8
        raise ScenarioError(path, [Problem(f"is over {LONGEST} characters", "split it")])
    if other := other_kind(path, SCENARIO):
        raise ScenarioError(path, [Problem(other)])
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ScenarioError(
            path, [Problem(f"is not text: {error.reason}", "write UTF-8")]
        ) from None
    return parse(text, path, loader)


def parse(text: str, path: Path, loader: type[Any] | None = None) -> Document:
    """Parse text; `path` is for messages.

    Args:
        loader: `Loader` or `FastLoader`; None: by the length of the text. PyYAML's own loader has
            the better messages, and takes 10 s for a megabyte.
    """
    if len(text) > LONGEST:
        raise ScenarioError(path, [Problem(f"is over {LONGEST} characters", "split it")])
    reader = None
    loader = loader or (FastLoader if len(text) > LARGE else Loader)
    try:
        reader = loader(text)
        root = single_document(reader)
        if root is not None and "*" in text:
            check_aliases(root)
        data = None if root is None else reader.construct_document(root)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = _not_yaml(error.problem or error.context, mark.line + 1 if mark else None)
    except (yaml.YAMLError, ValueError, TypeError, OverflowError) as error:
        problem = _not_yaml(str(error) or type(error).__name__, None)
    except RecursionError:
        problem = Problem("is nested too deep", "write plain YAML")
    else:
        if ambiguous := ambiguities(root):
            raise ScenarioError(path, ambiguous)
        return Document(data, root, tuple(repeated(root)))
    finally:
        if reader is not None:
            reader.dispose()
    raise ScenarioError(path, [problem])


def _not_yaml(reason: object, line: int | None) -> Problem:
    return Problem(f"is not YAML: {cut(str(reason).splitlines()[0])}", "see the YAML", line=line)


def ambiguities(root: yaml.Node | None) -> list[Problem]:
    """Plain values that YAML 1.1 and YAML 1.2 read differently."""
    stack, seen, found = [root], set(), []
    while stack:
        node = stack.pop()
        if isinstance(node, yaml.ScalarNode):
            if node.tag == AMBIGUOUS:
                found.append(node)
        elif node is not None and id(node) not in seen:
            seen.add(id(node))
            pairs = isinstance(node, yaml.MappingNode)
            stack += [part for pair in node.value for part in pair] if pairs else node.value
    lines = sorted({(node.start_mark.line + 1, node.value) for node in found})
    return [Problem(f"got {cut(value)}, which {DIFFERENCE}", remedy_of(value), line=line)
            for line, value in lines]  # fmt: skip


def repeated(root: yaml.Node | None) -> list[Problem]:
    """Repeated keys of a mapping, of which YAML would silently keep the last, and keys not text."""
    found, stack, seen = [], [root], set()
    while stack:
        node = stack.pop()
        if id(node) in seen or not isinstance(node, yaml.CollectionNode):
            continue
        seen.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            stack += node.value
            continue
        keys: dict[str, int] = {}
        for key, value in node.value:
            line, name = key.start_mark.line + 1, str(key.value)
            if key.tag != TEXT:
                problem = Problem("is no text, expected a name as key", "quote it", cut(name), line)
                found.append(problem)
            elif name in keys:
                text = f"stands twice, first in line {keys[name]}"
                found.append(Problem(text, "keep one", cut(name), line))
            keys[name] = line
            stack.append(value)
    return found


def write(scenario: ScenarioSpec, path: Path) -> None:
    """See `Scenario.save`."""
    save_text(path, dump(moved(scenario, path.parent)))


def moved(scenario: AnyScenario, folder: Path) -> AnyScenario:
    """The same scenario with the paths of its files relative to another folder."""

    def path(file: str) -> str:
        if file.startswith("package://") or Path(file).is_absolute():
            return file
        return Path(os.path.relpath((scenario.folder or Path()) / file, folder)).as_posix()

    shapes = {
        name: form.model_copy(update={"file": path(form.file)})
        if isinstance(form, MeshFile)
        else form
        for name, form in scenario.shapes.items()
    }
    models = {
        name: model.model_copy(
            update={k: path(v) for k in ("urdf", "srdf") if (v := getattr(model, k))}
        )
        for name, model in scenario.models.items()
    }
    return scenario.model_copy(update={"shapes": shapes, "models": models}).at(folder)


def dump(scenario: ScenarioSpec) -> str:
    """The scenario as YAML without defaults; short values in one line."""
    data = scenario.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    return str(yaml.dump(Block(data), Dumper=Dumper, sort_keys=False, width=WIDTH))


class Block(dict[str, Any]):
    """A top-level mapping: each value starts on its own line."""


class Dumper(yaml.SafeDumper):
    """Writes collections of plain values in one line, others in several.

    Text that a reader of YAML 1.1 or 1.2 could take for another value is quoted.
    """

    yaml_implicit_resolvers = implicit_resolvers(yaml.SafeDumper)

    def ignore_aliases(self, data: Any) -> bool:
        """Anchors are hard to read."""
        return True


def _block(dumper: Dumper, data: Block) -> yaml.Node:
    node = dumper.represent_mapping("tag:yaml.org,2002:map", data, flow_style=False)
    for _, value in node.value:
        if isinstance(value, yaml.MappingNode):  # shapes, models: a line each
            value.flow_style = False
            entries = [v for _, v in value.value]
        elif isinstance(value, yaml.SequenceNode):
            value.flow_style = False
            entries = value.value
        else:
            continue
        for entry in entries:
            flowing(entry)
    return node


def flowing(node: yaml.Node) -> None:
    """Write this node and its children in one line."""
    if isinstance(node, yaml.CollectionNode):
        node.flow_style = True
        for child in node.value:
            for part in child if isinstance(child, tuple) else (child,):
                flowing(part)


Dumper.add_representer(Block, _block)
