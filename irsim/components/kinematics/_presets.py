"""Named sets of parameters of drives, each number with its source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from irsim.options.presets import with_preset

__all__ = ["SKID_STEER", "SURFACES", "VEHICLES", "Preset", "Surface", "filled"]

Surface = Literal["floor", "asphalt", "grass", "gravel", "sand"]
"""Names of grounds for skid steering."""


@dataclass(frozen=True)
class Preset:
    """Parameters of a drive.

    Attributes:
        values: Key -> number.
        source: Where the numbers are from.
        unverified: Whether they are assumptions, not measurements.
    """

    values: Mapping[str, float]
    source: str
    unverified: bool = False


def filled(data: Any, key: str, usual: str, presets: Mapping[str, Preset]) -> Any:
    """The keys of a drive; keys that are missing or null have the values of its preset."""
    return with_preset(data, key, presets, lambda preset: preset.values, usual=usual, nulls=True)


def _tracks(track: float, spread: float) -> dict[str, float]:
    half = round(track * spread / 2, 4)
    return {"believed_track": 2 * half, "icr_left": half, "icr_right": -half, "track": track}


SKID_STEER = {
    "p3at": Preset(
        _tracks(0.40, 1.4662),
        "Pioneer 3-AT, 0.40 m wide, turns on the spot as if its tracks were 1.4662 times as far apart: Wang et al., "
        "Sensors 15 (2015) 9681, tables 1 and 3; read 2026-11-30",
    ),
    "jackal": Preset(
        _tracks(0.37559, 1.5),
        "Clearpath Jackal, wheels 0.37559 m apart and wheel_separation_multiplier 1.5: "
        "jackal_control/config/control.yaml of its maker; read 2026-11-30",
    ),
    "husky": Preset(
        _tracks(0.5708, 1.875),
        "Clearpath Husky, wheels 0.5708 m apart and wheel_separation_multiplier 1.875: "
        "husky_control/config/control.yaml of its maker; read 2026-11-30",
    ),
}


_ASSUMED = "assumed, not measured: published tracks as they turn are 1.3 to 2 times the distance of both sides"


def _ground(spread: float, traction: float, source: str = _ASSUMED) -> Preset:
    return Preset({"spread": spread, "traction": traction}, source, unverified=source == _ASSUMED)


SURFACES = {
    "floor": _ground(1.4662, 1.0, "Pioneer 3-AT on the floor of a laboratory: Wang et al., Sensors 15 (2015) 9681, "
                     "tables 1 and 3; read 2026-11-30"),
    "asphalt": _ground(1.6, 1.0),
    "grass": _ground(1.8, 0.95),
    "gravel": _ground(1.5, 0.93),
    "sand": _ground(1.9, 0.85),
}  # fmt: skip
"""Grounds for skid steering: `spread` is the distance of both ICRs over the distance of the sides, `traction` the speed
over ground per speed of a side."""


def _car(
    limits: tuple[float, float, float, float, float, float],
    body: tuple[float, float, float, float, float],
    tyres: tuple[float, float],
) -> dict[str, float]:
    psi_max, steer_rate, acce_max, speed_switch, speed_min, speed_max = limits
    mass, inertia, front, rear, height = body
    return {
        "psi_max": psi_max,
        "steer_rate": steer_rate,
        "acce_max": acce_max,
        "speed_switch": speed_switch,
        "speed_min": speed_min,
        "speed_max": speed_max,
        "mass": mass,
        "inertia": inertia,
        "front": front,
        "rear": rear,
        "height": height,
        "friction": 1.0489,
        "stiffness_front": tyres[0],
        "stiffness_rear": tyres[1],
    }


_COMMONROAD = "vehicle {} of CommonRoad: package commonroad-vehicle-models 3.0.2; read 2026-11-30"
_TYRE = 20.898083706740398
"""Stiffness of CommonRoad's tyres: 21.92 / 1.0489 [1/rad]."""

VEHICLES = {
    "ford_escort": Preset(
        _car(
            (0.91, 0.4, 11.5, 4.755, -13.9, 45.8),
            (1225.8878467253344, 1538.8533713561394, 0.88392, 1.50876, 0.59436),
            (_TYRE, _TYRE),
        ),
        "Ford Escort, " + _COMMONROAD.format(1),
    ),
    "bmw_320i": Preset(
        _car(
            (1.066, 0.4, 11.5, 7.319, -13.9, 50.8),
            (1093.2952334674046, 1791.5995300122856, 1.1561957064, 1.4227170936, 0.61373004),
            (_TYRE, _TYRE),
        ),
        "BMW 320i, " + _COMMONROAD.format(2),
    ),
    "vw_vanagon": Preset(
        _car(
            (1.023, 0.4, 11.5, 7.824, -11.2, 41.7),
            (1478.8979637767998, 2473.1176915564442, 1.1507916024, 1.3211363976, 0.804490644),
            (_TYRE, _TYRE),
        ),
        "VW Vanagon, " + _COMMONROAD.format(3),
    ),
    "f1tenth": Preset(
        _car((0.4189, 3.2, 9.51, 7.319, -5.0, 20.0), (3.74, 0.04712, 0.15875, 0.17145, 0.074), (4.718, 5.4562)),
        "F1TENTH racing car: gym/f110_gym/envs/f110_env.py of f1tenth_gym; read 2026-11-30",
    ),
}
