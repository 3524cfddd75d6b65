"""``imu``: yaw rate and acceleration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.presets import with_preset
from irsim.options.registry import SENSORS
from irsim.options.units import MetersPerSecondSquared, Number, Radians, RadiansPerSecond, Seconds
from irsim.options.vectors import Offset

Scale = Annotated[Number, Field(ge=0, le=0.2)]
Rate = Annotated[RadiansPerSecond, Field(ge=0)]
Push = Annotated[MetersPerSecondSquared, Field(ge=0)]

DEVICES: Mapping[str, Mapping[str, float]] = {
    "adis16448": {
        "gyro_noise": 3.394e-4, "gyro_bias_std": 0.0087, "gyro_drift_std": 8.67e-4, "gyro_drift_time": 1000.0,
        "accel_noise": 0.004, "accel_bias_std": 0.196, "accel_drift_std": 0.0735, "accel_drift_time": 300.0,
    },
    "mpu6050": {"gyro_noise": 8.7e-5, "gyro_bias_std": 0.349, "accel_noise": 0.0039, "accel_bias_std": 0.49},
    "bmi088": {"gyro_noise": 2.4e-4, "gyro_bias_std": 0.0175, "accel_noise": 0.00172, "accel_bias_std": 0.196},
    "vn100": {"gyro_noise": 6.1e-5, "accel_noise": 1.37e-3},
}  # fmt: skip
"""Device -> keys: ADIS16448 as in rotors_simulator, whose random walk of density s and time t has the standard
deviation s * sqrt(t / 2) in the long run; MPU-6050 and BMI088 by their data sheets (biases were not compared with
them); VN-100 as in a calibration file of kalibr."""


class Imu(GaugeOptions):
    """Inertial measurement unit: yaw rate, and acceleration ahead and aside in the frame of the sensor.

    Noise is a density, so it does not depend on the step. The bias of a device that was switched on (`…_bias_std`,
    drawn once per episode) and its wandering (`…_drift_std`) are two errors. Accelerations are means over two steps,
    and with a `rate` all readings are means since the last one.
    """

    locates: ClassVar[bool] = True
    reports: ClassVar[tuple[str, ...]] = ("yaw_rate", "ax", "ay")
    report_units: ClassVar[tuple[str, ...]] = ("rad/s", "m/s^2", "m/s^2")
    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "imu", "device": "adis16448"}]}

    name: Literal["imu"] = "imu"
    device: Literal["adis16448", "mpu6050", "bmi088", "vn100"] | None = None
    """A device that one can buy: noise and biases of its card; keys beside it win."""
    offset: Offset = [0.0, 0.0, 0.0]
    """Mounting pose in the body frame: [x, y, theta]; away from the middle it feels turns as accelerations."""
    gyro_noise: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "rad/s/sqrt(Hz)"})] = 0.0
    """Density of the noise of the yaw rate; a reading over t seconds (a step, or 1 / `rate`) has this over sqrt(t)."""
    gyro_bias_std: Rate = 0.0
    """Standard deviation of an offset of the yaw rate that is drawn once per episode."""
    gyro_drift_std: Rate = 0.0
    """Standard deviation, in the long run, of an offset that wanders."""
    gyro_drift_time: Annotated[Seconds, Field(gt=0)] = 1000.0
    """Time in which the wandering offset forgets itself (to 1/e)."""
    gyro_scale_std: Scale = 0.0
    """Standard deviation of a relative error that is drawn once per episode."""
    gyro_resolution: Rate = 0.0
    """Yaw rates are multiples of this; 0 does not round."""
    gyro_range: Annotated[RadiansPerSecond, Field(gt=0)] | None = None
    """Largest yaw rate that it reports; null is unlimited."""
    accel_noise: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "m/s^2/sqrt(Hz)"})] = 0.0
    """Density of the noise of accelerations."""
    accel_bias_std: Push = 0.0
    """Standard deviation of offsets of both accelerations that are drawn once per episode."""
    accel_drift_std: Push = 0.0
    """Standard deviation, in the long run, of offsets that wander."""
    accel_drift_time: Annotated[Seconds, Field(gt=0)] = 300.0
    """Time in which the wandering offsets forget themselves (to 1/e)."""
    accel_scale_std: Scale = 0.0
    """Standard deviation of relative errors that are drawn once per episode."""
    accel_resolution: Push = 0.0
    """Accelerations are multiples of this; 0 does not round."""
    accel_range: Annotated[MetersPerSecondSquared, Field(gt=0)] | None = None
    """Largest acceleration that it reports; null is unlimited."""
    misalignment_std: Annotated[Radians, Field(ge=0, le=0.5)] = 0.0
    """Standard deviation of a turn of its axes that is drawn once per episode."""
    tilt_std: Annotated[Radians, Field(ge=0, le=0.5)] = 0.0
    """Standard deviation of its tilts, drawn once per episode: gravity leaks into accelerations."""

    @model_validator(mode="before")
    @classmethod
    def _take_device(cls, given: Any) -> Any:
        return with_preset(given, "device", DEVICES, dict)

    def resolved(self, zones: list[str]) -> dict[str, Any]:
        """Fields of the kernel that are not as they are written: missing limits."""
        limits = {key: getattr(self, key) for key in ("gyro_range", "accel_range")}
        return {**super().resolved(zones), **{key: math.inf if v is None else v for key, v in limits.items()}}


SENSORS.register(Imu, kernel=core.ImuOptions)
