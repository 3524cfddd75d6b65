"""Definitions of messages as IDL, for the code generator of Fast DDS."""

from __future__ import annotations

from typing import Any

_BASE = {
    "bool": "boolean", "byte": "octet", "uint8": "uint8", "int8": "int8", "uint16": "unsigned short",
    "int16": "short", "uint32": "unsigned long", "int32": "long", "uint64": "unsigned long long", "int64": "long long",
    "float32": "float", "float64": "double", "string": "string",
}  # fmt: skip


def idl_of(store: Any, kinds: list[str]) -> str:
    """IDL of messages and all that they have, each before its first use."""
    done: dict[str, str] = {}
    for kind in kinds:
        _add(store, kind, done)
    return "\n".join(done.values())


def _add(store: Any, kind: str, done: dict[str, str]) -> None:
    if kind in done:
        return
    _, fields = store.fielddefs[kind]
    members = [_member(store, name, definition, done) for name, definition in fields]
    package, _, name = kind.split("/")
    done[kind] = (
        f"module {package} {{ module msg {{ module dds_ {{ struct {name}_ {{ {' '.join(members)} }}; }}; }}; }};"
    )


def _member(store: Any, name: str, definition: Any, done: dict[str, str]) -> str:
    form, detail = definition
    if form.name in ("ARRAY", "SEQUENCE"):
        inner, length = detail
        kind = _type(store, inner, done)
        return f"{kind} {name}[{length}];" if form.name == "ARRAY" else f"sequence<{kind}> {name};"
    return f"{_type(store, definition, done)} {name};"


def _type(store: Any, definition: Any, done: dict[str, str]) -> str:
    form, detail = definition
    if form.name == "BASE":
        return _BASE[detail[0]]
    _add(store, detail, done)
    package, _, name = detail.split("/")
    return f"{package}::msg::dds_::{name}_"
