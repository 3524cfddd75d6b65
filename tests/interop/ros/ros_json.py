"""Messages of ROS 1 and the JSON of the rosbridge protocol, by the classes that ROS generates from its definitions.

A field is named and typed as ``__slots__`` and ``_slot_types`` of its class say. Times and durations have ``secs`` and
``nsecs``, and what JSON has no number for is null; none of our messages has bytes, which would be base64.
"""

from __future__ import annotations

import math
from io import BytesIO
from typing import Any

import genpy
import roslib.message

__all__ = ["UnfitError", "as_json", "message_class", "message_of"]

FLOATS = ("float32", "float64")
TIMES = {"time": genpy.Time, "duration": genpy.Duration}
FILLED_IN = ("seq",)
"""Fields that ROS 1 fills in itself when a message is published."""


class UnfitError(ValueError):
    """JSON that does not fit the definition of a message."""


def message_class(kind: str) -> Any:
    """The class of a type such as ``nav_msgs/Odometry``."""
    result = roslib.message.get_message_class(kind)
    if result is None:
        raise UnfitError(f"there is no message {kind}")
    return result


def message_of(value: Any, made: Any) -> Any:
    """The message of a JSON object and a class, checked by ROS itself and serialized once."""
    message = _message(value, made)
    try:
        message._check_types()
        message.serialize(BytesIO())
    except genpy.SerializationError as error:
        raise UnfitError(f"{made._type}: {error}") from None
    return message


def as_json(message: Any) -> dict[str, Any]:
    """The JSON object of a message."""
    return {
        name: _plain(getattr(message, name), kind)
        for name, kind in zip(message.__slots__, message._slot_types, strict=True)
    }


def _message(value: Any, made: Any) -> Any:
    kind = made._type
    if not isinstance(value, dict):
        raise UnfitError(f"{kind} is an object, got {value!r:.60}")
    fields = dict(zip(made.__slots__, made._slot_types, strict=True))
    if unknown := value.keys() - fields:
        raise UnfitError(f"{kind} has no field {min(unknown)}")
    if missing := fields.keys() - value.keys() - set(FILLED_IN):
        raise UnfitError(f"the field {min(missing)} of {kind} is missing")
    return made(**{name: _field(one, fields[name]) for name, one in value.items()})


def _field(value: Any, kind: str) -> Any:
    if kind.endswith("]"):
        element, _, length = kind[:-1].rpartition("[")
        if not isinstance(value, list) or (length and len(value) != int(length)):
            raise UnfitError(f"{kind} got {value!r:.60}")
        return [_field(one, element) for one in value]
    if kind in TIMES:
        if not isinstance(value, dict) or set(value) != {"secs", "nsecs"}:
            raise UnfitError(f"{kind} has secs and nsecs, got {value!r:.60}")
        return TIMES[kind](value["secs"], value["nsecs"])
    if kind in FLOATS:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise UnfitError(f"{kind} got {value!r:.60}")
        return float(value)
    return _message(value, message_class(kind)) if "/" in kind else value


def _plain(value: Any, kind: str) -> Any:
    if kind.endswith("]"):
        return [_plain(one, kind[:-1].rpartition("[")[0]) for one in value]
    if kind in TIMES:
        return {"secs": value.secs, "nsecs": value.nsecs}
    if kind in FLOATS:
        return value if math.isfinite(value) else None
    return as_json(value) if "/" in kind else value
