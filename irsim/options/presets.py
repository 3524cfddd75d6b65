"""Options whose missing keys a named set of values fills in: a vehicle, a device, a fit to recorded people."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

__all__ = ["with_preset"]


Preset = TypeVar("Preset")


def with_preset(
    given: Any,
    key: str,
    presets: Mapping[str, Preset],
    values_of: Callable[[Preset], Mapping[str, Any]],
    *,
    usual: str | None = None,
    nulls: bool = False,
) -> Any:
    """Return the options with the values of the preset that one of them names; options that are given win.

    Args:
        given: The options as written; anything but a mapping stays as it is, and so do options without a known preset.
        key: The option that names the preset.
        presets: Name -> preset.
        values_of: The options of a preset.
        usual: Name of the preset if the options name none.
        nulls: Whether the preset also fills in options that are null.
    """
    name = given.get(key, usual) if isinstance(given, Mapping) else None
    if not isinstance(name, str) or name not in presets:
        return given
    preset = values_of(presets[name])
    return {**preset, **{k: value for k, value in given.items() if not (nulls and value is None and k in preset)}}
