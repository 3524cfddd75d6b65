"""Types of DDS made from the definitions of messages, for Cyclone DDS."""

from __future__ import annotations

from functools import cache
from typing import Any

__all__ = ["CdrSample", "dds_type", "dds_type_name", "struct_type"]


@cache
def _base() -> dict[str, Any]:
    """Types of DDS for those that messages are made of."""
    from cyclonedds.idl import types

    return {
        "bool": bool, "byte": types.byte, "char": types.uint8, "uint8": types.uint8, "int8": types.int8,
        "uint16": types.uint16, "int16": types.int16, "uint32": types.uint32, "int32": types.int32,
        "uint64": types.uint64, "int64": types.int64, "float32": types.float32, "float64": types.float64,
        "octet": types.byte, "string": str,
    }  # fmt: skip


class CdrSample:
    """A sample of a topic as CDR: it is neither encoded nor decoded by Cyclone DDS.

    Attributes:
        cdr: The content with its header of 4 bytes.
    """

    cdr: bytes

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: Any = None) -> bytes:
        """What is sent."""
        return self.cdr

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True, use_version_2: Any = None) -> CdrSample:
        """A sample from what was received."""
        made = cls.__new__(cls)
        made.cdr = bytes(data)
        return made


def dds_type_name(kind: str, separator: str = "::") -> str:
    """Name of a type of ROS in DDS: ``geometry_msgs::msg::dds_::Twist_``."""
    package, space, name = kind.split("/")
    return separator.join((package, space, "dds_", f"{name}_"))


def struct_type(store: Any, kind: str, made: dict[str, Any] | None = None) -> Any:
    """The ``IdlStruct`` of a message.

    Args:
        store: Type store of rosbags, which has the definitions.
        kind: Type of the message.
        made: Types that exist already.
    """
    from cyclonedds.idl import make_idl_struct

    made = {} if made is None else made
    if kind not in made:
        _, fields = store.fielddefs[kind]
        members = {name: _member(store, definition, made) for name, definition in fields}
        made[kind] = make_idl_struct(kind.rpartition("/")[2], dds_type_name(kind, "."), members)
    return made[kind]


def dds_type(store: Any, kind: str) -> Any:
    """The type of a topic, whose samples are :class:`CdrSample`."""
    found = struct_type(store, kind)
    found.serialize = CdrSample.serialize
    found.deserialize = classmethod(CdrSample.deserialize.__func__)  # type: ignore[attr-defined]
    return found


def _member(store: Any, definition: Any, made: dict[str, Any]) -> Any:
    """Annotation of a member."""
    from cyclonedds.idl import types

    form, detail = definition
    if form.name == "BASE":
        kind, bound = detail
        return types.bounded_str[bound] if bound and kind == "string" else _base()[kind]
    if form.name == "NAME":
        return struct_type(store, detail, made)
    inner, length = detail
    member = _member(store, inner, made)
    if form.name == "ARRAY":
        return types.array[member, length]
    return types.sequence[member, length] if length else types.sequence[member]
