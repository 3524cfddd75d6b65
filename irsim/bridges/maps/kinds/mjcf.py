"""``mjcf``: models of MuJoCo (``.xml``): what a robot meets of their geoms, read from the XML without MuJoCo.

Geoms that touch count; a body without any counts by what is seen of it. Bodies that actuators or programs move are
robots, and stay out. Meshes count with their surface, where MuJoCo would take their hull.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irsim.bridges.maps import slices
from irsim.bridges.maps.kinds import mesh
from irsim.bridges.maps.kinds._mjcf_text import Classes, inside, numbers_of, place_of, rotation_along, whole_model
from irsim.bridges.maps.kinds._named_meshes import read_named_mesh
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlines, unusable
from irsim.bridges.maps.xml_files import Collection
from irsim.common.arrays import Floats
from irsim.common.text import clean

__all__ = ["KIND"]

_MAX_CORNERS = 2000
"""Corners of a mesh without faces, of which all pairs are looked at."""
_ENDS = ("joint", "jointinparent", "site", "refsite", "cranksite", "slidersite", "body", "tendon")
"""Attributes by which actuators name what they move."""


@dataclass(kw_only=True)
class _Model(Collection):
    """A model, and what is collected of it.

    Attributes:
        classes: The defaults.
        driven: Names of joints, sites and bodies that actuators move.
        meshes: Name of a mesh -> its element.
    """

    classes: Classes
    driven: set[str]
    meshes: dict[str, ET.Element]


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of the geoms of a model.

    Raises:
        BridgeError: The file is damaged, or includes what is not there or lies outside of its folder and the root.
    """
    root, parts = whole_model(path, options.root, limits)
    meshes = {item.get("name") or Path(item.get("file", "")).stem: item for item in root.iterfind("asset/mesh")}
    model = _Model(
        path=path,
        options=options,
        limits=limits,
        parts=parts,
        classes=Classes(path, root),
        driven=_driven(root),
        meshes=meshes,
    )
    for world in root.iterfind("worldbody"):
        _body(model, world, np.eye(4), "main", "")
    return model.outlines()


def _driven(root: ET.Element) -> set[str]:
    """Names of joints, sites and bodies that actuators move, by tendons as well."""
    names = {item.get(key, "") for actuator in root.iterfind("actuator/*") for key in _ENDS for item in [actuator]}
    for tendon in root.iterfind("tendon/*"):
        if tendon.get("name") in names:
            names |= {item.get(key, "") for item in tendon for key in ("joint", "site")}
    return names - {""}


def _body(model: _Model, body: ET.Element, place: Floats, childclass: str, name: str) -> None:
    """Collect the geoms of a body, or of a frame, and of what is in it.

    Args:
        model: Where they are collected.
        body: The element.
        place: (4, 4) its pose in the world.
        childclass: The class of what is in it.
        name: Its name.
    """
    childclass = body.get("childclass", childclass)
    moving = body.find("joint") is not None or body.find("freejoint") is not None
    if body.get("mocap") == "true":
        model.leave("a program moves it", name)
        return
    if moving and any(
        item.get("name") in model.driven for item in body.iter() if item.tag in ("joint", "site", "body")
    ):
        model.leave("a body that actuators move is a robot", name)
        return
    geoms = [(geom, model.classes.attributes(geom, childclass)) for geom in body.iterfind("geom")]
    touching = [one for one in geoms if one[1].get("contype") != "0" or one[1].get("conaffinity") != "0"]
    for number, (geom, given) in enumerate(touching or geoms):
        _geom(model, given, place, geom.get("name") or f"{name or 'world'}/{number}")
    for child in body:
        if child.tag in ("body", "frame"):
            inner = place @ place_of(model.path, model.classes, dict(child.attrib))
            _body(model, child, inner, childclass, child.get("name", name))
        elif child.tag in ("replicate", "attach", "composite", "flexcomp"):
            model.leave(f"<{child.tag}> is not read", child.get("name") or child.get("prefix") or name)


def _geom(model: _Model, given: dict[str, str], place: Floats, name: str) -> None:
    """Collect the outline of a geom by its attributes and the defaults of its class."""
    kind = given.get("type", "sphere")
    at = place @ place_of(model.path, model.classes, given)
    if kind == "plane":
        if at[2, 2] < 0.9:
            model.leave("planes have no end", name)
        return
    if kind == "mesh":
        region = _mesh(model, given.get("mesh", ""), at)
    elif kind not in _SIZES:
        model.leave(f"geoms of the type {clean(kind, 30)} are not read", name)
        return
    elif "mesh" in given:
        model.leave("shapes that are fitted to meshes are not read", name)
        return
    else:
        size = numbers_of(model.path, given, "size", 0)
        if "fromto" in given:
            ends = np.array(numbers_of(model.path, given, "fromto", 6)).reshape(2, 3)
            local = np.eye(4)
            local[:3, 3], local[:3, :3] = ends.mean(axis=0), rotation_along(ends[0] - ends[1])
            at, half = place @ local, float(np.linalg.norm(ends[0] - ends[1])) / 2
            size = [*size[:1], half] if kind in ("capsule", "cylinder") else [*size[:1], *size[:1], half]
        if len(size) < _SIZES[kind] or min(size[: _SIZES[kind]]) <= 0:
            raise unusable(model.path, f"the geom {clean(name, 60)} of the type {kind} has no size that fits")
        region = slices.slice_of_hull(slices.moved(at, _corners(kind, size)), *model.band, rings=kind != "box")
    model.add(name, region, at, size[0] if kind == "cylinder" else None)


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
"""Kinds of convex geoms, and how many numbers their size has: half of what they measure."""


def _corners(kind: str, size: list[float]) -> Floats:
    """(N, 3) corners of a convex geom in its own frame."""
    if kind == "box":
        return slices.box_points(2 * np.array(size[:3]))
    if kind == "cylinder":
        return slices.cylinder_points(size[0], 2 * size[1])
    if kind == "capsule":
        return slices.capsule_points(size[0], 2 * size[1])
    return slices.ellipsoid_points(np.array(size[:3]) if kind == "ellipsoid" else np.full(3, size[0]))


def _mesh(model: _Model, name: str, place: Floats) -> object:
    """The outline of a mesh; None if nothing of it is in the way, or if it cannot be read, which is noted."""
    element = model.meshes.get(name)
    if element is None:
        raise unusable(model.path, f"there is no mesh '{clean(name, 60)}'")
    given = model.classes.attributes(element, "main")
    scale = np.array(numbers_of(model.path, given, "scale", 3, (1, 1, 1)))
    moved = {key: given["ref" + key] for key in ("pos", "quat") if "ref" + key in given}
    reference = np.linalg.inv(place_of(model.path, model.classes, moved)).astype(np.float64)
    if "vertex" in given:
        points = np.array(numbers_of(model.path, given, "vertex", 0))
        if len(points) % 3:
            raise unusable(model.path, f"the corners of the mesh '{clean(name, 60)}' must have 3 numbers each")
        points = slices.moved(place, slices.moved(reference, points.reshape(-1, 3)) * scale)
        if 0 < len(points) <= _MAX_CORNERS:
            return slices.slice_of_hull(points, *model.band)
        model.leave(f"hulls have 1 to {_MAX_CORNERS:,} corners", name)
        return None
    source = _mesh_file(model, given.get("file", ""))
    if source is None:
        model.leave("the mesh is not here or of another kind, --root names the folder that holds it", name)
        return None
    triangles = read_named_mesh(source, model.limits, lambda why: model.leave(why, name))
    if triangles is None:
        return None
    model.parts.append(source)
    points = slices.moved(reference, np.asarray(triangles, dtype=np.float64).reshape(-1, 3)) * scale
    return slices.slice_of_mesh(slices.moved(place, points).reshape(-1, 3, 3), *model.band)


def _mesh_file(model: _Model, file: str) -> Path | None:
    """The file of a mesh in the folder of meshes of the model; None if it is not there."""
    folder = model.classes.compiler.get("meshdir", model.classes.compiler.get("assetdir", ""))
    source = inside(model.path.resolve().parent, Path(folder) / file, model.options.root)
    return source if source is not None and source.suffix.lower() in mesh.KIND.suffixes else None


KIND = Kind(
    name="mjcf",
    title="a model of MuJoCo",
    suffixes=(),
    read=read,
    unknown="free",
    unused=("slope", "ground", "up", "rotate", "level", "meters_per_unit", "opacity", "lanes"),
    roots=("mujoco",),
)
