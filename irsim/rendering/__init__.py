"""Pictures of an environment: its scene, its figure, snapshots, strips and recordings.

Names are imported when first used, because importing Matplotlib is slow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.graphics.scene.scene import Scene
    from irsim.objects.drawing.scene_builder import SceneBuilder
    from irsim.rendering.env_plot import EnvPlot
    from irsim.rendering.snapshot import render_scene

__all__ = ["EnvPlot", "Scene", "SceneBuilder", "render_scene"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "EnvPlot": "irsim.rendering.env_plot",
        "Scene": "irsim.graphics.scene.scene",
        "SceneBuilder": "irsim.objects.drawing.scene_builder",
        "render_scene": "irsim.rendering.snapshot",
    },
)
