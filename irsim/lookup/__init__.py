"""Answers about the scenario language, components, templates and codes, for ``irsim describe`` and the MCP server.

The answers are generated from the registries, the schema of the models, the templates and the list of codes, so they
cannot contradict them.
"""

from irsim.lookup.answer import Answer, Key, TopicError
from irsim.lookup.text import as_text
from irsim.lookup.topics import lookup, schema_part

__all__ = ["Answer", "Key", "TopicError", "as_text", "lookup", "schema_part"]
