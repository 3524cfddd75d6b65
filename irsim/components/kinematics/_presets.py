"""Named sets of parameters of drives, each number with its source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["SKID_STEER", "Preset", "filled"]


@dataclass(frozen=True)
class Preset:
    """Parameters of a drive.

    Attributes:
        values: Key -> number.
        source: Where the numbers are from.
    """

    values: Mapping[str, float]
    source: str


def filled(data: Any, key: str, usual: str, presets: Mapping[str, Preset]) -> Any:
    """The keys of a drive; the preset that it names fills in keys that are missing or null.

    Args:
        data: The mapping as given.
        key: Key with the name of the preset.
        usual: Name of the preset if the mapping names no other.
        presets: The presets by name.
    """
    if not isinstance(data, Mapping):
        return data
    name = data.get(key, usual)
    if not isinstance(name, str) or name not in presets:
        return data
    return {**data, **{k: v for k, v in presets[name].values.items() if data.get(k) is None}}


def _tracks(apart: float) -> dict[str, float]:
    half = round(apart / 2, 4)
    return {"believed_track": 2 * half, "icr_left": half, "icr_right": -half}


SKID_STEER = {
    "p3at": Preset(
        _tracks(0.40 * 1.4662),
        "Pioneer 3-AT, 0.40 m wide, turns on the spot as if its tracks were 1.4662 times as far apart: Wang et al., "
        "Sensors 15 (2015) 9681, tables 1 and 3; read 2026-11-30",
    ),
    "jackal": Preset(
        _tracks(0.37559 * 1.5),
        "Clearpath Jackal, wheels 0.37559 m apart and wheel_separation_multiplier 1.5: "
        "jackal_control/config/control.yaml of its maker; read 2026-11-30",
    ),
    "husky": Preset(
        _tracks(0.5708 * 1.875),
        "Clearpath Husky, wheels 0.5708 m apart and wheel_separation_multiplier 1.875: "
        "husky_control/config/control.yaml of its maker; read 2026-11-30",
    ),
}
