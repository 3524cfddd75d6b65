"""``irsim.make`` and the environment."""

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.env.env_base import Env, EnvBase
    from irsim.env.old.env_base3d import EnvBase3D
    from irsim.env.opening import make

__all__ = ["Env", "EnvBase", "EnvBase3D", "make"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Env": "irsim.env.env_base",
        "EnvBase": "irsim.env.env_base",
        "EnvBase3D": "irsim.env.old.env_base3d",
        "make": "irsim.env.opening",
    },
    modules=["env_base", "env_base3d", "env_config", "env_logger", "env_plot", "env_plot3d"],
)
