"""The answer that a lookup returns, as data and as text, and the error for an unknown topic."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict

from irsim.common.text import clean
from irsim.diagnostics.errors import CodedError

__all__ = [
    "Answer",
    "Answers",
    "Key",
    "Kind",
    "TopicError",
    "as_brief_text",
    "as_text",
    "facts",
    "first_sentence",
    "key_list",
    "key_table",
    "plain_table",
    "said_once",
    "title_of",
]


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
    unknown: list[str] = []
    """Of a search: the words that occur in no topic."""
    read_as: str | None = None
    """The name that this answers: the one nearest to a misspelt word; None if the word is a topic."""


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
        super().__init__(self.code, f"{clean(topic)!r} is not a topic", fix, allowed=self.near)


_MAX_BRIEF_KEYS = 8
"""Number of keys that a brief answer describes; further ones are only named."""
_MAX_BRIEF_LIST = 2000
"""Number of characters up to which a brief answer repeats a list of topics; of longer ones it has only the names."""
_MIN_BRIEF_TEXT = 200
"""Number of characters from which on the next sentence ends the text of a brief answer."""


def as_text(answer: Answer) -> str:
    """Return an answer as text, without its example: for some topics ``answer.example`` is a command."""
    lines = [title_of(answer)]
    if answer.text:
        lines.append(answer.text)
    if answer.about is not None:
        lines.append(facts(answer.about))
    for heading, keys in answer.groups.items():
        if keys:
            lines += ["", f"{heading}:", *(_line(key) for key in keys)]
    if answer.see:
        lines += ["", f"see also: {', '.join(answer.see)}"]
    if answer.best is not None:
        lines += ["", as_brief_text(answer.best)]
    return "\n".join(lines)


def as_brief_text(answer: Answer) -> str:
    """Return the essence of an answer: first sentences, its own keys, and the example.

    Keys that a component has in common with its siblings, and those beyond the first ones, are only named. A list of
    topics is whole, or has only names. Of the first topic that a search finds there is the text; the rest are named.
    """
    lines = [title_of(answer)]
    if answer.text:
        lines.append(_brief(answer))
    if answer.about is not None:
        lines.append(facts(answer.about))
    most = _MAX_BRIEF_KEYS
    if answer.kind == "index":
        listed = sum(len(_line(key)) for keys in answer.groups.values() for key in keys)
        most = len(max(answer.groups.values(), key=len)) if listed <= _MAX_BRIEF_LIST else 0
    for heading, keys in answer.groups.items():
        searched = answer.best is not None
        shown = [] if searched or "in common" in heading or heading == "keys of all" else keys[:most]
        lines += [_brief_line(key) for key in shown]
        if searched:
            lines[0] += f": {', '.join(key.name for key in keys)}"
        elif rest := [_with_default(key) for key in keys[len(shown) :]]:
            lines.append(f"- {'also' if shown else heading}: {', '.join(rest)}")
    if answer.best is not None:
        lines += [f"{answer.best.title}\n{_brief(answer.best)}"]
    if answer.example:
        lines.append(
            f"For example: {answer.example}" if "\n" not in answer.example else f"For example:\n{answer.example}"
        )
    return "\n".join(lines)


def title_of(answer: Answer) -> str:
    """The title of an answer; for a misspelt question it says how it was read."""
    return answer.title if answer.read_as is None else f"No such topic; nearest: {answer.read_as!r}. {answer.title}"


def said_once(topics: Sequence[str], answers: Sequence[Answer | TopicError]) -> list[Answer | TopicError]:
    """Shorten the answers to several topics: what one of them has said, a later one only refers to.

    Args:
        topics: The topics.
        answers: The answer to each.
    """
    told, texts, short = set[str](), set[str](), list[Answer | TopicError]()
    for topic, one in zip(topics, answers, strict=True):
        if isinstance(one, Answer) and one.topic in told:
            one = Answer(
                topic=one.topic,
                kind=one.kind,
                title=f"{clean(topic)}: see {one.topic if one.topic != topic else ''} above".replace("  ", " "),
            )
        elif isinstance(one, Answer):
            told.add(one.topic)
            one = one.model_copy(update={"text": "" if one.text in texts else one.text})
            texts.add(one.text)
            if one.best is not None and one.best.topic in told:
                one = one.model_copy(update={"best": None})
            elif one.best is not None:
                told.add(one.best.topic)
        short.append(one)
    return short


def _brief(answer: Answer) -> str:
    """Return the text of a guide or a code, or the first sentences of any other."""
    return answer.text if answer.kind in ("guide", "code") else first_sentence(answer.text, least=_MIN_BRIEF_TEXT)


def _brief_line(key: Key) -> str:
    parts = [part for part in (_with_default(key), first_sentence(key.text)) if part]
    return "- " + ": ".join(parts)


def _with_default(key: Key) -> str:
    """Return name, unit and default of a key: ``vmax [m/s] = 1.5``."""
    unit = "" if not key.unit else f" {key.unit}" if key.unit.startswith("[") else f" [{key.unit}]"
    return f"{key.name}{unit}{' (required)' if key.required else '' if key.default is None else f' = {key.default}'}"


def first_sentence(text: str, *, least: int = 0) -> str:
    """Return the first sentences of a text that together have at least ``least`` characters, by default one."""
    end = re.compile(r"(?<=[.])\s").search(text, least)
    return text if end is None else text[: end.start()]


def _line(key: Key) -> str:
    parts = [part for part in (facts(key), key.text) if part]
    return f"- {key.name}" + (f": {'. '.join(parts)}" if parts else "")


def facts(key: Key) -> str:
    """Return type, unit, range and default of a key in one line."""
    unit = "" if not key.unit else f" {key.unit}" if key.unit.startswith("[") else f" [{key.unit}]"
    if key.type in ("a name", "a value"):
        facts = [f"one of {key.allowed}"]
    else:
        facts = [key.type + unit if key.type else "", key.allowed or ""]
    if key.required:
        facts.append("required")
    if key.default is not None:
        facts.append(f"default {key.default}")
    if key.per_object:
        facts.append("or a list, one per object")
    return "; ".join(fact for fact in facts if fact)


def key_table(keys: Iterable[Key], gaps: Mapping[str, Iterable[str]] | None = None) -> str:
    """Return a table with one row per key: name, accepted values, default, meaning.

    Args:
        keys: The keys. A star marks keys that accept one value per object.
        gaps: Key -> values that are not simulated, which its row lists.
    """
    rows = []
    for key in keys:
        name = f"`{key.name}`" + ("\\*" if key.per_object else "") + (" (required)" if key.required else "")
        missing = ", ".join(f"`{value}`" for value in (gaps or {}).get(key.name, ()))
        note = f" **Not simulated: {missing}.**" if missing else ""
        rows.append((name, _takes(key), f"`{key.default}`" if key.default is not None else "", key.text + note))
    return plain_table(("key", "takes", "default", "meaning"), rows)


def key_list(keys: Iterable[Key]) -> str:
    """Return one line per key: name, accepted values, default, meaning; this is shorter than a table."""
    return "\n".join(f"- `{key.name}` ({_takes(key)}; {key.default}): {key.text}" for key in keys)


def plain_table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    lines = [_row(heads)]
    lines.append(_row("---" for _ in lines[0].split("|")[1:-1]))
    lines += [_row(row) for row in rows]
    return "\n".join(lines) + "\n"


def _row(cells: Iterable[str]) -> str:
    return "| " + " | ".join(" ".join(cell.split()).replace("|", "\\|") for cell in cells) + " |"


def _takes(key: Key) -> str:
    """Describe type, unit and range in a few words."""
    if key.type in ("a name", "a value"):
        return ", ".join(f"`{name}`" for name in (key.allowed or "").split(", "))
    if not key.type:  # a parameter of a template: the range names the unit
        return re.sub(r"^an? (number from )?", "", key.allowed or "")
    unit = key.unit or ""
    if unit and not unit.startswith("["):
        unit = f"[{unit}]"
    words = re.sub(r"^an? ", "", key.type) + (f" {unit}" if set(unit) - set("[1, ]") else "")
    return words + (f", {key.allowed}" if key.allowed else "")
