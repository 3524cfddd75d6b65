"""``env_param`` of the environment used last; see :class:`irsim.env.parameters.EnvParam`."""

from irsim.common.log import Logger
from irsim.env.parameters import EnvParam
from irsim.simulation.active_env import follow

__all__ = ["EnvParam"]

follow(__name__, "env_param", EnvParam(list, Logger()))
