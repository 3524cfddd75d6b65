"""``Contact2D`` under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(__name__, {"Contact2D": "irsim.contacts"})


def __getattr__(name: str) -> Any:
    return _get(name)
