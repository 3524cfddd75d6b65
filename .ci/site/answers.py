"""Answers of ``irsim describe`` as Markdown, with an anchor for each key."""

from __future__ import annotations

from collections.abc import Mapping

import yaml
from pages import anchor, cell, link, plain

from irsim.lookup import Answer, Key
from irsim.lookup.answer import facts, plain_table

__all__ = ["example", "keys_table", "section"]


def section(
    answer: Answer, page: str, name: str, where: Mapping[str, str], *, level: int = 2, title: str | None = None
) -> str:
    """A topic as a section of a page.

    Args:
        answer: The answer about it.
        page: The page that it stands on.
        name: Name of its anchor, with which the anchors of its keys begin.
        where: Topic -> page and anchor, for links.
        level: Level of its heading.
        title: Its heading; by default the title of the answer.
    """
    parts = [f"{'#' * level} {plain(title or answer.title)}", anchor(name)]
    if answer.text:
        parts.append(plain(answer.text))
    if answer.about is not None and facts(answer.about):
        parts.append(f"Takes: {plain(facts(answer.about))}.")
    for heading, keys in answer.groups.items():
        if not keys:
            continue
        if len(answer.groups) > 1 and heading != "keys":
            parts.append(f"{'#' * (level + 1)} {plain(heading[:1].upper() + heading[1:])}")
        lists_topics = answer.kind == "index" and not heading.startswith("keys")
        parts.append(keys_table(keys, page, name, where if lists_topics else {}))
    if answer.example:
        parts.append(example(answer.example))
    links = [link(topic, page, where[topic]) for topic in answer.see if topic in where]
    if links:
        parts.append(f"See also: {', '.join(links)}.")
    return "\n\n".join(parts)


def keys_table(keys: list[Key], page: str, name: str, where: Mapping[str, str]) -> str:
    """A table with one row per key, each with an anchor; names of topics are links."""
    described = any(facts(key) for key in keys)
    rows = []
    for key in keys:
        shown = link(key.name, page, where[key.name]) if key.name in where else f"`{key.name}`"
        head = anchor(f"{name}.{key.name}") + shown
        rows.append((head, cell(facts(key)), cell(key.text)) if described else (head, cell(key.text)))
    return plain_table(("name", "takes", "meaning") if described else ("name", "meaning"), rows).strip()


def example(text: str) -> str:
    """An example as a fence: a command, or YAML."""
    first = text.lstrip("# ").split(maxsplit=1)[0]
    if first in ("irsim", "python", "pip"):
        return f"```bash\n{text.strip()}\n```"
    try:
        is_yaml = isinstance(yaml.safe_load(text), dict | list)
    except yaml.YAMLError:
        is_yaml = False
    return f"```{'yaml' if is_yaml else 'text'}\n{text.strip()}\n```"
