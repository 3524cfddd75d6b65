"""The world with an extent along z under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "World3D": "irsim.env.env_base3d",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
