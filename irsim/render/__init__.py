"""Pictures of a simulation: scenes as data, Matplotlib figures, animations.

``irsim.render(…)``, the function, and this package have the same name: calling the package calls the function.
Nothing is imported, Matplotlib least of all, before something is drawn.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irsim.render.builder import SceneBuilder
    from irsim.render.plot import EnvPlot
    from irsim.render.scene import Scene
    from irsim.render.snapshot import render_scene

__all__ = ["EnvPlot", "Scene", "SceneBuilder", "render_scene"]

_HOMES = {
    "EnvPlot": "irsim.render.plot",
    "Scene": "irsim.render.scene",
    "SceneBuilder": "irsim.render.builder",
    "render_scene": "irsim.render.snapshot",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'irsim.render' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value


class _CallablePackage(ModuleType):
    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Draw a scenario; see :func:`irsim.api.render`."""
        from irsim.api import render

        return render(*args, **kwargs)


sys.modules[__name__].__class__ = _CallablePackage
