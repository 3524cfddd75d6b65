"""The world under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "World": "irsim.object_base",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
