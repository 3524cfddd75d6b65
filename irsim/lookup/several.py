"""Several topics in one question, separated by commas; each is answered briefly."""

from __future__ import annotations

import re

from irsim.diagnostics.errors import InputError
from irsim.lookup.answer import Answer, TopicError
from irsim.lookup.topics import lookup
from irsim.scenario.model.json_schema import json_schema

__all__ = ["MAX_TOPICS", "lookup_several", "topics_of"]

MAX_TOPICS = 12
"""Number of topics that one question may have."""


def topics_of(text: str) -> list[str]:
    """Return the topics of a question: the parts between commas, semicolons and line breaks, without empty ones."""
    return list(dict.fromkeys(part.strip() for part in re.split(r"[,;\n]", text) if part.strip()))


def lookup_several(topics: list[str]) -> list[Answer | TopicError]:
    """Answer several topics; the error of a topic that is not known stands in its place.

    Args:
        topics: At most :data:`MAX_TOPICS`, as in :func:`irsim.lookup.lookup`.

    Raises:
        InputError: There are too many topics.
        TopicError: None of the topics is known.
    """
    if len(topics) > MAX_TOPICS:
        raise InputError(f"{len(topics)} topics are too many", f"ask for at most {MAX_TOPICS} at once")
    schema, found = json_schema(), list[Answer | TopicError]()
    for topic in topics:
        try:
            found.append(lookup(topic, schema=schema))
        except TopicError as error:
            found.append(error)
    if all(isinstance(one, TopicError) for one in found):
        raise next(one for one in found if isinstance(one, TopicError))
    return found
