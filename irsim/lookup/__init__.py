"""Answers about the language, its components, the templates and the codes, for ``irsim describe`` and the MCP server.

Everything comes from the registries, the models' schema, the templates and the list of codes: nothing is said twice.
"""

from irsim.lookup.answer import Answer, Key, TopicError
from irsim.lookup.topics import lookup

__all__ = ["Answer", "Key", "TopicError", "lookup"]
