"""Bridges as a command line or a program names them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from irsim.bridges.base import BridgeError
from irsim.common.arguments import as_given
from irsim.diagnostics.diagnostic import Diagnostic, suggestion
from irsim.diagnostics.errors import InputError
from irsim.options.registry import BRIDGES
from irsim.scenario.behavior_override import parse_behavior
from irsim.scenario.messages.translate import option_message, option_problems
from irsim.scenario.model.scenario import Scenario
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["bridge_text", "check_files", "read_bridge", "read_bridges"]


def read_bridges(given: Sequence[str | Mapping[str, Any]]) -> list[Any]:
    """Options models of bridges; see :func:`read_bridge`."""
    if isinstance(given, (str, Mapping)):
        given = [given]
    return [read_bridge(one) for one in given]


def read_bridge(given: str | Mapping[str, Any]) -> Any:
    """The options model of a bridge.

    Args:
        given: A mapping, or text: a name such as ``ros2``, or ``{name: ros2, backend: dds}``.

    Raises:
        BridgeError: There is no such bridge, or its options are not valid; the message has all problems.
    """
    fix = "give a name, or {name: json_lines, address: '127.0.0.1:9100'}; irsim describe bridges lists them"
    if isinstance(given, str):
        try:
            data: Any = parse_behavior(given)
        except InputError:
            raise _wrong(f"{given!r} is not a bridge", fix) from None
    else:
        data = given
    if not isinstance(data, Mapping):
        raise _wrong(f"{as_given(given)} is not a bridge", fix)
    name = data.get("name")
    if isinstance(name, str) and BRIDGES.get(name) is None:
        raise _wrong(
            f"{name!r} is not a bridge", suggestion(name, BRIDGES.names(), f"they are {', '.join(BRIDGES.names())}")
        )
    whole = {"bridges": [dict(data)]}
    try:
        return Scenario.model_validate(whole).bridges[0]
    except ValidationError as error:
        called = f"the bridge '{name}'" if isinstance(name, str) else "a bridge"
        raise _invalid(option_problems(error, whole, Scenario, ("bridges", 0), called), called, name) from None


def _invalid(diagnostics: list[Diagnostic], called: str, name: Any) -> BridgeError:
    """The error of options that are not valid, with their problems as data."""
    message, fix = option_message(diagnostics)
    fix = fix or (f"irsim describe bridge.{name} lists the keys" if isinstance(name, str) else None)
    text = message if called in message else f"{called}: {message}"
    error = BridgeError(diagnostics[0].code, text, fix, where="bridges")
    error.diagnostics = diagnostics
    return error


def check_files(options: Sequence[Any], root: Path) -> None:
    """Check that bridges write no files outside of a folder.

    Raises:
        BridgeError: A key names a file that is elsewhere.
    """
    for one in options:
        for key in getattr(one, "files", ()):
            given = getattr(one, key)
            if given is None:
                continue
            target = (root / given).resolve()
            hidden = any(part.startswith(".") for part in Path(given).parts)
            if not target.is_relative_to(root.resolve()) or hidden:
                what = f"{key} of the bridge {one.name} is outside of the folder that may be written: {given!r}"
                raise BridgeError("bridge-mismatch", what, f"name a file in it, such as {key}: {target.name}")


def bridge_text(options: Any) -> str:
    """A bridge as text, as it is written on a command line: what differs from the defaults."""
    written = options.model_dump(exclude_unset=True)
    return yaml_flow({"name": options.name, **written}) if len(written) > 1 else str(options.name)


def _wrong(message: str, fix: str) -> BridgeError:
    return BridgeError("bad-argument", message, fix, where="bridges")
