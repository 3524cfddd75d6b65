"""``world_param`` of the environment used last; see :class:`irsim.env.parameters.WorldParam`.

Before the first environment is made, it has the defaults of a scenario.
"""

from types import SimpleNamespace

from irsim.env.parameters import WorldParam
from irsim.scenario.model.scenario import WorldModel
from irsim.simulation.active_env import follow

__all__ = ["WorldParam"]

_KEYS = ("step_mode", "control_mode", "collision_mode", "step_time", "gravity", "friction", "restitution", "drive_tau")

follow(
    __name__,
    "world_param",
    SimpleNamespace(time=0.0, count=0, **{key: WorldModel.model_fields[key].default for key in _KEYS}),
)
