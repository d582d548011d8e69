"""YAML 1.2 of mappings, lists, numbers and words, with the line of everything.

It is read from the parser's events, so that what no study needs ends early: tags, texts nested too
deeply, an anchor within itself, aliases that unfold to far more than was written.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

PARSER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # that of libyaml is ten times as fast
DEEPEST = 20  # levels; a study has six
MOST = 100_000  # values, those of aliases each time they are used
DIGITS = 400  # of an integer; more than a float can hold
MERGE = "<<"

WORDS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
INTEGER = re.compile(r"[-+]?[0-9][0-9_]*")
BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9][0-9_]*(\.[0-9_]*)?)([eE][-+]?[0-9]+)?")
SPECIAL = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


class UnreadableText(Exception):
    """What stands against a text, by line from 1; None where a line means nothing."""

    def __init__(self, problems: list[tuple[int | None, str]]) -> None:
        super().__init__(problems)
        self.problems = problems


@dataclass
class Node:
    """A value and the line where it begins, from 1.

    Attributes
    ----------
    value : a scalar, a list of nodes or a dict of nodes
    lines : of the keys of a dict
    """

    value: Any
    line: int
    lines: dict[Any, int] = field(default_factory=dict)

    def plain(self) -> Any:
        """Dicts, lists and scalars."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def count(self, sizes: dict[int, int]) -> int:
        """Number of values, aliases unfolded; ``sizes`` are those of nodes already counted."""
        if id(self) not in sizes:
            value = self.value
            inner = value.values() if isinstance(value, dict) else value
            within = inner if isinstance(value, dict | list) else ()
            sizes[id(self)] = 1 + sum(node.count(sizes) for node in within)
        return sizes[id(self)]


def read(text: str) -> Node:
    """The one document of a text.

    Raises
    ------
    UnreadableText
        With all that is wrong, or all up to where nothing more can be understood.
    """
    reader = _Reader(text)
    try:
        found = reader.document()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else None
        problem = str(error.problem)
        here = text[error.problem_mark.index :] if error.problem_mark else ""
        if here.startswith("\t") and "cannot start any token" in problem:
            problem = "a tab stands here, where YAML takes blanks only"
        raise UnreadableText([*reader.problems, (line, problem)]) from None
    except yaml.YAMLError as error:
        said = str(error).splitlines()[0]
        raise UnreadableText([*reader.problems, (None, said)]) from None
    if not reader.problems and found.count({}) > MOST:
        reader.problems.append((None, f"more than {MOST} values, with aliases unfolded"))
    if reader.problems:
        raise UnreadableText(reader.problems)
    return found


class _Reader:
    """Makes nodes of events; notes what is wrong and goes on."""

    def __init__(self, text: str) -> None:
        self.events: Iterator[Any] = yaml.parse(text, Loader=PARSER)
        self.anchors: dict[str, Node | None] = {}  # None: not ended yet
        self.problems: list[tuple[int | None, str]] = []
        self.taken_over = 0  # keys, by <<

    def document(self) -> Node:
        next(self.events)  # of the stream
        start = next(self.events)
        if isinstance(start, yaml.StreamEndEvent):
            return Node(None, 1)
        if start.version not in (None, (1, 2)):
            self._note(start, "YAML 1.2 is read, and no other version")
        found = self._node(next(self.events), 0)
        next(self.events)  # end of the document
        after = next(self.events)
        if not isinstance(after, yaml.StreamEndEvent):
            self._note(after, "a second document; there is one study in a file")
        return found

    def _node(self, event: Any, depth: int) -> Node:
        line = event.start_mark.line + 1
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event)
        if event.tag is not None:
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            self._note(event, f"the tag {tag:.60} has no meaning here")
        if isinstance(event, yaml.ScalarEvent):
            found = Node(scalar(event.value) if event.implicit[0] else event.value, line)
        elif depth >= DEEPEST:
            raise UnreadableText([*self.problems, (line, "is nested too deeply")])
        else:
            if event.anchor:
                self.anchors[event.anchor] = None
            found = Node({} if isinstance(event, yaml.MappingStartEvent) else [], line)
            fill = self._mapping if isinstance(found.value, dict) else self._list
            fill(found, depth + 1)
        if event.anchor:
            self.anchors[event.anchor] = found
        return found

    def _alias(self, event: Any) -> Node:
        found = self.anchors.get(event.anchor)
        if found is None:
            within = event.anchor in self.anchors
            why = "stands within what it is of" if within else "has no anchor before it"
            self._note(event, f"the alias *{event.anchor:.60} {why}")
            return Node({}, event.start_mark.line + 1)
        return found

    def _list(self, node: Node, depth: int) -> None:
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            node.value.append(self._node(event, depth))

    def _mapping(self, node: Node, depth: int) -> None:
        merged: list[Node] = []
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            line = event.start_mark.line + 1
            key = self._node(event, depth).value
            value = self._node(next(self.events), depth)
            if isinstance(key, dict | list):
                self._note(event, "a key is a word; here it is a list or a mapping")
            elif key == MERGE and getattr(event, "implicit", (False,))[0]:
                merged += self._merged(event, value)
            elif key in node.value:
                said = f"{key!r:.70} stands there twice, first in line {node.lines[key]}"
                self._note(event, f"found duplicate key: {said}")
            else:
                node.value[key], node.lines[key] = value, line
        for other in merged:
            self.taken_over += len(other.value)
            if self.taken_over > MOST:
                raise UnreadableText([(node.line, f"more than {MOST} keys are taken over by <<")])
            for key, value in other.value.items():
                if key not in node.value:
                    node.value[key], node.lines[key] = value, other.lines[key]

    def _merged(self, event: Any, node: Node) -> list[Node]:
        """The mappings that a ``<<`` takes over, the first before the others."""
        found = node.value if isinstance(node.value, list) else [node]
        if not all(isinstance(each.value, dict) for each in found):
            self._note(event, "<< takes over a mapping, or a list of mappings")
            return []
        return found

    def _note(self, event: Any, problem: str) -> None:
        self.problems.append((event.start_mark.line + 1, problem))


def scalar(text: str) -> Any:
    """What a word without quotes is: nothing, true or false, a number, or a word."""
    if text in WORDS:
        return WORDS[text]
    if text[0] not in "-+.0123456789":
        return text
    if INTEGER.fullmatch(text):
        digits = text.replace("_", "")
        return int(digits) if len(digits) <= DIGITS else float(digits)
    if FLOAT.fullmatch(text):
        return float(text.replace("_", ""))
    if BASED.fullmatch(text) and len(text) <= DIGITS:
        return int(text, 0)
    if SPECIAL.fullmatch(text):
        return float(text.replace(".", ""))
    return text
