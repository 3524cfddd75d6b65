"""The configuration of an environment under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "EnvConfig": "irsim.object_factory",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
