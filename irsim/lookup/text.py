"""Answers as plain text, for readers that do not use a terminal."""

from __future__ import annotations

import re

from irsim.lookup.answer import Answer, Key

__all__ = ["as_brief_text", "as_text", "facts", "first_sentence"]

_MAX_BRIEF_KEYS = 8
"""Number of keys that a brief answer describes; further ones are only named."""
_MAX_BRIEF_LIST = 3500
"""Number of characters up to which a brief answer repeats a list of topics; of longer ones it has only the names."""
_MIN_BRIEF_TEXT = 200
"""Number of characters from which on the next sentence ends the text of a brief answer."""


def as_text(answer: Answer) -> str:
    """Return an answer as text, without its example: for some topics ``answer.example`` is a command."""
    lines = [answer.title]
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
    topics is whole, or has only names. Of the first topic that a search finds there is only the text.
    """
    lines = [answer.title]
    if answer.text:
        lines.append(_brief(answer))
    if answer.about is not None:
        lines.append(facts(answer.about))
    most = _MAX_BRIEF_KEYS
    if answer.kind == "index":
        listed = sum(len(_line(key)) for keys in answer.groups.values() for key in keys)
        most = len(max(answer.groups.values(), key=len)) if listed <= _MAX_BRIEF_LIST else 0
    for heading, keys in answer.groups.items():
        shown = [] if "in common" in heading or heading == "keys of all" else keys[:most]
        lines += [_brief_line(key) for key in shown]
        if rest := [_with_default(key) for key in keys[len(shown) :]]:
            lines.append(f"- {'also' if shown else heading}: {', '.join(rest)}")
    if answer.best is not None:
        lines += [f"{answer.best.title}\n{_brief(answer.best)}"]
    if answer.example:
        lines.append(
            f"For example: {answer.example}" if "\n" not in answer.example else f"For example:\n{answer.example}"
        )
    return "\n".join(lines)


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
