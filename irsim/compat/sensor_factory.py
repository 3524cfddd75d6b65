"""A factory of sensors without an environment, with the names of IR-SIM."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.compat.objects.view import views
from irsim.objects.lifecycle import alone
from irsim.options.registry import SENSORS
from irsim.scenario.read import or_raise, read
from irsim.scenario.single_object import read_object

__all__ = ["SensorFactory"]


class SensorFactory:
    """Makes sensors that do not belong to an object of an environment."""

    def create_sensor(self, state: Any, obj_id: int, **kwargs: Any) -> Any:
        """Make a sensor whose carrier is the only object of an empty world.

        Args:
            state: Pose of the carrier, x, y [m] and heading [rad], in any shape.
            obj_id: Id of the carrier.
            **kwargs: Keys of a sensor in a scenario; without ``name`` and ``type`` the sensor is a ``lidar2d``.

        Raises:
            NotImplementedError: No sensor has that name.
            ScenarioError: A key or value is not valid.
        """
        name = str(kwargs.get("name", kwargs.get("type", "lidar2d")))
        if SENSORS.get(name) is None:
            raise NotImplementedError(f"there is no sensor {name!r}: choose one of {', '.join(SENSORS.names())}")
        scenario, _ = or_raise(read({"world": {}}))
        pose = np.asarray(state, dtype=np.float64).reshape(-1)[:3].tolist()
        keys = {"state": pose, "shape": {"name": "circle"}, "sensors": [kwargs]}
        record, _ = read_object("obstacle", keys, scenario.world, obj_id)
        return views(alone(scenario, record, 0))[0].sensors[0]
