"""The text of a study file: read without duplicate keys, and every refusal with its line."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from geometry.refusal import Refusal
from workflow.study.errors import StudyError, choices, shown
from workflow.study.schema import NAME_RULE, Entry, StudyFile

T = TypeVar("T")
Keys = tuple[str | int, ...]
MOST = 3  # refusals shown at once


@dataclass(frozen=True)
class Source:
    """A file and what stands in it.

    Attributes
    ----------
    plain : dicts, lists and scalars
    marked : the same with line numbers
    """

    path: Path
    plain: Any
    marked: Any

    @classmethod
    def read(cls, path: Path) -> "Source":
        """Parse a file; a duplicate key is an error."""
        try:
            marked = YAML(typ="rt").load(path.read_text(encoding="utf-8"))
            return cls(path, _plain(marked), marked)
        except FileNotFoundError:
            raise StudyError(f"{path}: there is no such file") from None
        except (OSError, UnicodeDecodeError) as error:
            raise StudyError(f"{path}: cannot be read ({error})") from None
        except MarkedYAMLError as error:
            line = f":{error.problem_mark.line + 1}" if error.problem_mark else ""
            problem = str(error.problem).partition(" with value")[0]  # of a duplicate key
            raise StudyError(f"{path}{line}: {problem}") from None
        except (YAMLError, ValueError) as error:
            raise StudyError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from None
        except RecursionError:
            raise StudyError(f"{path}: is nested too deeply") from None

    def check_values(self) -> None:
        """Refuse a key that is there but has no value: what was meant cannot be known."""
        for keys in _without_value(self.plain):
            raise self.refuse(keys, None, "a value; or leave the key out")

    def refuse(self, keys: Keys, value: object, allowed: str) -> StudyError:
        """The error for the value of a key (None: the key is missing)."""
        given = "is missing" if value is None else f"= {shown(value)} is refused"
        return StudyError(f"{self.place(keys)} {given}\n  allowed: {allowed}")

    def place(self, keys: Keys) -> str:
        """``file:line: key.path``; the line is that of the last key that is there."""
        node: Any = self.marked
        line = None
        for key in keys:
            try:
                marks = node.lc  # where ruamel.yaml has read it
                line = (marks.key(key) if isinstance(node, Mapping) else marks.item(key))[0]
                node = node[key]
            except (AttributeError, KeyError, IndexError, TypeError):
                break
        where = f"{self.path}:{line + 1}" if line is not None else f"{self.path}"
        return f"{where}: {'.'.join(_readable(key) for key in keys)}"

    def checked(
        self,
        keys: Keys,
        build: Callable[..., T],
        values: Mapping[str, Any],
        renamed: Mapping[str, str] | None = None,
    ) -> T:
        """``build(**values)``, where a refusal names the key below ``keys``.

        ``renamed`` says what the study file calls a value that is called otherwise elsewhere.
        """
        try:
            return build(**values)
        except Refusal as refusal:
            name = (renamed or {}).get(refusal.field, refusal.field)
            raise self.refuse((*keys, name), refusal.value, refusal.allowed) from None

    def refusal_of(self, errors: ValidationError) -> StudyError:
        """The first few errors of the schema in one."""
        found = errors.errors(include_url=False)
        lines = [self._line(error) for error in found[:MOST]]
        if len(found) > MOST:
            lines.append(f"... and {len(found) - MOST} more")
        return StudyError("\n".join(lines))

    def _line(self, error: ErrorDetails) -> str:
        keys = error["loc"]
        if keys and keys[-1] == "[key]":
            return f"{self.place(keys[:-1])} is no name\n  allowed: {NAME_RULE}"
        if error["type"] in ("extra_forbidden", "invalid_key"):
            allowed = choices(keys[-1], _known_keys(keys[:-1]))
            return f"{self.place(keys)} is no key here\n  allowed: {allowed}"
        if error["type"] == "missing":
            return f"{self.place(keys)} is missing\n  allowed: this key must be given"
        allowed = error["msg"].removeprefix("Input should be ")
        if error["type"] in ("model_type", "dict_type"):
            allowed = "a mapping, key: value"
        return f"{self.place(keys)} = {shown(error['input'])} is refused\n  allowed: {allowed}"


def _plain(node: Any) -> Any:
    """Without ruamel's own classes; a tag would be lost, so there must be none."""
    tag = getattr(getattr(node, "tag", None), "value", None)
    if tag is not None:
        raise ValueError(f"the tag {tag} has no meaning here")
    if isinstance(node, Mapping):
        return {_plain(key): _plain(value) for key, value in node.items()}
    if isinstance(node, list):
        return [_plain(value) for value in node]
    for kind in (bool, int, float, str):
        if isinstance(node, kind):
            return kind(node)
    return node


def _without_value(node: Any, keys: Keys = ()) -> Iterator[Keys]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from [(*keys, key)] if value is None else _without_value(value, (*keys, key))


def _readable(key: str | int) -> str:
    return key if isinstance(key, str) and key.isprintable() else shown(key)


def _known_keys(keys: Keys) -> list[str]:
    """Keys that the schema has at a place of the file."""
    schema: Any = StudyFile
    for key in keys:
        if isinstance(schema, type) and issubclass(schema, Entry):
            schema = schema.model_fields[str(key)].annotation
            entry = [a for a in get_args(schema) if isinstance(a, type) and issubclass(a, Entry)]
            if entry and not _is_dict(schema):
                schema = entry[0]  # optional
        else:
            schema = get_args(schema)[1]  # of dict[name, entry]
    return list(schema.model_fields)


def _is_dict(schema: Any) -> bool:
    return getattr(schema, "__origin__", None) is dict
