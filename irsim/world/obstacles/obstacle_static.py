"""``ObjectStatic``, which IR-SIM has deprecated, under its name there."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(__name__, {"ObjectStatic": "irsim.object_base"})


def __getattr__(name: str) -> Any:
    return _get(name)
