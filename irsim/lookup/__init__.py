"""Answers about the language, its components, the templates and the codes, for ``irsim describe`` and the MCP server.

Everything comes from the registries, the models' schema, the templates and the list of codes: nothing is said twice.
"""

from irsim.lookup.answer import Answer, Key, TopicError
from irsim.lookup.text import as_text
from irsim.lookup.topics import lookup, schema_part

__all__ = ["Answer", "Key", "TopicError", "as_text", "lookup", "schema_part"]
