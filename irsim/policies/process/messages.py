"""Messages between irsim and a policy in another process: one JSON object per line.

irsim asks and the policy answers each line with one line. Arrays are nested lists with one row per robot; a number that
is not finite, such as a goal that is missing or a limit that does not exist, is null.

| irsim sends | the policy answers |
|---|---|
| `hello`: `protocol`, `version` | `policy`: `output`, and `name`, `needs`, `drives`, `decision_dt`, `stochastic` |
| `reset`: the fields of :class:`irsim.policies.Episode`, and `seed` | `ready` |
| `act`: the fields of :class:`irsim.policies.Observations` | `decision`: `decision`, one row for each robot |
"""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

import numpy as np

from irsim.common.installed import version
from irsim.common.records import ContentError, read_json
from irsim.common.text import clean
from irsim.options.registry import KINEMATICS
from irsim.policies.observations import Neighbors, Observations
from irsim.policies.policy import Episode, Needs
from irsim.policies.process.channel import PeerError

__all__ = ["FIX", "PROTOCOL", "act", "answer", "declaration", "hello", "reset"]

PROTOCOL = 1
"""Version of the messages."""
FIX = "irsim describe process says what it must answer"
"""Advice about an answer that is not understood."""
_MAX_SHOWN = 80
"""Characters of an answer that an error shows."""
_DECLARED = ("name", "output", "needs", "drives", "decision_dt", "stochastic")
"""Keys of a declaration; :class:`irsim.policies.Policy` has the meaning of each."""


def hello() -> bytes:
    """The first line."""
    return _line({"type": "hello", "protocol": PROTOCOL, "version": version()})


def reset(episode: Episode, seed: int) -> bytes:
    """The line that begins an episode in one world; ``seed`` is for what the policy draws in it."""
    told = {field.name: getattr(episode, field.name) for field in fields(episode)}
    told |= {"robots": list(episode.robots), "footprints": [outline.tolist() for outline in episode.footprints]}
    return _line({"type": "reset", **told, "seed": seed})


def act(observations: Observations) -> bytes:
    """The line that asks for a decision."""
    return _line({"type": "act", **_plain(observations)})


def answer(line: bytes, kind: str) -> dict[str, Any]:
    """The object of a line.

    Raises:
        PeerError: It is not a JSON object of that type.
    """
    try:
        data = read_json(line, finite=False)
    except ContentError:
        raise _misunderstood(f"answered {_shown(line)}, which is not a line of JSON") from None
    if not isinstance(data, dict) or data.get("type") != kind:
        raise _misunderstood(f"answered {_shown(line)} where an object with type {kind!r} is expected")
    return data


def declaration(data: dict[str, Any]) -> dict[str, Any]:
    """The declaration of a policy, as attributes of a policy.

    Raises:
        PeerError: It says something else, or another version of the messages.
    """
    if data.get("protocol", PROTOCOL) != PROTOCOL:
        raise _misunderstood(f"speaks protocol {clean(str(data['protocol']), _MAX_SHOWN)}, and irsim speaks {PROTOCOL}")
    unknown = sorted({*data} - {*_DECLARED, "type", "protocol"})
    if unknown:
        raise _misunderstood(f"declares {clean(unknown[0], _MAX_SHOWN)!r}; it can declare {', '.join(_DECLARED)}")
    said = {key: data[key] for key in _DECLARED if data.get(key) is not None}
    if not isinstance(said.get("name", ""), str) or not isinstance(said.get("stochastic", True), bool):
        raise _misunderstood("declares a name that is not text, or a stochastic that is neither true nor false")
    if "drives" in said:
        if not (isinstance(said["drives"], list) and all(isinstance(name, str) for name in said["drives"])):
            raise _misunderstood("declares drives that are not a list of names")
        if unknown := sorted({*said["drives"]} - {*KINEMATICS.names()}):
            known = ", ".join(KINEMATICS.names())
            raise _misunderstood(f"declares the drive {clean(unknown[0], _MAX_SHOWN)!r}; drives are {known}")
        said["drives"] = frozenset(said["drives"])
    if "needs" in said:
        said["needs"] = _needs(said["needs"])
    return said


def _misunderstood(why: str) -> PeerError:
    return PeerError(why, FIX)


def _needs(given: Any) -> Needs:
    known = [field.name for field in fields(Needs)]
    if not isinstance(given, dict) or not {*given} <= {*known}:
        raise _misunderstood(f"declares needs other than {', '.join(known)}")
    for key in ("static_neighbors", "neighbor_extents", "footprints", "scan", "map"):
        if not isinstance(given.get(key, False), bool):
            raise _misunderstood(f"declares needs whose {key!r} is neither true nor false")
    return Needs(**{key: value for key, value in given.items() if value is not None})


def _plain(thing: Any) -> Any:
    """Arrays as lists, and dataclasses as objects."""
    if isinstance(thing, np.ndarray):
        if thing.dtype.kind == "f" and not np.isfinite(thing).all():
            told = thing.astype(object)
            told[~np.isfinite(thing)] = None
            return told.tolist()
        return thing.tolist()
    if isinstance(thing, Neighbors):
        names = ["position", "heading", *(field.name for field in fields(thing) if field.name != "pose")]
        return {name: _plain(getattr(thing, name)) for name in names}
    if hasattr(thing, "__dataclass_fields__"):
        return {field.name: _plain(getattr(thing, field.name)) for field in fields(thing)}
    if isinstance(thing, tuple):  # the maps: rows of one world share theirs
        numbers: dict[int, int] = {}
        rows = [numbers.setdefault(id(one), len(numbers)) for one in thing]
        distinct = {id(one): one for one in thing}
        maps = [
            {"occupied": one.occupied.astype(int).tolist(), "origin": list(one.origin), "resolution": one.resolution}
            for one in distinct.values()
        ]
        return {"distinct": maps, "of_row": rows}
    return None if isinstance(thing, float) and not math.isfinite(thing) else thing


def _line(data: dict[str, Any]) -> bytes:
    return json.dumps(data, separators=(",", ":"), allow_nan=False).encode()


def _shown(line: bytes) -> str:
    text = clean(line.decode("utf-8", "replace").strip(), _MAX_SHOWN)
    return repr(text) if text else "an empty line"
