"""The text of a model of MuJoCo: files that it includes, classes of defaults, and poses."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from irsim.bridges.maps.named_files import readable
from irsim.bridges.maps.source import ImportLimits, unusable
from irsim.bridges.maps.xml_files import find_numbers, read_xml
from irsim.common.arrays import Floats
from irsim.common.text import clean

__all__ = ["Classes", "inside", "numbers_of", "place_of", "rotation_along", "whole_model"]

_MAX_DEPTH = 256
"""Elements inside each other, over all files."""
_MAX_FILES = 1000
_TURNS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


def inside(folder: Path, name: Path, root: str | None) -> Path | None:
    """A file that a model names, if it is there, and in the folder of the model or in the root.

    Args:
        folder: The folder of the model.
        name: The path that the model gives.
        root: Folder with models; None for none.
    """
    folders = [folder, *([] if root is None else [Path(root)])]
    files = (readable(start / name, folders) for start in folders)
    return next((file for file in files if file is not None and file.is_file()), None)


def whole_model(path: Path, root: str | None, limits: ImportLimits) -> tuple[ET.Element, list[Path]]:
    """The element of a model with the content of included files in place of what includes them; and these files.

    Raises:
        BridgeError: A file is damaged, is not there, is included twice, or lies outside of the folder and the root.
    """
    model, parts = read_xml(path, limits), [path.resolve()]
    waiting = [(model, 0)]
    while waiting:
        element, depth = waiting.pop()
        if depth > _MAX_DEPTH:
            raise unusable(path, f"its elements are nested deeper than {_MAX_DEPTH}")
        number = 0
        while number < len(element):
            child = element[number]
            if child.tag != "include":
                waiting.append((child, depth + 1))
                number += 1
                continue
            name = child.get("file", "")
            included = inside(path.resolve().parent, Path(name), root)
            if included is None:
                fix = "put it beside the file, or name the folder that holds it with --root"
                raise unusable(path, f"it includes '{clean(name, 120)}', which is not here", fix)
            if included in parts or len(parts) > _MAX_FILES:
                raise unusable(path, f"'{clean(included.name, 100)}' is included twice")
            parts.append(included)
            element[number : number + 1] = list(read_xml(included, limits))
    return model, parts[1:]


def numbers_of(path: Path, given: dict[str, str], key: str, count: int, default: tuple[float, ...] = ()) -> list[float]:
    """The numbers of an attribute.

    Args:
        path: The file, for messages.
        given: The attributes.
        key: The name of the attribute.
        count: How many there must be; 0 for any number.
        default: Those without the attribute.

    Raises:
        BridgeError: There are others, or they are not finite numbers.
    """
    element = ET.Element(key)
    element.text = given.get(key, "")
    return find_numbers(path, element, count, default)


class Classes:
    """The defaults of a model, and how it gives angles.

    Args:
        path: The file, for messages.
        root: The element of the model.
    """

    def __init__(self, path: Path, root: ET.Element) -> None:
        self.path = path
        self.compiler: dict[str, str] = {}
        for element in root.iterfind("compiler"):
            self.compiler.update(element.attrib)
        self._known: dict[str, dict[str, dict[str, str]]] = {"main": {}}
        waiting = [(element, "") for element in root.iterfind("default")]
        while waiting:
            element, parent = waiting.pop(0)
            name = element.get("class", parent or "main")
            known = self._known.setdefault(
                name, {tag: dict(given) for tag, given in self._known[parent or "main"].items()}
            )
            for item in element:
                if item.tag == "default":
                    waiting.append((item, name))
                else:
                    known[item.tag] = _over(known.get(item.tag, {}), dict(item.attrib))

    def attributes(self, element: ET.Element, childclass: str) -> dict[str, str]:
        """The attributes of an element, with the defaults of its class.

        Raises:
            BridgeError: There is no such class.
        """
        name = element.get("class", childclass)
        if name not in self._known:
            raise unusable(self.path, f"<{element.tag}> has the class '{clean(name, 60)}', which is not there")
        return _over(self._known[name].get(element.tag, {}), dict(element.attrib))


def _over(base: dict[str, str], own: dict[str, str]) -> dict[str, str]:
    """Attributes, of which the own ones replace others, and a direction of any form replaces all forms."""
    if any(key in own for key in _TURNS):
        base = {key: value for key, value in base.items() if key not in _TURNS}
    return {**base, **own}


def place_of(path: Path, classes: Classes, given: dict[str, str]) -> Floats:
    """(4, 4) pose that attributes give: ``pos``, and a direction in one of five forms."""
    result = np.eye(4)
    result[:3, 3] = numbers_of(path, given, "pos", 3, (0, 0, 0))
    unit = 1.0 if classes.compiler.get("angle", "degree") == "radian" else math.pi / 180
    if "quat" in given:
        w, *axis = numbers_of(path, given, "quat", 4)
        result[:3, :3] = _turn(np.array(axis), 2 * math.atan2(float(np.linalg.norm(axis)), w))
    elif "axisangle" in given:
        *axis, angle = numbers_of(path, given, "axisangle", 4)
        result[:3, :3] = _turn(np.array(axis), angle * unit)
    elif "euler" in given:
        sequence = classes.compiler.get("eulerseq", "xyz")
        if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
            raise unusable(path, f"eulerseq is '{clean(sequence, 20)}', and must be three of the letters x, y, z")
        turned = np.eye(3)
        for letter, angle in zip(sequence, numbers_of(path, given, "euler", 3), strict=True):
            one = _turn(np.eye(3)["xyz".index(letter.lower())], angle * unit)
            turned = turned @ one if letter.islower() else one @ turned
        result[:3, :3] = turned
    elif "xyaxes" in given:
        x, y = np.array(numbers_of(path, given, "xyaxes", 6)).reshape(2, 3)
        x = x / (np.linalg.norm(x) or 1.0)
        y = y - x * (x @ y)
        y = y / (np.linalg.norm(y) or 1.0)
        result[:3, :3] = np.column_stack([x, y, np.cross(x, y)])
    elif "zaxis" in given:
        result[:3, :3] = rotation_along(np.array(numbers_of(path, given, "zaxis", 3)))
    return result


def _turn(axis: Floats, angle: float) -> Floats:
    """(3, 3) rotation by an angle about an axis of any length."""
    length = float(np.linalg.norm(axis))
    if not length:
        return np.eye(3)
    x, y, z = axis / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Floats = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return turned


def rotation_along(direction: Floats) -> Floats:
    """(3, 3) the smallest rotation that turns the axis z to a direction."""
    x, y, z = direction
    flat = math.hypot(x, y)
    if not flat:
        return np.eye(3) if z >= 0 else _turn(np.array([1.0, 0, 0]), math.pi)
    return _turn(np.array([-y, x, 0.0]), math.atan2(flat, z))
