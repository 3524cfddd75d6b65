"""A scene, and the paths of what moves in it, as a world in SDF 1.9.

Obstacles that stand still are static models, obstacles that moved are actors with waypoints, and robots are models at
their start that listen for velocities on ``/model/<name>/cmd_vel``. Shapes are boxes, cylinders and meshes in files.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from xml.etree import ElementTree as ET

from irsim.bridges.mujoco.robots import LIDAR_HEIGHT, rig_of
from irsim.bridges.solids import Box, Solid, colored, merged_cells, numbers, room_of, solids_of
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Line
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject

__all__ = ["SDF_VERSION", "SdfWorld", "prism"]


def prism(corners: Floats, bottom: float, top: float) -> str:
    """A convex outline between two heights, as text of an OBJ file whose faces look outwards.

    Args:
        corners: (K, 2) counterclockwise [m].
        bottom: Height of its lower end [m].
        top: Height of its upper end [m].
    """
    count = len(corners)
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for z in (bottom, top) for x, y in corners.tolist()]
    for k in range(1, count - 1):
        lines.append(f"f 1 {k + 2} {k + 1}")
        lines.append(f"f {count + 1} {count + k + 1} {count + k + 2}")
    for k in range(count):
        a, b = k + 1, (k + 1) % count + 1
        lines.append(f"f {a} {b} {count + b}")
        lines.append(f"f {a} {count + b} {count + a}")
    return "\n".join(lines) + "\n"


SDF_VERSION = "1.9"
_HEIGHT = 1.0
"""Height of obstacles and walls [m]."""
_WALL, _ROOM_WALL = 0.02, 0.1
"""Thickness of lines, and of the walls of rooms and worlds [m]."""
_MAP_COLOR = (0.35, 0.35, 0.38)
_SYSTEMS = {
    "gz-sim-physics-system": "gz::sim::systems::Physics",
    "gz-sim-user-commands-system": "gz::sim::systems::UserCommands",
    "gz-sim-scene-broadcaster-system": "gz::sim::systems::SceneBroadcaster",
    "gz-sim-sensors-system": "gz::sim::systems::Sensors",
}
"""Systems of Gazebo that a world with moving models and lidars needs."""


class SdfWorld:
    """Writes a world.

    Args:
        scene: The scene.
        paths: Name of an obstacle that moved -> (K, 4) time [s], x, y [m], yaw [rad] of its waypoints.

        left_out: Names of objects that are not written.

    Attributes:
        meshes: Name of a file of the folder ``meshes`` -> its text, complete after :meth:`write`.
    """

    def __init__(self, scene: SceneDescription, paths: Mapping[str, Floats], left_out: Collection[str] = ()) -> None:
        self.scene, self.paths, self.left_out = scene, paths, left_out
        self.meshes: dict[str, str] = {}
        self._names: set[str] = set()
        self._solids: dict[ET.Element, int] = {}  # number of the last one of a link
        self.root = ET.Element("sdf", version=SDF_VERSION)
        self.world = ET.SubElement(self.root, "world", name=self._name(scene.name or "irsim"))

    def write(self) -> str:
        """The text of the world."""
        self._surroundings()
        self._map()
        for agent in self.scene.agents:
            if not agent.parts or agent.name in self.left_out:
                continue
            if agent.role == "robot":
                self._robot(agent)
            elif agent.name in self.paths:
                self._actor(agent, self.paths[agent.name])
            else:
                link = self._static(agent.name, agent.pose)
                self._footprint(link, agent, 0.0, _HEIGHT)
        ET.indent(self.root)
        return f'<?xml version="1.0"?>\n{ET.tostring(self.root, encoding="unicode")}\n'

    def _surroundings(self) -> None:
        physics = ET.SubElement(self.world, "physics", name="steps", type="ignored")
        _text(physics, "max_step_size", numbers(self.scene.step_time / math.ceil(self.scene.step_time / 0.005)))
        _text(physics, "real_time_factor", "1")
        for file, name in _SYSTEMS.items():
            plugin = ET.SubElement(self.world, "plugin", filename=file, name=name)
            if name.endswith("Sensors"):
                _text(plugin, "render_engine", "ogre2")
        light = ET.SubElement(self.world, "light", type="directional", name="sun")
        _text(light, "cast_shadows", "true")
        _text(light, "pose", "0 0 10 0 0 0")
        _text(light, "diffuse", "0.8 0.8 0.8 1")
        _text(light, "direction", "0.3 0.2 -1")
        (x0, y0), (x1, y1) = self.scene.low, self.scene.high
        ground = self._static("ground", ((x0 + x1) / 2, (y0 + y1) / 2, 0.0))
        for kind in ("collision", "visual"):
            shape = ET.SubElement(ET.SubElement(ground, kind, name=kind), "geometry")
            plane = ET.SubElement(shape, "plane")
            _text(plane, "normal", "0 0 1")
            _text(plane, "size", numbers(2 * (x1 - x0), 2 * (y1 - y0)))
        room = room_of(self.scene)
        if room is not None:
            link = self._static("walls", (0.0, 0.0, 0.0))
            for solid in solids_of(room, _ROOM_WALL):
                self._solid(link, solid, 0.0, _HEIGHT, _MAP_COLOR)

    def _map(self) -> None:
        if self.scene.grid is None:
            return
        link = self._static("map", (0.0, 0.0, 0.0))
        for x0, y0, x1, y1 in merged_cells(self.scene.grid).tolist():
            box = Box(((x0 + x1) / 2, (y0 + y1) / 2), ((x1 - x0) / 2, (y1 - y0) / 2))
            self._solid(link, box, 0.0, _HEIGHT, _MAP_COLOR)

    def _robot(self, agent: SceneObject) -> None:
        rig = rig_of(agent)
        name, link = self._model(agent.name, agent.pose, static=False)
        model = self.world[-1]
        inertial = ET.SubElement(link, "inertial")
        _text(inertial, "pose", numbers(*rig.center, 0.05, 0, 0, 0))
        _text(inertial, "mass", numbers(rig.mass))
        upright = rig.mass * rig.gyration**2
        tilting = max(upright / 2, rig.mass * (rig.gyration**2 / 2 + rig.top**2 / 12))
        moments = ET.SubElement(inertial, "inertia")
        for axis, value in (("ixx", tilting), ("iyy", tilting), ("izz", upright)):
            _text(moments, axis, numbers(value))
        self._footprint(link, agent, 0.0, rig.top)
        for lidar in agent.lidars:
            _sensor(link, lidar, f"/{name}/scan_{lidar.number}" if lidar.number else f"/{name}/scan")
        plugin = ET.SubElement(model, "plugin", filename="gz-sim-velocity-control-system",
                               name="gz::sim::systems::VelocityControl")  # fmt: skip
        _text(plugin, "topic", f"/model/{name}/cmd_vel")

    def _actor(self, agent: SceneObject, path: Floats) -> None:
        """An actor that follows its waypoints once."""
        actor = ET.SubElement(self.world, "actor", name=self._name(agent.name))
        _text(actor, "pose", numbers(path[0, 1], path[0, 2], 0, 0, 0, path[0, 3]))
        self._footprint(ET.SubElement(actor, "link", name="link"), agent, 0.0, _HEIGHT)
        script = ET.SubElement(actor, "script")
        _text(script, "loop", "false")
        _text(script, "delay_start", "0")
        _text(script, "auto_start", "true")
        trajectory = ET.SubElement(script, "trajectory", id="0", type="run")
        for time, x, y, yaw in path.tolist():
            waypoint = ET.SubElement(trajectory, "waypoint")
            _text(waypoint, "time", numbers(time))
            _text(waypoint, "pose", numbers(x, y, 0, 0, 0, yaw))

    def _footprint(self, link: ET.Element, agent: SceneObject, bottom: float, top: float) -> None:
        for part in agent.parts:
            thickness = _ROOM_WALL if isinstance(part, Line) and part.closed else _WALL
            for solid in solids_of(part, thickness):
                self._solid(link, solid, bottom, top, agent.color, touches=agent.solid)

    def _solid(
        self,
        link: ET.Element,
        solid: Solid,
        bottom: float,
        top: float,
        color: tuple[float, float, float],
        *,
        touches: bool = True,
    ) -> None:
        """A shape that is seen and, unless it is only drawn, touched."""
        number = self._solids[link] = self._solids.get(link, -1) + 1
        for kind in ("collision", "visual") if touches else ("visual",):
            element = ET.SubElement(link, kind, name=f"{kind}_{number}")
            shape = ET.Element("geometry")
            if isinstance(solid, Box):
                _text(element, "pose", numbers(*solid.center, (bottom + top) / 2, 0, 0, solid.yaw))
                _text(ET.SubElement(shape, "box"), "size", numbers(2 * solid.half[0], 2 * solid.half[1], top - bottom))
            elif isinstance(solid, Circle):
                _text(element, "pose", numbers(*solid.center, (bottom + top) / 2, 0, 0, 0))
                cylinder = ET.SubElement(shape, "cylinder")
                _text(cylinder, "radius", numbers(solid.radius))
                _text(cylinder, "length", numbers(top - bottom))
            else:
                _text(ET.SubElement(shape, "mesh"), "uri", f"meshes/{self._mesh(prism(solid.corners, bottom, top))}")
            element.append(shape)
            if kind == "visual":
                material = ET.SubElement(element, "material")
                for word in ("ambient", "diffuse"):
                    _text(material, word, colored(color))

    def _mesh(self, text: str) -> str:
        """Name of a file with a text; equal meshes share one."""
        for name, known in self.meshes.items():
            if known == text:
                return name
        name = f"prism_{len(self.meshes)}.obj"
        self.meshes[name] = text
        return name

    def _static(self, name: str, pose: tuple[float, float, float]) -> ET.Element:
        return self._model(name, pose, static=True)[1]

    def _model(self, name: str, pose: tuple[float, float, float], *, static: bool) -> tuple[str, ET.Element]:
        """A model with one link; its name and the link."""
        unique = self._name(name)
        model = ET.SubElement(self.world, "model", name=unique)
        _text(model, "static", "true" if static else "false")
        _text(model, "pose", numbers(*pose[:2], 0, 0, 0, pose[2]))
        return unique, ET.SubElement(model, "link", name="link")

    def _name(self, wanted: str) -> str:
        """A name that SDF accepts and that nothing else has: letters, digits, ``_``, ``-`` and ``.``."""
        base = re.sub(r"[^\w.-]+", "_", wanted).strip("_") or "object"
        if base == "world":
            base = "world_object"
        name, number = base, 2
        while name in self._names:
            name, number = f"{base}_{number}", number + 1
        self._names.add(name)
        return name


def _text(parent: ET.Element, tag: str, text: str) -> None:
    ET.SubElement(parent, tag).text = text


def _sensor(link: ET.Element, lidar: Lidar, topic: str) -> None:
    """A lidar at its mount."""
    sensor = ET.SubElement(link, "sensor", name=f"lidar_{lidar.number}", type="gpu_lidar")
    _text(sensor, "pose", numbers(*lidar.mount[:2], LIDAR_HEIGHT, 0, 0, lidar.mount[2]))
    _text(sensor, "topic", topic)
    _text(sensor, "update_rate", numbers(1 / lidar.period if lidar.period > 0 else 10.0))
    element = ET.SubElement(sensor, "lidar")
    horizontal = ET.SubElement(ET.SubElement(element, "scan"), "horizontal")
    for tag, value in (("samples", lidar.beams), ("resolution", 1)):
        _text(horizontal, tag, str(value))
    _text(horizontal, "min_angle", numbers(lidar.angle_min))
    _text(horizontal, "max_angle", numbers(lidar.angle_max))
    reach = ET.SubElement(element, "range")
    _text(reach, "min", numbers(max(lidar.range_min, 0.01)))
    _text(reach, "max", numbers(lidar.range_max))
    if lidar.noise_std:
        noise = ET.SubElement(element, "noise")
        for tag, text in (("type", "gaussian"), ("mean", "0"), ("stddev", numbers(lidar.noise_std))):
            _text(noise, tag, text)
