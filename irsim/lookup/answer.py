"""What a lookup returns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict

from irsim.common.text import clean
from irsim.diagnostics.errors import CodedError

__all__ = ["Answer", "Key", "Kind", "TopicError"]

Kind = Literal["index", "key", "component", "template", "code", "guide", "metric", "search"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)


class Key(_Data):
    """One key of a mapping, or one line of a list of topics."""

    name: str
    """The key; in an index the topic to ask for next."""
    type: str = ""
    """What it takes, in words."""
    unit: str | None = None
    """Unit of the number or numbers."""
    default: str | None = None
    """Value without it, as YAML; None when there is none or it is null."""
    required: bool = False
    """Whether it must be given."""
    allowed: str | None = None
    """Names or range it is limited to."""
    per_object: bool = False
    """Whether a list gives one value to each object of an entry."""
    text: str = ""
    """What it means."""


class Answer(_Data):
    """All there is to say about a topic."""

    topic: str
    """Its full name."""
    kind: Kind
    """What it is."""
    title: str
    """One line."""
    text: str = ""
    """More about it."""
    about: Key | None = None
    """The facts, if it is a key."""
    groups: dict[str, list[Key]] = {}
    """What is in it, under headings: keys, components, templates …"""
    example: str | None = None
    """YAML or a command to start from."""
    see: list[str] = []
    """Related topics."""


class TopicError(CodedError, LookupError):
    """No topic has that name.

    Attributes:
        near: Topics with similar names.
    """

    code = "unknown-topic"

    def __init__(self, topic: str, near: Sequence[str]) -> None:
        self.near = list(near)
        fix = f"did you mean {' or '.join(near)}?" if near else "irsim describe lists all topics"
        super().__init__(self.code, f"nothing is called {clean(topic)!r}", fix)
