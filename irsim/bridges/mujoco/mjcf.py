"""A scene as MJCF, the XML of MuJoCo's models; writing it needs no MuJoCo.

Groups of geoms: 0 is solid and seen by lidars, 1 is seen by cameras only, 2 belongs to robots and is seen by cameras
only, 3 touches only, 4 is seen by lidars only. Bits of contacts: ground 1, robots 2, everything else 4; wheels touch
only the ground.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.etree import ElementTree as ET

from irsim.bridges.base import BridgeError
from irsim.bridges.mujoco.robots import (
    DRIVES,
    LIDAR_HEIGHT,
    Rig,
    add_actuators,
    add_robot,
    can_move,
    default_agents,
    rig_of,
)
from irsim.bridges.solids import Box, Solid, colored, merged_cells, numbers, room_of, solids_of
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Line, Polygon
from irsim.components.bridges.mujoco import Mujoco
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.build import steps_until
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["MAP_BODY", "PARKED", "body_name", "choose_agents", "is_mocap", "rigs_of", "write_mjcf"]

MAP_BODY = "irsim/map"
PARKED = -1000.0
"""Height of objects that are not in the world [m]."""
_WALL = 0.01
"""Thickness of walls, which are lines in irsim [m]."""
_SEEN_WALL = 1e-5
"""Thickness of what lidars see of lines [m]."""
_MAX_BOXES = 200_000
"""Maps that need more boxes are refused: MuJoCo would need gigabytes."""
_MAP_COLOR = (0.35, 0.35, 0.38)
_ROOM_WALL = 0.1
"""Thickness of the walls of rooms and worlds, which stand outside [m]."""


def choose_agents(scene: SceneDescription, names: Iterable[str] | None) -> frozenset[str]:
    """Names of the objects that MuJoCo moves.

    Args:
        scene: The scene.
        names: Option ``agents``; None chooses all robots that MuJoCo can move.

    Raises:
        BridgeError: There is no object of a name, or MuJoCo has no body for its drive.
    """
    if names is None:
        return default_agents(scene)
    for name in names:
        if name not in scene.names:
            fix = suggestion(name, scene.names, f"objects are {', '.join(scene.names[:20])}")
            raise BridgeError("bridge-mismatch", f"agents: there is no object {name!r}", fix)
        agent = scene.agent(name)
        if not can_move(agent):
            what = f"agents: MuJoCo cannot move {name}, whose drive is {(agent.drive or 'none')!r}"
            fix = f"name objects whose drive is one of {', '.join(DRIVES)}, or that can be pushed"
            raise BridgeError("bridge-mismatch", what, fix)
    return frozenset(names)


def rigs_of(scene: SceneDescription, moved: frozenset[str], options: Mujoco) -> dict[str, Rig]:
    """Rigs of the robots that MuJoCo moves, in the order of the scene."""
    return {agent.name: rig_of(agent, options.mass) for agent in scene.agents if agent.name in moved}


def is_mocap(agent: SceneObject, moved: frozenset[str]) -> bool:
    """Whether irsim moves an object, so that MuJoCo has to be told its pose."""
    return bool(agent.parts) and agent.name not in moved and (agent.moves or math.isfinite(agent.mass))


def body_name(agent: SceneObject) -> str:
    """Name of the body of an object, which is its own unless XML, MuJoCo or a part of another object has it."""
    name = agent.name
    return name if name != "world" and _plain(name) else f"irsim/object_{agent.index}"


def _plain(name: str) -> bool:
    """Whether a name can be written as it is; parts of objects have a slash in their names."""
    return bool(name) and name.isprintable() and "/" not in name


def write_mjcf(scene: SceneDescription, moved: frozenset[str], options: Mujoco) -> str:
    """The text of a model.

    Args:
        scene: The scene.
        moved: Names of the robots that are driven by actuators; other objects that move are mocap bodies.
        options: Physics and sizes.

    Raises:
        BridgeError: The map needs too many boxes.
    """
    return _Writer(scene, moved, options).write()


class _Writer:
    def __init__(self, scene: SceneDescription, moved: frozenset[str], options: Mujoco) -> None:
        self.scene, self.moved, self.options = scene, moved, options
        self.rigs = rigs_of(scene, moved, options)
        self.root = ET.Element("mujoco", model=scene.name if _plain(scene.name) else "irsim")
        self._head()
        self.asset = self._assets()
        self.world = ET.SubElement(self.root, "worldbody")
        self.meshes = 0

    def write(self) -> str:
        self._surroundings()
        actuators = ET.Element("actuator")
        for agent in self.scene.agents:
            if not agent.parts:
                continue
            body = ET.SubElement(self.world, "body", name=body_name(agent), pos=numbers(*agent.pose[:2], 0))
            body.set("euler", numbers(0, 0, agent.pose[2]))
            rig = self.rigs.get(agent.name)
            if rig is not None:
                add_robot(body, rig, agent.pose, self.options)
                add_actuators(actuators, body_name(agent), rig, self.options)
            elif is_mocap(agent, self.moved):
                body.set("mocap", "true")
            bottom, top = (rig.clearance, rig.top) if rig is not None else (0.0, self.options.height)
            for part in agent.parts:
                self._part(body, agent, part, bottom, top, "robot" if rig is not None else "thing")
            for lidar in agent.lidars:
                site = ET.SubElement(body, "site", name=f"{body_name(agent)}/lidar_{lidar.number}", group="4")
                site.set("pos", numbers(*lidar.mount[:2], LIDAR_HEIGHT))
                site.set("euler", numbers(0, 0, lidar.mount[2]))
                site.set("size", "0.02")
        self._map()
        if len(actuators):
            self.root.append(actuators)
        ET.indent(self.root)
        return ET.tostring(self.root, encoding="unicode") + "\n"

    def _head(self) -> None:
        options = self.options
        ET.SubElement(self.root, "compiler", angle="radian", autolimits="true")
        count = steps_until(self.scene.step_time, options.timestep)
        option = ET.SubElement(self.root, "option", integrator="implicitfast", cone="elliptic", impratio="10")
        option.set("timestep", numbers(self.scene.step_time / count))
        ET.SubElement(option, "flag", autoreset="disable")
        ET.SubElement(self.root, "size", memory=f"{64 + 2 * len(self.rigs)}M")
        visual = ET.SubElement(self.root, "visual")
        ET.SubElement(visual, "global", offwidth=str(options.size[0]), offheight=str(options.size[1]))
        ET.SubElement(visual, "headlight", ambient="0.35 0.35 0.35", diffuse="0.3 0.3 0.3", specular="0 0 0")
        ET.SubElement(visual, "map", znear="0.005", zfar="6")
        default = ET.SubElement(self.root, "default")
        classes = {
            "robot": {"contype": "2", "conaffinity": "6", "group": "0", "friction": "0.3"},
            "thing": {"contype": "4", "conaffinity": "2", "group": "0", "friction": "0.3"},
            "wheel": {"contype": "0", "conaffinity": "1", "group": "3", "type": "sphere", "priority": "1"},
            "caster": {"contype": "0", "conaffinity": "1", "group": "3", "type": "sphere", "priority": "1",
                       "condim": "1"},
            "seen": {"contype": "0", "conaffinity": "0", "group": "2"},
        }  # fmt: skip
        for name, attributes in classes.items():
            ET.SubElement(ET.SubElement(default, "default", {"class": name}), "geom", attributes)

    def _assets(self) -> ET.Element:
        asset = ET.SubElement(self.root, "asset")
        ET.SubElement(asset, "texture", type="skybox", builtin="gradient", rgb1="0.86 0.9 0.95", rgb2="0.6 0.7 0.82",
                      width="64", height="64")  # fmt: skip
        ET.SubElement(asset, "texture", name="ground", type="2d", builtin="checker", rgb1="0.66 0.68 0.68",
                      rgb2="0.6 0.62 0.62", width="128", height="128")  # fmt: skip
        ET.SubElement(asset, "material", name="ground", texture="ground", texuniform="true", texrepeat="0.5 0.5")
        return asset

    def _surroundings(self) -> None:
        """Ground, light, cameras, and walls unless an object of the scene is the walls."""
        (x0, y0), (x1, y1) = self.scene.low, self.scene.high
        x, y, wide = (x0 + x1) / 2, (y0 + y1) / 2, max(x1 - x0, y1 - y0)
        ET.SubElement(self.world, "geom", name="irsim/ground", type="plane", group="1", pos=numbers(x, y, 0),
                      size=numbers(0.75 * wide, 0.75 * wide, 0.1), material="ground",
                      contype="1", conaffinity="0")  # fmt: skip
        ET.SubElement(self.world, "light", directional="true", pos=numbers(x, y, 0.7 * wide), dir="0.15 0.1 -1",
                      diffuse="0.6 0.6 0.6", castshadow="false")  # fmt: skip
        width, height = self.options.size
        high = max(y1 - y0, (x1 - x0) * height / width) * 0.55 / math.tan(math.radians(22.5)) + self.options.height
        ET.SubElement(self.world, "camera", name="top", pos=numbers(x, y, high), fovy="45")
        ET.SubElement(self.world, "camera", name="corner", pos=numbers(x, y - 0.9 * wide, 0.85 * wide), fovy="45",
                      xyaxes=numbers(1, 0, 0, 0, 0.85, 0.9))  # fmt: skip
        room = room_of(self.scene)
        if room is not None:
            body = ET.SubElement(self.world, "body", name="irsim/walls")
            for solid in solids_of(room, _ROOM_WALL):
                self._solid(body, solid, 0.0, self.options.height, "thing", _MAP_COLOR)

    def _part(self, body: ET.Element, agent: SceneObject, part: object, bottom: float, top: float, kind: str) -> None:
        """Geoms of a part of a footprint."""
        thin = isinstance(part, Line) and not part.closed
        for solid in solids_of(part, _ROOM_WALL if isinstance(part, Line) and part.closed else _WALL):  # type: ignore[arg-type]
            geom = self._solid(body, solid, bottom, top, kind, agent.color)
            if thin:
                geom.set("group", "1")
            if not agent.solid:
                geom.set("contype", "0")
                geom.set("conaffinity", "0")
                geom.set("group", "1")
        if thin and agent.solid:
            for solid in solids_of(part, _SEEN_WALL):  # type: ignore[arg-type]
                geom = self._solid(body, solid, bottom, top, "seen", agent.color)
                geom.set("group", "4")

    def _solid(
        self, body: ET.Element, solid: Solid, bottom: float, top: float, kind: str, color: tuple[float, float, float]
    ) -> ET.Element:
        """A geom between two heights."""
        geom = ET.SubElement(body, "geom", {"class": kind, "rgba": colored(color)})
        middle, half = (bottom + top) / 2, (top - bottom) / 2
        if isinstance(solid, Polygon):
            geom.set("type", "mesh")
            geom.set("mesh", self._mesh(solid.corners, bottom, top))
            return geom
        geom.set("pos", numbers(*solid.center, middle))
        if isinstance(solid, Circle):
            geom.set("type", "cylinder")
            geom.set("size", numbers(solid.radius, half))
        else:
            geom.set("type", "box")
            geom.set("size", numbers(*solid.half, half))
            if solid.yaw:
                geom.set("euler", numbers(0, 0, solid.yaw))
        return geom

    def _mesh(self, corners: Floats, bottom: float, top: float) -> str:
        """Name of a prism; MuJoCo takes the convex hull of its corners."""
        name = f"prism_{self.meshes}"
        self.meshes += 1
        points = [numbers(x, y, z) for z in (bottom, top) for x, y in corners.tolist()]
        ET.SubElement(self.asset, "mesh", name=name, inertia="shell", vertex="  ".join(points))
        return name

    def _map(self) -> None:
        if self.scene.grid is None:
            return
        boxes = merged_cells(self.scene.grid)
        if len(boxes) > _MAX_BOXES:
            what = f"the map needs {len(boxes):,} boxes, more than {_MAX_BOXES:,}"
            raise BridgeError("bridge-mismatch", what, "use a map with a coarser resolution")
        body = ET.SubElement(self.world, "body", name=MAP_BODY)
        for x0, y0, x1, y1 in boxes.tolist():
            box = Box(((x0 + x1) / 2, (y0 + y1) / 2), ((x1 - x0) / 2, (y1 - y0) / 2))
            self._solid(body, box, 0.0, self.options.height, "thing", _MAP_COLOR)
