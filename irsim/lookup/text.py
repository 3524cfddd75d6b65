"""Answers as plain text, for readers that do not use a terminal."""

from __future__ import annotations

from irsim.lookup.answer import Answer, Key

__all__ = ["as_text", "facts"]


def as_text(answer: Answer) -> str:
    """Return an answer as text, without its example: for some topics ``answer.example`` is a command."""
    lines = [answer.title]
    if answer.text:
        lines.append(answer.text)
    if answer.about is not None:
        lines.append(facts(answer.about) + ("; or a list, one per object" if answer.about.per_object else ""))
    for heading, keys in answer.groups.items():
        if keys:
            lines += ["", f"{heading}:", *(_line(key) for key in keys)]
    if answer.see:
        lines += ["", f"see also: {', '.join(answer.see)}"]
    return "\n".join(lines)


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
    return "; ".join(fact for fact in facts if fact)
