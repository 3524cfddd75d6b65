"""Files that a world of Gazebo names, and where its models, links and frames are."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from pathlib import Path, PurePosixPath

import numpy as np

from irsim.bridges.frames import turn_of
from irsim.bridges.maps.named_files import readable
from irsim.bridges.maps.source import ImportLimits, unusable
from irsim.bridges.maps.xml_files import find_numbers, read_xml
from irsim.common.arrays import Floats

__all__ = ["Frames", "find_file", "model_of", "pose_of"]

_VARIABLES = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH")


def pose_of(path: Path, element: ET.Element | None) -> Floats:
    """(4, 4) transform of an element ``<pose>``: x, y, z [m], and roll, pitch, yaw or a quaternion."""
    result = np.eye(4)
    if element is None or not (element.text or "").strip():
        return result
    if element.get("rotation_format") == "quat_xyzw":
        *result[:3, 3], x, y, z, w = find_numbers(path, element, 7)
        length = math.hypot(x, y, z, w) or 1.0
        x, y, z, w = x / length, y / length, z / length, w / length
        result[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        return result
    values = find_numbers(path, element, 6)
    degrees = element.get("degrees", "false").lower() in ("true", "1")
    result[:3, 3] = values[:3]
    result[:3, :3] = turn_of(*(np.radians(values[3:]) if degrees else values[3:]))
    return result


class Frames:
    """The frames of a model or a world, which their names are resolved in.

    Args:
        path: The file, for messages.
        scope: The element ``<model>`` or ``<world>``; included models stand in it already.
    """

    def __init__(self, path: Path, scope: ET.Element) -> None:
        self.path, self.scope = path, scope
        self._named = {item.get("name", ""): item for item in scope if item.tag in ("link", "frame", "joint", "model")}
        self._known: dict[str, Floats] = {}
        self._open: set[str] = set()

    def place(self, element: ET.Element, parent: str = "") -> Floats:
        """(4, 4) pose of a link, a frame, a joint, or a model, in the frame of the scope.

        Args:
            element: The element.
            parent: Name of the frame that its pose is relative to if it does not say; empty for the scope.

        Raises:
            BridgeError: A frame is not there, or frames are relative to each other in a circle.
        """
        pose = element.find("pose")
        given = pose_of(self.path, pose)
        relative = (pose.get("relative_to") if pose is not None else None) or parent
        base = self.named(relative) if relative else np.eye(4)
        result: Floats = base @ given
        if element.tag == "model":
            inner = element.get("placement_frame")
            if inner:
                result = result @ np.linalg.inv(Frames(self.path, element).named(inner))
        return result

    def named(self, name: str) -> Floats:
        """(4, 4) pose of the frame of a name, such as ``arm::hand``, in the frame of the scope."""
        if name in ("__model__", "world", "__root__"):
            return np.eye(4)
        if name in self._known:
            return self._known[name]
        if name in self._open or len(self._open) > 200:
            raise unusable(self.path, f"the frame '{name[:60]}' is relative to itself")
        self._open.add(name)
        first, _, rest = name.partition("::")
        element = self._named.get(name) if name in self._named else self._named.get(first)
        if element is None:
            raise unusable(self.path, f"'{self.scope.get('name', '?')[:60]}' has no frame '{name[:60]}'")
        if element.tag == "joint":
            parent = (element.findtext("child") or "").strip()
        else:
            parent = (element.get("attached_to") or "") if element.tag == "frame" else ""
        result = self.place(element, parent)
        if rest and name not in self._named:
            result = result @ Frames(self.path, element).named(rest)
        self._open.discard(name)
        self._known[name] = result
        return result


def find_file(uri: str, beside: Path, root: str | None, limits: ImportLimits) -> Path | None:
    """The file or folder of a ``<uri>``; None if it is not there.

    It is looked for beside the file, in the root, and in the folders of Gazebo's variables, and lies within one of
    them. Nothing is fetched: models of an address are looked for by their name.

    Args:
        uri: Such as ``model://table/meshes/table.stl``, ``meshes/table.stl`` or ``file://...``.
        beside: The file that names it.
        root: A folder with models; None for none.
        limits: Limits of the import; if they have a root, Gazebo's variables are ignored.
    """
    scheme, matches, rest = uri.strip().partition("://")
    name = rest if matches else scheme
    folders = [Path(root)] if root else []
    if limits.root is None:
        folders += [Path(one) for key in _VARIABLES for one in os.environ.get(key, "").split(os.pathsep) if one]
    folders += [folder / "models" for folder in list(folders)]
    here = beside.resolve().parent
    parts = [part for part in PurePosixPath(name.replace("\\", "/")).parts if part != "/"]
    if scheme.lower() in ("http", "https") and matches:
        parts = parts[-1:]
    tried = [] if matches and scheme != "file" else [(here, here / name)]
    tried += [(here, here.joinpath(*parts[1:]))] if matches and parts[:1] == [here.name] else []
    tried += [(folder, folder.joinpath(*parts)) for folder in folders]
    files = (readable(candidate, [folder]) for folder, candidate in tried)
    return next((file for file in files if file is not None), None)


def model_of(path: Path, limits: ImportLimits) -> tuple[Path, ET.Element] | None:
    """The file of a model, and its element; None if a folder has no model.

    Args:
        path: The file, or the folder with ``model.config`` or ``model.sdf``.
        limits: How large it may be.
    """
    if path.is_dir():
        config = path / "model.config"
        names = [item.text or "" for item in read_xml(config, limits).iter("sdf")] if config.is_file() else []
        files = [path / name.strip() for name in reversed(names) if name.strip()] + [path / "model.sdf"]
        path = next((file for file in files if file.is_file() and file.resolve().parent == path), path)
    if not path.is_file():
        return None
    root = read_xml(path, limits)
    model = root if root.tag == "model" else root.find("model")
    return None if model is None else (path, model)
