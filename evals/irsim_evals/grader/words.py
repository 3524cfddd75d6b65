"""Words of a case that must be known: a misspelt one is an error when the case is read, with the nearest match."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import AfterValidator
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from irsim.diagnostics.diagnostic import nearest
from irsim.options.base import problem
from irsim.options.registry import BEHAVIORS

__all__ = ["BehaviorName", "Listed", "OneOf", "Regex", "unknown"]


_MEANT = {
    "diameter": ("radius",), "drive": ("kinematics",), "speed": ("forward",), "max_speed": ("forward",),
    "number": ("count",), "size": ("radius",), "position": ("x",), "goal": ("goal_x",), "angle": ("heading", "opening"),
    "range": ("range_max",), "beams": ("number",), "walls": ("statics",), "people": ("movers",),
    "acceleration": ("acce",), "validate": ("validate_scenario",), "run": ("run_episode",),
}  # fmt: skip
"""Words of authors → what they mean, the first that is known where they are used."""


def unknown(kind: str, word: object, known: Collection[str], listed_by: str | None = None) -> PydanticCustomError:
    """The error that a word is none of the known ones; its fix is the nearest of them, or where they are explained."""
    meant, alike = (_MEANT.get(one or "", ()) for one in (str(word), nearest(word, _MEANT)))
    near = next((one for one in (*meant, nearest(word, known), *alike) if one in known), None)
    fix = f"write {near}" if near else listed_by
    return problem("unknown-value", f"there is no {kind} {word!r}", allowed=list(known), fix=fix, replace=near)


@dataclass(frozen=True)
class OneOf:
    """Metadata of a text that is one of some words.

    Attributes:
        kind: Name in messages for one of the words, such as ``selection``.
        words: The words.
        own: Key of the validation context with further words, which each case defines. Without a context these cannot
            be checked.
        listed_by: Where all words are explained, if no similar one is known.
    """

    kind: str
    words: Collection[str] = field(hash=False)
    own: str = ""
    listed_by: str | None = None

    def _check(self, word: str, info: core_schema.ValidationInfo) -> str:
        further: Mapping[str, Collection[str]] | None = info.context
        if word in self.words or (self.own and further is None):
            return word
        known = [*(further or {}).get(self.own, ()), *self.words]
        if word in known:
            return word
        raise unknown(self.kind, word, known, self.listed_by)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        return {"type": "string"} if self.own else {"type": "string", "enum": list(self.words)}


@dataclass(frozen=True)
class Listed:
    """Metadata of a list that may be written as its only item."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_before_validator_function(
            lambda value: value if isinstance(value, list) else [value], handler(source)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        of_list = handler(schema)
        return {"anyOf": [of_list["items"], of_list]}


def _compiles(pattern: str) -> str:
    try:
        re.compile(pattern)
    except re.error as error:
        raise problem("invalid-value", f"{pattern!r} is not a regular expression: {error}") from None
    return pattern


Regex = Annotated[str, AfterValidator(_compiles)]
"""A regular expression."""
BehaviorName = Annotated[str, OneOf("behavior", tuple(BEHAVIORS.names()), own="behaviors")]
"""Name of a behavior."""
