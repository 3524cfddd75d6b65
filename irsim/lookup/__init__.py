"""Answers about the scenario language, components, templates and codes, for ``irsim describe`` and the MCP server.

The answers are generated from the registries, the schema of the models, the templates and the list of codes, so they
cannot contradict them.
"""

from irsim.lookup.answer import Answer, Answers, Key, TopicError, as_brief_text, as_text
from irsim.lookup.topics import lookup, lookup_several, schema_part, topics_of

__all__ = [
    "Answer",
    "Answers",
    "Key",
    "TopicError",
    "as_brief_text",
    "as_text",
    "lookup",
    "lookup_several",
    "schema_part",
    "topics_of",
]
