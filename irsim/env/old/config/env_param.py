"""``env_param`` of the environment used last; see :class:`irsim.env.parameters.EnvParam`."""

from irsim.common.log import Logger
from irsim.env.old.config._follow import follow
from irsim.env.parameters import EnvParam

__all__ = ["EnvParam"]

follow(__name__, "env_param", EnvParam(list, Logger()))
