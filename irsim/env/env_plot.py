"""The picture of an environment under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "EnvPlot": "irsim.render.plot",
        "draw_patch": "irsim.render.patches",
        "geometry_to_path": "irsim.render.patches",
        "linewidth_from_data_units": "irsim.render.patches",
        "set_patch_property": "irsim.render.patches",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
