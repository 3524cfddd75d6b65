"""Classes of robots that IR-SIM has deprecated."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "RobotAcker": "irsim.object_base",
        "RobotDiff": "irsim.object_base",
        "RobotOmni": "irsim.object_base",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
