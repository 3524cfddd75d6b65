"""Write ``irsim/compatibility/names.json``: public names of PyPI's ir-sim 2.12.0, and parameters of its callables.

REFERENCE tests/compat/record_names.py        # with an interpreter that has ir-sim installed
"""

from __future__ import annotations

import importlib
import inspect
import json
from pathlib import Path

CLASSES = {
    "irsim.env": ["EnvBase", "EnvBase3D"],
    "irsim.env.env_config": ["EnvConfig"],
    "irsim.env.env_plot": ["EnvPlot"],
    "irsim.env.env_logger": ["EnvLogger"],
    "irsim.world": ["World", "ObjectBase", "ObjectFactory", "ObstacleMap", "SensorFactory"],
    "irsim.world.object_base": ["ObjectInfo", "ObstacleInfo"],
    "irsim.world.object_group": ["ObjectGroup"],
    "irsim.world.map": ["Map", "FogMap", "GridMapGenerator", "ImageGridGenerator", "PerlinGridGenerator"],
    "irsim.world.sensors": ["Lidar2D", "FMCWLidar2D", "Contact2D"],
    "irsim.lib": ["Behavior", "GroupBehavior", "KinematicsHandler", "KinematicsFactory", "GeometryFactory"],
    "irsim.lib.path_planners": ["AStarPlanner", "JPSPlanner", "RRT", "RRTStar", "InformedRRTStar", "PRMPlanner"],
    "irsim.gui": ["MouseControl", "KeyboardControl"],
    "irsim.msg": ["Odometry", "LaserScan", "ObjectState", "WorldState", "Quaternion"],
}
MODULES = [
    *("irsim", "irsim.env", "irsim.world", "irsim.world.map", "irsim.world.sensors", "irsim.lib", "irsim.lib.behavior"),
    *("irsim.lib.behavior.behavior_registry", "irsim.lib.behavior.behavior_methods", "irsim.lib.path_planners"),
    *("irsim.util", "irsim.util.util", "irsim.util.random", "irsim.config", "irsim.gui", "irsim.msg"),
]
LEAVES = [
    *("irsim.gui.keyboard_control", "irsim.gui.mouse_control", "irsim.version"),
    *(f"irsim.world.sensors.{name}" for name in ("contact2d", "fmcw_lidar2d", "lidar2d", "sensor_factory")),
    *(f"irsim.world.robots.robot_{name}" for name in ("acker", "diff", "omni")),
    *(f"irsim.world.obstacles.obstacle_{name}" for name in ("acker", "diff", "omni", "static")),
    *(f"irsim.world.map.{name}_map_generator" for name in ("image", "perlin")),
    *("irsim.world.map.fog_map", "irsim.world.map.grid_map_generator_base", "irsim.world.map.obstacle_map"),
    *("irsim.world.object_plot", "irsim.lib.algorithm.contact", "irsim.lib.path_planners.grid_planner_base"),
    *("irsim.util.decorator", "irsim.util.message"),
]
"""Modules of which only what they define counts."""


def parameters(item: object) -> list[str] | None:
    """Names of the parameters of a callable, or None."""
    try:
        return [name for name in inspect.signature(item).parameters if name != "self"]  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def names_of(item: object) -> dict[str, list[str] | None]:
    """Public attributes of a class, or names made in a module."""
    names: dict[str, list[str] | None] = {}
    for name in sorted(vars(item) if inspect.ismodule(item) else dir(item)):
        value = getattr(item, name, None)
        if name.startswith("_") or inspect.ismodule(value):
            continue
        home = getattr(value, "__module__", None)
        if inspect.ismodule(item) and not str(home or "irsim").startswith("irsim"):
            continue
        names[name] = parameters(value) if callable(value) else None
    return names


def main() -> None:
    """Write the file."""
    names = {module: names_of(importlib.import_module(module)) for module in MODULES}
    for leaf in LEAVES:
        module = importlib.import_module(leaf)
        own = names_of(module)
        names[leaf] = {name: own[name] for name in own if getattr(vars(module)[name], "__module__", "") == leaf}
    for module, classes in CLASSES.items():
        for name in classes:
            names[f"{module}:{name}"] = names_of(getattr(importlib.import_module(module), name))
    text = json.dumps(names, indent=1, sort_keys=True)
    (Path(__file__).parents[2] / "irsim" / "compatibility" / "names.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
