"""``env_param`` of the environment used last; see :class:`irsim.parameters.EnvParam`."""

from irsim.config._follow import follow
from irsim.log import Logger
from irsim.parameters import EnvParam

__all__ = ["EnvParam"]

follow(__name__, "env_param", EnvParam(list, Logger()))
