"""Messages of sensors without beams: inertial units, wheel odometry, satellite navigation, rangers, localization."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from irsim.bridges.ros.geodesy import geodetic
from irsim.bridges.ros.messages import Messages
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.simulation.scene import Gauge

__all__ = ["Instruments"]

GRAVITY = 9.80665
"""The number that an accelerometer at rest reports along its z axis [m/s^2] (REP 145)."""
_NO_FIX, _FIX, _GROUND_FIX = -1, 0, 2
"""Values of ``sensor_msgs/NavSatStatus``."""
_UNKNOWN, _APPROXIMATED = 0, 1
"""Types of the covariance of ``sensor_msgs/NavSatFix``."""
_GPS = 1
_ULTRASOUND, _INFRARED = 0, 1
Reading = Mapping[str, float]


@dataclass
class _Way:
    """How uncertain the pose of wheel odometry has become.

    Attributes:
        stamp: Time of the last message [ns].
        pose: x, y, heading of it.
        covariance: (3, 3) of x, y, heading.
        step: (3, 3) of what the last motion has added, of distance ahead, aside and turn.
        period: Time since the message before [s].
    """

    stamp: int
    pose: tuple[float, float, float]
    covariance: Floats
    step: Floats
    period: float = 1.0


class Instruments:
    """Makes the messages of sensors without beams. Covariances are as the options of a sensor say.

    Args:
        messages: Makes the parts of messages.
        frame: The fixed frame, in which irsim's coordinates are.
        step_time: Period of the simulation [s].
    """

    def __init__(self, messages: Messages, frame: str, step_time: float) -> None:
        self._make, self._frame, self._step_time = messages, frame, step_time
        self._ways: dict[str, _Way] = {}
        self._makers: Mapping[str, Callable[[Gauge, Reading, int, str, str], Any]] = {
            "imu": self._imu,
            "odometry": self._odometry,
            "gnss": self._fix,
            "sonar": self._range,
            "ir_range": self._range,
            "localization": self._pose,
        }

    def message(self, gauge: Gauge, reading: Any, stamp: int, own: str, body: str) -> Any | None:
        """The message of a reading.

        Args:
            gauge: The sensor.
            reading: Its numbers by name; a row of :attr:`irsim.simulation.trace.Trace.readings`.
            stamp: Time of the reading [ns].
            own: Frame of the sensor.
            body: Frame of its robot.

        Returns:
            None of a sensor that no message is for.
        """
        maker = self._makers.get(gauge.name)
        return None if maker is None else maker(gauge, reading, stamp, own, body)

    def _imu(self, gauge: Gauge, reading: Reading, stamp: int, own: str, body: str) -> Any:
        make, settings = self._make, gauge.settings
        period = max(self._step_time, 1 / settings["rate"] if settings["rate"] else 0.0)
        turn, push = (
            float(settings[f"{kind}_noise"]) ** 2 / period
            + float(settings[f"{kind}_bias_std"]) ** 2
            + float(settings[f"{kind}_drift_std"]) ** 2
            + float(settings[f"{kind}_resolution"]) ** 2 / 12
            for kind in ("gyro", "accel")
        )
        unknown = np.zeros(9)
        unknown[0] = -1
        return make("sensor_msgs", "Imu")(
            make.header(stamp, own),
            make.quaternion(0.0, 0.0, 0.0, 1.0),
            unknown,
            make.vector(0.0, 0.0, float(reading["yaw_rate"])),
            np.diag([turn] * 3).ravel(),
            make.vector(float(reading["ax"]), float(reading["ay"]), GRAVITY),
            np.diag([push] * 3).ravel(),
        )

    def _odometry(self, gauge: Gauge, reading: Reading, stamp: int, own: str, body: str) -> Any:
        make, pose = self._make, (float(reading["x"]), float(reading["y"]), float(reading["theta"]))
        velocity = [float(reading[name]) for name in ("vx", "vy", "yaw_rate")]
        way = self._ways[gauge.key] = _went_on(self._ways.get(gauge.key), gauge.settings, stamp, pose)
        twist = way.step / way.period**2
        return make.odometry(stamp, self._frame, body, pose, velocity, planar(way.covariance), planar(twist))

    def _fix(self, gauge: Gauge, reading: Reading, stamp: int, own: str, body: str) -> Any:
        make, quality = self._make, float(reading["quality"])
        fixed = quality >= 1
        origin = gauge.settings["origin"]
        place = geodetic(float(reading["x"]), float(reading["y"]), origin) if fixed else (math.nan,) * 3
        status = _NO_FIX if not fixed else _GROUND_FIX if quality >= 2 else _FIX
        variance = float(reading["std"]) ** 2 if fixed else 0.0
        return make("sensor_msgs", "NavSatFix")(
            make.header(stamp, own),
            make("sensor_msgs", "NavSatStatus")(status, _GPS),
            *place,
            np.diag([variance] * 3).ravel(),
            _APPROXIMATED if fixed else _UNKNOWN,
        )

    def _range(self, gauge: Gauge, reading: Reading, stamp: int, own: str, body: str) -> Any:
        settings, distance = gauge.settings, float(reading["range"])
        low, high = float(settings["range_min"]), float(settings["range_max"])
        kind = self._make("sensor_msgs", "Range")
        std = math.hypot(float(settings["std"]), float(settings["std_per_meter"]) * distance)
        if not reading["valid"]:  # REP 117
            distance = -math.inf if distance <= low else math.inf
        radiation = _ULTRASOUND if gauge.name == "sonar" else _INFRARED
        newer = {"variance": std * std} if any(field.name == "variance" for field in fields(kind)) else {}
        header = self._make.header(stamp, own)
        return kind(header, radiation, float(reading["field_of_view"]), low, high, distance, **newer)

    def _pose(self, gauge: Gauge, reading: Reading, stamp: int, own: str, body: str) -> Any:
        make, settings = self._make, gauge.settings
        across, turn = float(settings["position_std"]) ** 2, float(settings["heading_std"]) ** 2
        pose = make.pose(float(reading["x"]), float(reading["y"]), float(reading["theta"]))
        sure = make("geometry_msgs", "PoseWithCovariance")(pose, planar(np.diag([across, across, turn])))
        return make("geometry_msgs", "PoseWithCovarianceStamped")(make.header(stamp, self._frame), sure)


def planar(covariance: Floats) -> Floats:
    """(36,) covariance of x, y, z and turns about these axes, from the (3, 3) one of x, y and the turn about z."""
    whole = np.zeros((6, 6))
    whole[np.ix_([0, 1, 5], [0, 1, 5])] = covariance
    return whole.ravel()


def _went_on(before: _Way | None, settings: Mapping[str, Any], stamp: int, pose: tuple[float, float, float]) -> _Way:
    """How uncertain odometry is after a motion, by the random errors in its options; a new episode begins anew."""
    if before is None or stamp <= before.stamp:
        return _Way(stamp, pose, np.zeros((3, 3)), np.zeros((3, 3)))
    period = (stamp - before.stamp) / 1e9
    dx, dy, turn = pose[0] - before.pose[0], pose[1] - before.pose[1], float(wrap(pose[2] - before.pose[2]))
    distance, heading = math.hypot(dx, dy), before.pose[2] + turn / 2
    ahead = float(settings["distance_noise"]) ** 2 * distance
    turned = float(settings["heading_noise"]) ** 2 * distance + float(settings["turning_noise"]) ** 2 * abs(turn)
    moves = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
    along = np.array([math.cos(heading), math.sin(heading), 0.0])
    added = ahead * np.outer(along, along) + np.diag([0.0, 0.0, turned])
    return _Way(stamp, pose, moves @ before.covariance @ moves.T + added, np.diag([ahead, 0.0, turned]), period)
