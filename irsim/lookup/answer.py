"""The answer that a lookup returns, and the error for an unknown topic."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict

from irsim.common.text import clean
from irsim.diagnostics.errors import CodedError

__all__ = ["Answer", "Answers", "Key", "Kind", "TopicError"]

Kind = Literal["index", "key", "component", "template", "code", "event", "guide", "metric", "policy", "search", "suite"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)


class Key(_Data):
    """One key of a mapping, or one line of a list of topics."""

    name: str
    """Name of the key; in an index, the topic to look up next."""
    type: str = ""
    """Type of the value, in words."""
    unit: str | None = None
    """Unit of the number or numbers."""
    default: str | None = None
    """Default value as YAML; None if there is no default or it is null."""
    required: bool = False
    """Whether the key must be given."""
    allowed: str | None = None
    """Allowed names or range."""
    per_object: bool = False
    """Whether a list gives one value to each object of an entry."""
    text: str = ""
    """Meaning of the key."""


class Answer(_Data):
    """The description of a topic."""

    topic: str
    """Full name of the topic."""
    kind: Kind
    """Kind of topic."""
    title: str
    """Title, one line."""
    text: str = ""
    """Explanation."""
    about: Key | None = None
    """Type, unit, default and range, if the topic is a key."""
    groups: dict[str, list[Key]] = {}
    """Content of the topic under headings: keys, components, templates …"""
    example: str | None = None
    """YAML or a command to start from."""
    see: list[str] = []
    """Related topics."""
    best: Answer | None = None
    """Of a search: what the first of the topics says."""


class Answers(_Data):
    """The descriptions of several topics."""

    answers: list[Answer]
    """One for each topic that is known, in the order of the question."""


class TopicError(CodedError, LookupError):
    """No topic has that name.

    Attributes:
        near: Topics with similar names.
    """

    code = "unknown-topic"

    def __init__(self, topic: str, near: Sequence[str]) -> None:
        self.near = list(near)
        fix = f"did you mean {' or '.join(near)}?" if near else "irsim describe lists all topics"
        super().__init__(self.code, f"{clean(topic)!r} is not a topic", fix)
