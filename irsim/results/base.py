"""The base of all results: what the CLI prints, ``--json`` dumps and tools return."""

from __future__ import annotations

import re
from typing import Any

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticSerializationError, to_json

from irsim.common.field_docs import field_docs
from irsim.common.json_output import encodable

__all__ = ["Result"]

_UNUSUAL = re.compile(r"[^\n -~]")


def _escaped(found: re.Match[str]) -> str:
    """Return a printable character as it is, any other as the UTF-16 units that JSON escapes."""
    if found[0].isprintable():
        return found[0]
    units = found[0].encode("utf-16-be").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4))


class Result(BaseModel):
    """Base of all results: every field is documented, and unknown fields are refused.

    As with :class:`irsim.options.base.Options`, the documentation is read on demand, because every command and every
    tool call imports this module. Models are built at once: pydantic would otherwise read the local variables of
    the first caller, and CPython 3.13.0 crashes on some of these.
    """

    model_config = ConfigDict(extra="forbid")

    def model_dump_json(self, **options: Any) -> str:
        """Return the result as JSON with unprintable characters escaped: the same bytes in Python, ``--json`` and MCP.

        Args:
            **options: Options of pydantic, such as ``indent``.
        """
        try:
            text = super().model_dump_json(**options)
        except PydanticSerializationError:  # the name of a file cannot be decoded
            indent = options.pop("indent", None)
            text = to_json(encodable(self.model_dump(**options)), indent=indent, inf_nan_mode="null").decode()
        return text if text.isprintable() else _UNUSUAL.sub(_escaped, text)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        produced = handler(schema)
        properties = handler.resolve_ref_schema(produced).get("properties", {})
        for name, text in field_docs(cls).items():
            if name in properties:
                properties[name].setdefault("description", text)
        return produced
