"""Range sensors that one can buy: the values of the key ``device`` of lidars and of sensors of one cone.

Each number has a source. A number that was not compared with its source yet is unverified: it is common knowledge, and
the data sheet was not opened. A tolerance of the maker (plus or minus) is taken for two standard deviations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from irsim.options.presets import with_preset

__all__ = ["DEPTH_CAMERAS", "DEVICES", "INFRARED", "SONARS", "Device", "DeviceName", "Source", "with_card"]

DeviceName = Literal[
    "rplidar_a1", "rplidar_a2", "rplidar_s2", "ust_10lx", "urg_04lx", "tim561", "lms1xx", "lms2xx", "lms5xx", "lds_01",
    "lds_02", "mid_360",
]  # fmt: skip


@dataclass(frozen=True)
class Source:
    """Where numbers come from.

    Attributes:
        text: Document, and what it says.
        read: Time at which it was opened; None if it was not, which makes its numbers unverified.
    """

    text: str
    read: str | None = None


@dataclass(frozen=True)
class Device:
    """A sensor: keys of a scenario, and the source of each.

    Attributes:
        title: Maker and type.
        keys: Keys of the sensor; a key of ``realism`` is written ``realism.KEY``.
        sources: Key -> source of its number.
    """

    title: str
    keys: Mapping[str, Any]
    sources: Mapping[str, Source]

    @property
    def unverified(self) -> list[str]:
        """Keys whose numbers were not compared with their source, in the order of ``keys``."""
        return [key for key in self.keys if self.sources[key].read is None]

    def options(self) -> dict[str, Any]:
        """The keys as a mapping of a scenario, with ``realism`` as a mapping of its own."""
        plain = {key: value for key, value in self.keys.items() if not key.startswith("realism.")}
        nested = {key.partition(".")[2]: value for key, value in self.keys.items() if key.startswith("realism.")}
        return {**plain, "realism": nested} if nested else plain


def with_card(given: Any, cards: Mapping[str, Device]) -> Any:
    """Return the keys of a sensor and of the card that its ``device`` names; keys beside it win."""
    full = with_preset(given, "device", cards, Device.options)
    if full is given or not isinstance(full.get("realism"), Mapping):
        return full
    return {**full, "realism": {**cards[full["device"]].options().get("realism", {}), **full["realism"]}}


def _device(title: str, *parts: tuple[Source, dict[str, Any]]) -> Device:
    """A device from its sources, each with the keys that it tells."""
    keys = {key: value for _, told in parts for key, value in told.items()}
    return Device(title, keys, {key: source for source, told in parts for key in told})


def _turn(beams: int) -> dict[str, Any]:
    return {"angle_range": 6.28318, "number": beams, "endpoint": False}


def _sector(degrees: float, beams: int) -> dict[str, Any]:
    return {"angle_range": round(math.radians(degrees), 5), "number": beams, "endpoint": True}


_NOTED = "before December 2026"
_SICK = Source("SICK knowledge base, Measurement Errors LMSxxx (typical values)", "2026-11-30")

DEVICES: Mapping[str, Device] = {
    "rplidar_a1": _device(
        "Slamtec RPLIDAR A1M8",
        (
            Source("Slamtec data sheet of A1M8: 0.15 to 12 m on white, 1 degree at 5.5 Hz", _NOTED),
            {"range_min": 0.15, "range_max": 12.0, **_turn(360), "scan_time": 0.18182},
        ),
        (
            Source("Slamtec data sheet of A1M8: below 1 % of the distance, 0.5 mm at 1.5 m (grows with its square)",
                   _NOTED),
            {"realism.std_per_meter": 0.005, "realism.resolution_growth": 0.00022},
        ),
    ),
    "rplidar_a2": _device(
        "Slamtec RPLIDAR A2M8",
        (
            Source("Slamtec data sheet of A2M8: 12 m, 0.45 degrees at 10 Hz, 1 % of the distance", _NOTED),
            {"range_max": 12.0, **_turn(800), "scan_time": 0.1, "realism.std_per_meter": 0.005},
        ),
        (Source("Slamtec data sheet of A2M8: smallest range"), {"range_min": 0.15}),
    ),
    "rplidar_s2": _device(
        "Slamtec RPLIDAR S2",
        (
            Source("Slamtec data sheet of S2: 0.05 to 30 m on white, 10 m at 10 %, 0.12 degrees at 10 Hz, 30 mm"),
            {"range_min": 0.05, "range_max": 30.0, **_turn(3000), "scan_time": 0.1, "noise": True, "std": 0.015,
             "realism.range_dark": 10.0},
        ),
    ),
    "ust_10lx": _device(
        "Hokuyo UST-10LX",
        (
            Source("Clearpath data sheet of UST-10LX: 270 degrees, 0.25 degrees", _NOTED),
            _sector(270.0, 1081),
        ),
        (
            Source("Hokuyo specification of UST-10LX: 0.06 to 10 m, 4 m at 10 %, 25 ms, 40 mm, below 30 mm"),
            {"range_min": 0.06, "range_max": 10.0, "scan_time": 0.025, "noise": True, "std": 0.03,
             "realism.range_dark": 4.0, "realism.bias_std": 0.02},
        ),
    ),
    "urg_04lx": _device(
        "Hokuyo URG-04LX",
        (
            Source("Hokuyo SCIP 2.0 specification C-42-03320B, answer to PP: 20 to 5600 mm, steps 44 to 725 of 1024, "
                   "600 turns per minute", "2026-11-30"),
            {"range_min": 0.02, "range_max": 5.6, **_sector(681 * 360 / 1024, 682), "scan_time": 0.1},
        ),
        (
            Source("Hokuyo specification of URG-04LX: 10 mm up to 1 m, 1 % of the distance beyond"),
            {"noise": True, "std": 0.005, "realism.std_per_meter": 0.005, "realism.resolution": 0.001},
        ),
    ),
    "tim561": _device(
        "SICK TiM561",
        (
            Source("SICK knowledge base, TiM5xx: systematic error 60 mm, statistical error 20 mm (1 sigma)",
                   _NOTED),
            {"noise": True, "std": 0.02, "realism.bias_std": 0.03},
        ),
        (
            Source("SICK data sheet of TiM561: 0.05 to 10 m, 8 m at 10 %, 270 degrees, 0.33 degrees, 15 Hz"),
            {"range_min": 0.05, "range_max": 10.0, **_sector(270.0, 811), "scan_time": 0.06667,
             "realism.range_dark": 8.0},
        ),
    ),
    "lms1xx": _device(
        "SICK LMS1xx",
        (_SICK, {"noise": True, "std": 0.012, "realism.bias_std": 0.015}),
        (
            Source("SICK data sheet of LMS111: 0.5 to 20 m, 18 m at 10 %, 270 degrees, 0.5 degrees at 50 Hz"),
            {"range_min": 0.5, "range_max": 20.0, **_sector(270.0, 541), "scan_time": 0.02,
             "realism.range_dark": 18.0},
        ),
    ),
    "lms2xx": _device(
        "SICK LMS2xx, as LMS291",
        (
            Source("SICK technical description of LMS200/211/221/291: 180 degrees, 0.5 degrees, 26.7 ms, 80 m, 30 m at "
                   "10 %, systematic error 35 mm, statistical error 10 mm (1 sigma)"),
            {"range_min": 0.0, "range_max": 80.0, **_sector(180.0, 361), "scan_time": 0.02667, "noise": True,
             "std": 0.01, "realism.bias_std": 0.0175, "realism.range_dark": 30.0},
        ),
        (
            Source("the log csail.bag of an LMS at MIT CSAIL: all ranges are multiples of 10 mm", "2026-12-01"),
            {"realism.resolution": 0.01},
        ),
    ),
    "lms5xx": _device(
        "SICK LMS5xx",
        (_SICK, {"noise": True, "std": 0.006, "realism.std_per_meter": 0.0004, "realism.bias_std": 0.0125}),
        (
            Source("SICK operating instructions of LMS5xx: 190 degrees, 0.5 degrees, 50 Hz", "2026-11-30"),
            {**_sector(190.0, 381), "scan_time": 0.02},
        ),
        (
            Source("SICK data sheet of LMS511: 0.7 to 80 m, 40 m at 10 %, beam of 4.7 mrad"),
            {"range_min": 0.7, "range_max": 80.0, "realism.range_dark": 40.0, "realism.divergence": 0.0047},
        ),
    ),
    "lds_01": _device(
        "Robotis LDS-01",
        (
            Source("Robotis e-Manual of LDS-01: 0.12 to 3.5 m, 1 degree, 5 Hz, 15 mm below 0.5 m and 5 % above, "
                   "10 mm and 3.5 %"),
            {"range_min": 0.12, "range_max": 3.5, **_turn(360), "scan_time": 0.2, "noise": True, "std": 0.01,
             "realism.std_per_meter": 0.0175, "realism.scale_std": 0.025},
        ),
    ),
    "lds_02": _device(
        "Robotis LDS-02",
        (
            Source("Robotis e-Manual of LDS-02: 0.16 to 8 m, 1 degree, 5 Hz, 10 mm below 0.3 m and 3 % up to 6 m",
                   "2026-11-30"),
            {"range_min": 0.16, "range_max": 8.0, **_turn(360), "scan_time": 0.2, "noise": True, "std": 0.005,
             "realism.std_per_meter": 0.015},
        ),
    ),
    "mid_360": _device(
        "Livox Mid-360, as a planar scan",
        (
            Source("Livox user manual of Mid-360: 0.1 to 70 m at 80 %, 40 m at 10 %, 10 Hz, 20 mm, 0.15 degrees"),
            {"range_min": 0.1, "range_max": 70.0, **_turn(720), "scan_time": 0.1, "noise": True, "std": 0.02,
             "angle_std": 0.0026, "realism.range_dark": 40.0},
        ),
    ),
}  # fmt: skip
"""Name of a lidar -> its card."""

DEPTH_CAMERAS: Mapping[str, Device] = {
    "d435": _device(
        "Intel RealSense D435, one row of it",
        (
            Source(
                "Intel data sheet of D400: base of 50 mm, 848 columns over 87 degrees, 0.28 m, error of 0.08 pixels"
            ),
            {**_sector(87.0, 848), "range_max": 10.0, "depth_min": 0.28, "depth_growth": 0.0025},
        ),
    ),
    "kinect_v1": _device(
        "Microsoft Kinect for Xbox 360, one row of it",
        (
            Source("Nguyen, Izadi, Lovell: Modeling Kinect Sensor Noise (2012): 0.0012 + 0.0019 (z - 0.4)^2"),
            {"depth_std": 0.0012, "depth_growth": 0.0019, "depth_from": 0.4},
        ),
        (
            Source("Microsoft Kinect SDK: 640 columns over 57 degrees, 0.8 to 4 m"),
            {**_sector(57.0, 640), "range_max": 4.0, "depth_min": 0.8},
        ),
    ),
}
"""Name of a depth camera -> its card."""

SONARS: Mapping[str, Device] = {
    "hc_sr04": _device(
        "HC-SR04",
        (
            Source("Data sheet of HC-SR04: 0.02 to 4 m, measuring angle of 15 degrees, accuracy of 3 mm"),
            {"range_min": 0.02, "range_max": 4.0, "cone": 0.2618, "std": 0.0015},
        ),
        (Source("Common experience with HC-SR04: no echo beyond 25 to 30 degrees"), {"incidence_max": 0.48}),
    ),
}
"""Name of a sonar -> its card."""

INFRARED: Mapping[str, Device] = {
    "gp2y0a21": _device(
        "Sharp GP2Y0A21YK0F",
        (
            Source("Sharp data sheet of GP2Y0A21YK0F: 0.1 to 0.8 m; its voltage falls again below that"),
            {"range_min": 0.1, "range_max": 0.8, "folds": True},
        ),
    ),
    "vl53l0x": _device(
        "ST VL53L0X",
        (
            Source("ST data sheet of VL53L0X, DocID029104 Rev 1: absolute range up to 2 m", "2026-11-30"),
            {"range_max": 2.0},
        ),
        (
            Source("ST data sheet of VL53L0X: field of view of 25 degrees; time of flight, which does not fold"),
            {"range_min": 0.0, "cone": 0.4363, "folds": False},
        ),
    ),
}
"""Name of an infrared range sensor -> its card."""
