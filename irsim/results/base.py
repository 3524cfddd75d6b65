"""The base of all results: what the CLI prints, ``--json`` dumps and tools return."""

from __future__ import annotations

import re
from typing import Any

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from irsim.options.base import field_docs

__all__ = ["Result"]

_UNUSUAL = re.compile(r"[^\n -~]")


def _escaped(found: re.Match[str]) -> str:
    """A character as it is or, if it is not printable, as the units of UTF-16 that JSON escapes."""
    if found[0].isprintable():
        return found[0]
    units = found[0].encode("utf-16-be").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4))


class Result(BaseModel):
    """Base of all results: fields are documented, nothing else gets in.

    As with :class:`irsim.options.base.Options`, the documentation is read on demand, because every command and every
    tool call starts with this module. Models are built at once: pydantic would otherwise read the local variables of
    the first caller, and CPython 3.13.0 crashes on some of these.
    """

    model_config = ConfigDict(extra="forbid")

    def model_dump_json(self, **options: Any) -> str:
        """The result as JSON, the same bytes in Python, ``--json`` and MCP; what is not printable is escaped.

        Args:
            **options: Those of pydantic, such as ``indent``.
        """
        text = super().model_dump_json(**options)
        return text if text.isprintable() else _UNUSUAL.sub(_escaped, text)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        produced = handler(schema)
        properties = handler.resolve_ref_schema(produced).get("properties", {})
        for name, text in field_docs(cls).items():
            if name in properties:
                properties[name].setdefault("description", text)
        return produced
