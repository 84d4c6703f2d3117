"""YAML by the core schema of YAML 1.2, with bounds on aliases.

PyYAML reads YAML 1.1, where 1:30 is 90, 010 is 8, yes is true and 1e3 is text. Here plain values
have the types of YAML 1.2 (yaml.org/spec/1.2.2, section 10.3), and values that the two versions
read differently are errors, as are merge keys and tags of other types.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

PREFIX = "tag:yaml.org,2002:"
TEXT = PREFIX + "str"
AMBIGUOUS = "ambiguous"
DIFFERENCE = "YAML 1.1 and YAML 1.2 read differently"
MERGE = "<<"
MAX_DEPTH = 200  # of [ and {
MAX_ALIASED = 100_000  # nodes that aliases may add to a file

INT = re.compile(r"[-+]?(?:0|[1-9][0-9]*)|0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(
    r"[-+]?(?:(?:\.[0-9]+|[0-9]+\.[0-9]*)(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+)"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)
TRUE, FALSE = ("true", "True", "TRUE"), ("false", "False", "FALSE")
BOOL = re.compile("|".join(TRUE + FALSE))
NULL = re.compile("null|Null|NULL|~|")
OTHERWISE = re.compile(  # YAML 1.1 reads another type or value than YAML 1.2
    r"yes|Yes|YES|no|No|NO|on|On|ON|off|Off|OFF|=|<<"
    r"|[-+]?0b[01_]+|[-+]?0[0-9_]+|[-+]0x[0-9a-fA-F_]+|0x(?=.*_)[0-9a-fA-F_]+"
    r"|(?=.*_)[-+]?\.?[0-9][0-9_]*(?:\.[0-9_]*)?(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+(?:\.[0-9_]*)?"
    r"|[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}(?:(?:[Tt]|[ \t]+)[0-9]{1,2}:[0-9]{2}:[0-9]{2}.*)?"
)
DIGITS = list("-+.0123456789")
RESOLVERS = (  # tag, pattern, first characters
    (AMBIGUOUS, OTHERWISE, [*DIGITS, *"yYnNoO=<"]),
    (PREFIX + "int", INT, DIGITS),
    (PREFIX + "float", FLOAT, DIGITS),
    (PREFIX + "bool", BOOL, list("tTfF")),
    (PREFIX + "null", NULL, ["~", "n", "N", ""]),
)


class Loader(yaml.SafeLoader):
    """Loads plain values of the core schema."""

    def fetch_flow_collection_start(self, token: type[yaml.Token]) -> None:
        """Begin [ or {. PyYAML's time is the square of the depth, libyaml has a limit as well."""
        if self.flow_level >= MAX_DEPTH:
            raise yaml.scanner.ScannerError(None, None, "is nested too deep", self.get_mark())
        super().fetch_flow_collection_start(token)


class FastLoader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """The same for large files: uses libyaml if PyYAML has it."""


def implicit_resolvers(older: Any = None) -> dict[str, list[tuple[str, re.Pattern[str]]]]:
    """Resolvers of plain values by first character; those of another class follow."""
    table: dict[str, list[tuple[str, re.Pattern[str]]]] = {}
    for tag, pattern, characters in RESOLVERS:
        whole = re.compile(f"^(?:{pattern.pattern})$")
        for character in characters:
            table.setdefault(character, []).append((tag, whole))
    for character, items in (older.yaml_implicit_resolvers if older else {}).items():
        table.setdefault(character, []).extend(items)
    return table


def load_value(text: str) -> Any:
    """The value of a text, such as that of an option.

    Raises:
        ValueError: not YAML, or a value that YAML 1.1 and YAML 1.2 read differently.
    """
    loader = Loader(text)
    try:
        root = single_document(loader)
        if root is None:
            return None
        check_aliases(root)
        if isinstance(root, yaml.ScalarNode) and root.tag == AMBIGUOUS:
            raise ValueError(f"got {text!r}, which {DIFFERENCE}; {remedy_of(text)}")
        return loader.construct_document(root)
    except yaml.YAMLError:
        raise ValueError(f"got {text!r}, expected a number or a word") from None
    finally:
        loader.dispose()


def single_document(loader: Any) -> yaml.Node | None:
    """The first document; after it only empty ones may follow, as `rostopic echo` ends a file."""
    root: yaml.Node | None = loader.get_node() if loader.check_node() else None
    while loader.check_node():
        node = loader.get_node()
        if not (isinstance(node, yaml.ScalarNode) and node.value == ""):
            mark = node.start_mark
            raise yaml.composer.ComposerError(
                None, None, "holds several documents, expected one", mark
            )
    return root


def check_aliases(root: yaml.Node) -> None:
    """Raise a YAMLError if aliases expand a document too far, or into itself."""
    sizes: dict[int, int] = {}
    open_nodes: set[int] = set()

    def size(node: yaml.Node) -> int:
        if not isinstance(node, yaml.CollectionNode):
            return 1
        if id(node) in open_nodes:
            raise yaml.composer.ComposerError(
                None, None, "holds itself, by an alias", node.start_mark
            )
        if id(node) not in sizes:
            open_nodes.add(id(node))
            pairs = isinstance(node, yaml.MappingNode)
            parts = [part for pair in node.value for part in pair] if pairs else node.value
            sizes[id(node)] = 1 + sum(map(size, parts))
            own[0] += 1 + sum(not isinstance(part, yaml.CollectionNode) for part in parts)
            open_nodes.discard(id(node))
        return sizes[id(node)]

    own = [0]
    if size(root) > own[0] + MAX_ALIASED:
        text = f"aliases add over {MAX_ALIASED} values"
        raise yaml.composer.ComposerError(None, None, text, root.start_mark)


def remedy_of(value: str) -> str:
    """How to write a value that YAML 1.1 and YAML 1.2 read differently."""
    if value == MERGE:
        return "write the keys of the other table out"
    return "quote text, write numbers in decimal and truth values as true or false"


def _scalar(loader: Any, node: yaml.ScalarNode, *patterns: re.Pattern[str]) -> str:
    value: str = loader.construct_scalar(node)
    if not any(pattern.fullmatch(value) for pattern in patterns):
        kind = node.tag.removeprefix(PREFIX)
        text = f"expected a value of the tag {kind}"
        raise yaml.constructor.ConstructorError(None, None, text, node.start_mark)
    return value


def _int(loader: Any, node: yaml.ScalarNode) -> int:
    value = _scalar(loader, node, INT)
    if len(value) > 400:  # more digits than a float has
        text = "a number is too long"
        raise yaml.constructor.ConstructorError(None, None, text, node.start_mark)
    return int(value, 0)


def _float(loader: Any, node: yaml.ScalarNode) -> float:
    value = _scalar(loader, node, FLOAT, INT).lower()
    if value.startswith(("0x", "0o")):
        return float(int(value, 0))
    return float(value.replace(".inf", "inf").replace(".nan", "nan"))


def _bool(loader: Any, node: yaml.ScalarNode) -> bool:
    return _scalar(loader, node, BOOL) in TRUE


def _null(loader: Any, node: yaml.ScalarNode) -> None:
    _scalar(loader, node, NULL)


def _text(loader: Any, node: yaml.ScalarNode) -> str:
    return str(loader.construct_scalar(node))


def _keep_merge_keys(loader: Any, node: yaml.MappingNode) -> None:
    """Merge keys are keys like others."""


for _loader in (Loader, FastLoader):
    _loader.yaml_implicit_resolvers = implicit_resolvers()
    _loader.flatten_mapping = _keep_merge_keys  # type: ignore[method-assign]
    _loader.yaml_constructors = {
        TEXT: _text,
        AMBIGUOUS: _text,
        PREFIX + "int": _int,
        PREFIX + "float": _float,
        PREFIX + "bool": _bool,
        PREFIX + "null": _null,
        PREFIX + "seq": _loader.construct_yaml_seq,
        PREFIX + "map": _loader.construct_yaml_map,
        None: _loader.construct_undefined,
    }
