"""``sdf``: worlds and models of Gazebo (``.sdf``, ``.world``): what a robot meets of their shapes.

Shapes that are touched count; a link without any counts by what is seen of it. Moving models with sensors or plug-ins
are robots, and stay out.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from irsim.bridges.maps import slices
from irsim.bridges.maps.kinds import mesh
from irsim.bridges.maps.kinds._named_meshes import read_named_mesh
from irsim.bridges.maps.kinds._sdf_places import Frames, find_file, model_of, pose_of
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlines, unusable
from irsim.bridges.maps.xml_files import UPRIGHT, Collection, find_number, find_numbers, read_xml
from irsim.common.arrays import Floats
from irsim.common.text import clean

__all__ = ["KIND"]

_MAX_MODELS = 20_000
_MAX_INCLUDES = 32
"""Files that include one another."""
_HARMLESS = ("sun", "ground_plane")
"""Models of nearly every world in which nothing stands."""


@dataclass(kw_only=True)
class _World(Collection):
    """A world, and what is collected of it; ``models`` is the number of models that it includes."""

    models: int = 0


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of the shapes of a world or of models.

    Raises:
        BridgeError: The file is damaged, includes itself or an address, or nothing stands in it.
    """
    world = _World(path=path, options=options, limits=limits)
    root = read_xml(path, limits)
    worlds = [root] if root.tag == "world" else root.findall("world")
    scope = worlds[0] if worlds else root
    if len(worlds) > 1:
        world.leave("a file becomes one world, the first", worlds[1].get("name", "?"))
    if root.tag == "model":
        scope = ET.Element("world")
        scope.append(root)
    _include(world, scope, path, (path.resolve(),))
    _apply_state(scope)
    frames = Frames(path, scope)
    for model in scope.iterfind("model"):
        _model(world, model, frames.place(model), model.get("name", ""), still=False)
    for actor in scope.iterfind("actor"):
        world.leave("actors move", actor.get("name", "?"))
    for element in scope.iterfind("population"):
        world.leave("populations are placed by Gazebo", element.get("name", "?"))
    return world.outlines()


def _include(world: _World, scope: ET.Element, path: Path, open_files: tuple[Path, ...]) -> None:
    """Put included models in place of the elements that include them, in all depths."""
    scope.set("file", str(path))
    for number, item in enumerate(list(scope)):
        if item.tag == "model":
            _include(world, item, path, open_files)
        if item.tag != "include":
            continue
        world.models += 1
        if world.models > _MAX_MODELS:
            raise unusable(world.path, f"it includes more than {_MAX_MODELS:,} models")
        uri = (item.findtext("uri") or "").strip()
        located = find_file(uri, path, world.options.root, world.limits)
        loaded = None if located is None else model_of(located, world.limits)
        if loaded is None:
            if uri.partition("://")[0].lower() in ("http", "https"):
                what = f"it includes the address '{clean(uri, 120)}', and nothing is fetched"
                raise unusable(path, what, "download the model, and name the folder that holds it with --root")
            if uri.rpartition("/")[2] not in _HARMLESS:
                advice = (
                    "it is not here, --root names the folder that holds it" if located is None else "it has no model"
                )
                world.leave(advice, uri or "an include without a uri")
            continue
        file, model = loaded
        if file in open_files or len(open_files) > _MAX_INCLUDES:
            raise unusable(path, f"'{clean(file.name, 100)}' includes itself")
        world.parts.append(file)
        _include(world, model, file, (*open_files, file))
        for tag in ("pose", "static"):
            given = item.find(tag)
            if given is not None:
                for old in model.findall(tag):
                    model.remove(old)
                model.append(copy.copy(given))
        model.set("name", (item.findtext("name") or model.get("name") or "").strip())
        if item.findtext("placement_frame"):
            model.set("placement_frame", (item.findtext("placement_frame") or "").strip())
        scope[number] = model


def _apply_state(scope: ET.Element) -> None:
    """Models stand where the saved state of the world says."""
    saved = {item.get("name"): item.find("pose") for item in scope.iterfind("state/model")}
    for model in scope.iterfind("model"):
        pose = saved.get(model.get("name"))
        if pose is not None:
            for old in model.findall("pose"):
                model.remove(old)
            model.append(pose)


def _model(world: _World, model: ET.Element, place: Floats, name: str, *, still: bool) -> None:
    """Collect the shapes of a model and of the models in it.

    Args:
        world: Where they are collected.
        model: The element.
        place: (4, 4) its pose in the world.
        name: Its name in the world.
        still: Whether a model around it does not move.
    """
    still = still or (model.findtext("static") or "").strip().lower() in ("true", "1")
    if not still and (model.find(".//plugin") is not None or model.find(".//sensor") is not None):
        world.leave("a moving model with sensors or plug-ins is a robot", name)
        return
    file = Path(model.get("file", world.path))
    frames = Frames(file, model)
    for link in model.iterfind("link"):
        at = place @ frames.place(link)
        shapes = link.findall("collision") or link.findall("visual")
        for shape in shapes:
            _shape(world, file, shape, at @ _in_link(file, frames, link, shape), f"{name}/{shape.get('name', '')}")
    for child in model.iterfind("model"):
        _model(world, child, place @ frames.place(child), f"{name}/{child.get('name', '')}", still=still)


def _in_link(file: Path, frames: Frames, link: ET.Element, shape: ET.Element) -> Floats:
    """(4, 4) pose of a shape in the frame of its link."""
    pose = shape.find("pose")
    given = pose_of(file, pose)
    relative = pose.get("relative_to") if pose is not None else None
    if not relative or relative == link.get("name"):
        return given
    result: Floats = np.linalg.inv(frames.place(link)) @ frames.named(relative) @ given
    return result


def _shape(world: _World, file: Path, shape: ET.Element, place: Floats, name: str) -> None:
    """Collect the outline of a collision or a visual."""
    for geometry in shape.iterfind("geometry/*"):
        kind = geometry.tag
        if kind == "plane":
            if abs(_turned(place, find_numbers(file, geometry.find("normal"), 3, (0, 0, 1)))[2]) < 0.9:
                world.leave("planes have no end", name)
            continue
        if kind in ("mesh", "polyline"):
            read_one = _mesh if kind == "mesh" else _polyline
            region = read_one(world, file, geometry, place, name)
        elif kind in _CONVEX:
            region = slices.slice_of_hull(
                slices.moved(place, _CONVEX[kind](file, geometry)), *world.band, rings=kind != "box"
            )
        else:
            if kind != "empty":
                world.leave(f"shapes of the kind {clean(kind, 30)} are not read", name)
            continue
        radius = find_number(file, geometry, "radius") if kind == "cylinder" else None
        world.add(name, region, place, radius)


def _turned(place: Floats, direction: list[float]) -> Floats:
    turned: Floats = place[:3, :3] @ (np.array(direction) / (np.linalg.norm(direction) or 1.0))
    return turned


def _size(file: Path, element: ET.Element) -> Floats:
    return slices.box_points(np.array(find_numbers(file, element.find("size"), 3)))


def _round(file: Path, element: ET.Element) -> tuple[float, float]:
    return find_number(file, element, "radius"), find_number(file, element, "length")


_CONVEX: dict[str, Any] = {
    "box": _size,
    "cylinder": lambda file, element: slices.cylinder_points(*_round(file, element)),
    "cone": lambda file, element: slices.cylinder_points(*_round(file, element), 0.0),
    "capsule": lambda file, element: slices.capsule_points(*_round(file, element)),
    "sphere": lambda file, element: slices.ellipsoid_points(np.full(3, find_number(file, element, "radius"))),
    "ellipsoid": lambda file, element: slices.ellipsoid_points(np.array(find_numbers(file, element.find("radii"), 3))),
}
"""Corners of the shapes that are convex."""


def _polyline(world: _World, file: Path, geometry: ET.Element, place: Floats, name: str) -> Any:
    """The outline of an upright prism; an outline within another one is a hole."""
    low, high = world.band
    height = find_number(file, geometry, "height", 1.0)
    points = [find_numbers(file, point, 2) for point in geometry.iterfind("point")]
    if abs(place[2, 2]) < 1 - UPRIGHT:
        solid = np.array([[x, y, z] for x, y in points for z in (0.0, height)])
        world.leave("tilted, so that its hull was taken", name)
        return slices.slice_of_hull(slices.moved(place, solid), low, high)
    ends = sorted((float(place[2, 3]), float(place[2, 3] + place[2, 2] * height)))
    if len(points) < 3 or ends[1] <= low or ends[0] >= high:
        return None
    flat = np.column_stack([np.array(points), np.zeros(len(points))])
    return shapely.make_valid(shapely.Polygon(slices.moved(place, flat)[:, :2]))


def _mesh(world: _World, file: Path, geometry: ET.Element, place: Floats, name: str) -> Any:
    """The outline of a mesh in a file, which is named if it cannot be read."""
    uri = (geometry.findtext("uri") or "").strip()
    located = find_file(uri, file, world.options.root, world.limits)
    if located is None or not located.is_file():
        world.leave("the mesh is not here, --root names the folder that holds it", uri)
        return None
    if located.suffix.lower() not in mesh.KIND.suffixes:
        world.leave(f"meshes are read from {', '.join(mesh.KIND.suffixes)}", uri)
        return None
    triangles = read_named_mesh(located, world.limits, lambda why: world.leave(why, uri))
    if triangles is None:
        return None
    world.parts.append(located)
    scale = np.array(find_numbers(file, geometry.find("scale"), 3, (1, 1, 1)))
    points = np.asarray(triangles, dtype=np.float64).reshape(-1, 3) * scale
    return slices.slice_of_mesh(slices.moved(place, points).reshape(-1, 3, 3), *world.band)


KIND = Kind(
    name="sdf",
    title="a world of Gazebo",
    suffixes=(".sdf", ".world"),
    read=read,
    unknown="free",
    unused=("slope", "ground", "up", "rotate", "level", "meters_per_unit", "opacity", "lanes"),
    roots=("sdf", "gazebo", "world"),
)
