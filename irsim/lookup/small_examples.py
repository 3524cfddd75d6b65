"""Small examples for keys that no template uses, above all keys that draw, sense or are random; tests validate each."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import yaml

from irsim.bundled import templates
from irsim.common.data_files import read_yaml
from irsim.lookup.schema_walk import Node, alternatives, component_name, mappings, step, yaml_text

__all__ = ["BETTER", "example_of", "small_example"]


BETTER = ("arrive_mode", "avoid", "fov", "fov_radius", "fov_occlusion", "goal_threshold", "show_fov")
"""Keys whose small example says more than the examples of templates, because they need each other."""

_VALUES: dict[str, Any] = {
    "acce": [0.5, 1.0],
    "robot.actuation": {"delay": 0.1, "lag": 0.15},
    "actuation.command_period": 0.2,
    "actuation.dead_band": [0.02, 0.05],
    "actuation.delay": [0.05, 0.1],
    "actuation.jerk": [2.0, 10.0],
    "actuation.lag": 0.15,
    "actuation.noise": [0.01, 0.02],
    "actuation.resolution": 0.05,
    "after_arrival": "freeze",
    "angle_std": 0.01,
    "angle_tolerance": 0.05,
    "attenuation": 2,
    "avg_radius_range": [0.3, 0.8],
    "avocado.bias": -0.5,
    "avocado.noise": 0.001,
    "avoid": ["people_talking"],
    "center": [0.1, 0],
    "center_range": [0, 0, 0, 0],
    "approach_time": 0.5,
    "clearance": 0.3,
    "complexity": 0.1,
    "distribution.circle_crossing.center": [6, 6],
    "distribution.circle_crossing.noise": 0.3,
    "distribution.square_crossing.center": [6, 6],
    "facecolor": "white",
    "format": "png",
    "fov": 1.5708,
    "fov_radius": 4,
    "fractal": 2,
    "gaze_vision_angle": 1.5,
    "arrive_mode": "state",
    "goal_threshold": 0.3,
    "goal_color": "green",
    "group_repulsion_threshold": 0.6,
    "irregularity_range": [0, 0.5],
    "keep_traj_length": 100,
    "keep_clear": [{"point": [5, 5], "radius": 1}],
    "keep_clear.object": "crate",
    "keep_clear.point": [5, 5],
    "keep_clear.radius": 1,
    "keep_trail_length": 10,
    "kinematics.acker.alpha": [0.03, 0, 0, 0.03],
    "kinematics.diff.alpha": [0.03, 0, 0, 0.03],
    "kinematics.omni.alpha": [0.03, 0.03],
    "kinematics.omni_angular.alpha": [0.03, 0.03, 0.03],
    "kinematics.diff_dynamic.alpha": [0.03, 0, 0, 0.03],
    "kinematics.single_track.alpha": [0.03, 0, 0, 0.03],
    "kinematics.single_track.psi_max": 0.35,
    "kinematics.single_track.speed_min": -2,
    "kinematics.skid_steer.alpha": [0.03, 0, 0, 0.03],
    "kinematics.tricycle.alpha": [0.03, 0, 0, 0.03],
    "kinematics.tricycle.psi_max": 1.2,
    "zones.slip": 0.2,
    "zones.slip_std": 0.05,
    "zones.slip_time": 2,
    "zones.grip": 0.3,
    "zones.surface": "gravel",
    "kinematics.skid_steer.surface": "gravel",
    "lookahead": 1.5,
    "metadata": {"Title": "run 1"},
    "maxSpeed": 1.2,
    "no_hit_alpha": 0.1,
    "neighborDist": 8,
    "noise": True,
    "num_vertices_range": [4, 8],
    "obj_zorder": 4,
    "obstacle_map.perlin.resolution": 0.2,
    "obstacle_map.image.path": "cave.png",
    "goal_high": [11, 11, 3.14159],
    "goal_low": [8, 1, -3.14159],
    "obstacle_map.ros.path": "maps/floor.yaml",
    "offset": [0.2, 0, 3.14159],
    "plot.alpha": 0.1,
    "plot.style": "modern",
    "plot.theme": "dark",
    "polygon": [[6, 1], [9, 1], [7, 4]],
    "radius": 4,
    "resolution": 0.1,
    "radius_range": [0.2, 0.6],
    "range_high": [11, 11],
    "range_low": [1, 1],
    "range_min": 0.1,
    "rate": 10,
    "latency": 0.1,
    "accel_range": 39.2,
    "blocked": ["tunnel"],
    "blind": [[2.8, 3.14159]],
    "device": "rplidar_a1",
    "divergence": 0.005,
    "gyro_range": 4.36,
    "imu.device": "adis16448",
    "ir_range.device": "vl53l0x",
    "ir_range.dropout": 0.05,
    "ir_range.resolution": 0.005,
    "ir_range.std": 0.01,
    "ir_range.std_per_meter": 0.03,
    "bumper.sectors": [[-1.2, -0.4], [-0.4, 0.4], [0.4, 1.2]],
    "cliff.false_share": 0.01,
    "cliff.miss_share": 0.02,
    "cliff.points": [[0.2, -0.1], [0.2, 0.1]],
    "cliff.zones": ["stairs"],
    "depth_scan.depth_from": 0.4,
    "depth_scan.depth_growth": 0.0025,
    "depth_scan.depth_min": 0.28,
    "depth_scan.depth_std": 0.001,
    "depth_scan.device": "d435",
    "depth_scan.plot": {"alpha": 0.1},
    "sonar.crosstalk": 0.02,
    "sonar.device": "hc_sr04",
    "sonar.dropout": 0.05,
    "sonar.incidence_max": 0.5,
    "sonar.resolution": 0.003,
    "sonar.std": 0.01,
    "sonar.std_per_meter": 0.01,
    "uwb.anchors": [[0, 0], [10, 0], [5, 10]],
    "uwb.dropout": 0.05,
    "uwb.nlos_bias": 0.3,
    "uwb.nlos_std": 0.1,
    "uwb.outlier_share": 0.1,
    "uwb.range_max": 30,
    "incidence_max": 1.3,
    "material": "glass",
    "mixed": "nearest",
    "range_dark": 4,
    "realism": {"std_per_meter": 0.01, "dropout": 0.02},
    "realism.bias_std": 0.02,
    "realism.dropout": 0.02,
    "realism.random_share": 0.01,
    "realism.rays": 5,
    "realism.resolution": 0.01,
    "realism.resolution_growth": 0.0002,
    "realism.scale_std": 0.01,
    "realism.short_rate": 0.5,
    "realism.short_share": 0.01,
    "realism.segments": 4,
    "realism.std_per_meter": 0.01,
    "realism.sweep": True,
    "reflecting": ["street"],
    "perceives": "estimate",
    "reflectivity": 0.1,
    "replan": 2,
    "responsibility": 1,
    "rvo.acce": 0.5,
    "safety_radius": 0.2,
    "social_groups": [[0, 1], [2, 3]],
    "spikeyness_range": [0, 0.3],
    "start_time": 5,
    "std": 0.05,
    "text_position": [0.3, 0.3],
    "tau": 0.2,
    "title": "Two robots pass each other",
    "trail_type": "circle",
    "velocity_color_max": 1,
    "vertices": [[0, 0], [1, 0], [0, 1]],
    "viewpoint": "robot_0",
    "wheelbase": 0.5,
    "within": {"rectangle": [0, 4, 20, 6]},
    "within.polygon": [[0, 0], [20, 0], [20, 6], [0, 6]],
    "within.rectangle": [0, 4, 20, 6],
    "width": 8,
}
"""Values that say more than the default does, by the last words of a path."""
_OUTLINE = ("avg_radius_range", "center_range", "irregularity_range", "spikeyness_range", "num_vertices_range")
"""Keys of random outlines."""
_TOGETHER: dict[str, dict[str, Any]] = {
    **{key: {"noise": True} for key in ("alpha", "std", "angle_std")},
    **{key: {"wander": True} for key in ("range_low", "range_high")},
    **{key: {"random_shape": True} for key in (*_OUTLINE, "radius_range", "is_convex")},
    "arrive_mode": {"goal": [9, 4, 3.14159], "goal_threshold": 0.1},
    "fov": {"fov_radius": 4, "fov_occlusion": True, "plot": {"show_fov": True}},
    "fov_radius": {"fov": 1.5708, "plot": {"show_fov": True}},
    "fov_occlusion": {"fov": 1.5708, "fov_radius": 4},
    **{f"{sensor}.std": {} for sensor in ("gnss", "ir_range", "sonar", "uwb")},
    "perceives": {"sensors": [{"name": "localization"}]},
    "fade": {"range_dark": 4},
    "segments": {"sweep": True},
    "short_rate": {"short_share": 0.01},
    "rays": {"divergence": 0.005},
    "mixed": {"divergence": 0.005},
    "shape.linestring.wheelbase": {"vertices": [[0, 0], [3, 0], [3, 2]]},
    "shape.linestring.number": {"vertices": [[0, 0], [3, 0], [3, 2]]},
    "show_goal_text": {"show_text": True, "show_goal": True},
    "trail_freq": {"show_trail": True},
    "keep_clear.object": {"radius": 1},
    "keep_clear.point": {"radius": 1},
    "keep_clear.radius": {"point": [5, 5]},
    "zones.color": {"name": "court", "rectangle": [6, 1, 9, 4]},
    "zones.slip": {"name": "court", "rectangle": [6, 1, 9, 4]},
    "zones.slip_std": {"name": "court", "rectangle": [6, 1, 9, 4], "slip": 0.2},
    "zones.slip_time": {"name": "court", "rectangle": [6, 1, 9, 4], "slip": 0.2, "slip_std": 0.05},
    "zones.grip": {"name": "court", "rectangle": [6, 1, 9, 4]},
    "zones.surface": {"name": "court", "rectangle": [6, 1, 9, 4]},
    "zones.polygon": {"name": "court"},
    "perlin.complexity": {"resolution": 0.2},
    "perlin.fractal": {"resolution": 0.2},
    "perlin.attenuation": {"resolution": 0.2, "fractal": 2},
}
"""Keys without which another has no effect, by the last words of its path."""
_LISTS = ("bridges", "keep_clear", "parts", "sensors", "zones")
"""Keys whose components stand in a list."""


def small_example(schema: Node, path: tuple[str, ...]) -> str | None:
    """Return YAML for a key of the language, inside the component that it belongs to.

    Args:
        schema: JSON Schema of the language.
        path: Words of the path, such as ``("robot", "sensors", "lidar2d", "angle_std")``.

    Returns:
        The example, from the key of the section on; None for keys of which no telling value is known.
    """
    nodes, chain, needed = [schema], list[bool](), list[set[str]]()  # whether a word names a component; what that needs
    for word in path:
        options = [option for node in nodes for option in mappings(schema, node)]
        chain.append(any(component_name(option) == word for option in options))
        nodes = step(schema, nodes, word)
        needed.append(set(nodes[0].get("required", [])) if nodes else set())
    if not nodes or len(path) < 2:
        return None
    value = {} if chain[-1] else _value(schema, path, nodes[0])
    if value is None:
        return None
    together = {} if _stands_alone(path) else _of(_TOGETHER, path) or {}
    for place in range(len(path) - 1, 0, -1):
        word = path[place]
        if chain[place]:
            missing = sorted(needed[place] - {"name", *value})
            told = {key: _of(_VALUES, (*path[: place + 1], key)) for key in missing}
            if None in told.values():
                return None
            value = {"name": word, **told, **value}
        else:
            value = {word: [value] if word in _LISTS and isinstance(value, dict) else value, **together}
            together = {}
    if path[0] in _LISTS:
        return f"{path[0]}: {yaml_text([value])}"
    return ", ".join(f"{key}: {yaml_text(item)}" for key, item in value.items())


def _stands_alone(path: tuple[str, ...]) -> bool:
    """Whether a key has only its name in common with one that needs others."""
    opacity = path[-1] == "alpha" and "kinematics" not in path
    return opacity or (path[-1] in ("range_low", "range_high") and "distribution" in path)


def _of(table: dict[str, Any], path: tuple[str, ...]) -> Any:
    """Return the entry of a table for the last words of a path; the longest match counts."""
    names = (".".join(path[start:]) for start in range(len(path)))
    return next((table[name] for name in names if name in table), None)


def _value(schema: Node, path: tuple[str, ...], node: Node) -> Any:
    """Return a value for a key: the one of the table, the other state of a switch, or the default."""
    known = _of(_VALUES, path)
    if known is not None:
        return known
    if any(option.get("type") == "boolean" for option in alternatives(schema, node)):
        return not node.get("default", False)
    if path[-1].endswith("color"):
        return "red"
    default = node.get("default")
    return None if default in ({}, []) else default


MAX_LINE_LENGTH = 90
"""Longer values are written on several lines."""


def example_of(path: tuple[str, ...], component: str | None = None) -> str | None:
    """Return YAML for a path of the language from a template, or None if no template uses the path.

    Args:
        path: Words of the path, such as ``("robot", "vel_max")``.
        component: Name of the component at the end of the path, if it ends with a component.
    """
    names = path[:-1] if component is not None else path
    for section in dict.fromkeys((path[0], "robot" if path[0] == "obstacle" else path[0], "obstacle")):
        words = (section, *path[1:]) if path[0] in ("robot", "obstacle") else path
        values = [value for data in _scenarios() for value in _values(data, words)]
        lines = {yaml_text(value): value for value in values if value not in (None, {}, [])}
        if lines:
            fitting = [line for line in lines if len(line) <= MAX_LINE_LENGTH] or [min(lines, key=len)]
            best = lines[
                max(fitting, key=len)
                if component is not None
                else next((line for line in fitting if isinstance(lines[line], dict)), fitting[0])
            ]
            return _example_text(names[-1], best, component)
    return None


@cache
def _scenarios() -> tuple[Any, ...]:
    """Read the scenarios of all templates; cached, because the reference pages ask for hundreds of examples."""
    texts = (templates.scenario_file(name).read_text(encoding="utf-8") for name in templates.names())
    return tuple(read_yaml(text) for text in texts)


def _values(data: Any, words: tuple[str, ...]) -> Iterator[Any]:
    """Iterate over the values at a path; lists are searched, and names of components select mappings."""
    if isinstance(data, list):
        if not words and not any(isinstance(item, dict) for item in data):
            yield data
        for item in data if words or any(isinstance(item, dict) for item in data) else []:
            yield from _values(item, words)
    elif not words:
        yield data
    elif isinstance(data, dict):
        if words[0] in data:
            yield from _values(data[words[0]], words[1:])
        elif data.get("name", data.get("type")) == words[0]:
            yield from _values(data, words[1:])


_WRITTEN_AS_LISTS = ("bridges", "sensors", "zones")
"""Keys whose mappings stand in a list."""


def _example_text(name: str, value: Any, component: str | None) -> str:
    one = [value] if name in _WRITTEN_AS_LISTS and isinstance(value, dict) else value
    line = f"{name}: {yaml_text(one)}"
    if len(line) <= MAX_LINE_LENGTH + len(name) or not isinstance(value, dict):
        return line
    whole = {name: [value] if name in ("robot", "obstacle", *_WRITTEN_AS_LISTS) else value}
    return yaml.safe_dump(whole, sort_keys=False, default_flow_style=None, width=MAX_LINE_LENGTH).rstrip()
