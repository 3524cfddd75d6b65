"""``irsim.make`` and the environment."""

from irsim.env.env_base import Env, EnvBase, make

__all__ = ["Env", "EnvBase", "make"]
