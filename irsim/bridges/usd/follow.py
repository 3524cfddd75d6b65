"""Prims of a stage that follow poses: of states of irsim, or of ROS 2 messages.

This file stands alone: it needs ``pxr`` and nothing else, neither irsim nor packages of a vendor, so that it can be
copied to where another program's Python finds it. :mod:`irsim.bridges.usd.isaac` is what Isaac Sim needs around it.

Values go to the session layer. They cover animations of the stage, and are gone when it is closed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["Follower", "frame_name", "yaw_of_quaternion"]


class Follower:
    """Moves prims of a stage.

    Args:
        stage: The stage, such as ``omni.usd.get_context().get_stage()``.
        prims: Name of an object -> path of the prim that follows it; default: all prims with the custom data
            ``irsim:name`` and ``irsim:id``, which exported stages have.
        transform: Four rows of four numbers that map points of irsim to the stage; default: they are the same.

    Attributes:
        paths: Name of an object -> path of its prim.
        unknown: Names that came and have no prim.
    """

    def __init__(
        self,
        stage: Any,
        prims: Mapping[str, str] | None = None,
        transform: Sequence[Sequence[float]] | None = None,
    ) -> None:
        self.stage, self.unknown = stage, set[str]()
        self.paths: dict[str, str] = {}
        self._by_id: dict[int, str] = {}
        self._alike: dict[str, str] = {}
        self._shown: dict[str, bool] = {}
        self._yaw: dict[str, float] = {}
        self._transform = None if transform is None else [[float(v) for v in row] for row in transform]
        if prims is not None:
            self.paths = dict(prims)
            self._alike = {_plain(name): path for name, path in prims.items()}
            missing = [path for path in self.paths.values() if not stage.GetPrimAtPath(path)]
            if missing:
                raise ValueError(f"the stage has no prim {missing[0]}")
            return
        for prim in stage.Traverse():
            name = prim.GetCustomDataByKey("irsim:name")
            if name is not None:
                path = str(prim.GetPath())
                self.paths[str(name)] = self._by_id[int(prim.GetCustomDataByKey("irsim:id"))] = path
                self._alike.setdefault(_plain(str(name)), path)

    def place(self, name: str, x: float, y: float, yaw: float, z: float | None = None) -> bool:
        """Put an object somewhere and show it; with NaN, hide it. Whether it has a prim.

        Args:
            name: Name of the object.
            x: [m].
            y: [m], frame of irsim.
            yaw: [rad], frame of irsim.
            z: Height [m]; default: the prim's.
        """
        path = self.paths.get(name) or self._alike.get(_plain(name))
        if path is None:
            self.unknown.add(name)
            return False
        self._place(path, x, y, yaw, z)
        return True

    def _place(self, path: str, x: float, y: float, yaw: float, z: float | None = None) -> None:
        from pxr import Gf, Usd

        if not all(map(math.isfinite, (x, y, yaw))):
            self._show(path, False)
            return
        if self._transform is not None:
            x, y, height, yaw = _moved(self._transform, x, y, yaw)
            z = height if z is None else z
        before = self._yaw.get(path, yaw)
        yaw = before + math.remainder(yaw - before, math.tau)
        self._yaw[path] = yaw
        with Usd.EditContext(self.stage, self.stage.GetSessionLayer()):
            translate, rotate = _operations(self.stage.GetPrimAtPath(path))
            kept = translate.Get()
            translate.Set(Gf.Vec3d(x, y, (kept[2] if kept is not None else 0.0) if z is None else z))
            rotate.Set(math.degrees(yaw))
        self._show(path, True)

    def state(self, poses: Sequence[Sequence[float]]) -> None:
        """Follow a state of irsim: rows x, y [m], yaw [rad] of all objects, in the order of their ids."""
        for number, (x, y, yaw) in enumerate(poses):
            if number in self._by_id:
                self._place(self._by_id[number], float(x), float(y), float(yaw))

    def pose_array(self, message: Any, names: Sequence[str]) -> None:
        """Follow a ``geometry_msgs/PoseArray`` whose poses belong to these names."""
        for name, pose in zip(names, message.poses, strict=False):
            where = pose.position
            self.place(name, where.x, where.y, yaw_of_quaternion(pose.orientation))

    def transforms(self, message: Any, parent: str | None = None) -> None:
        """Follow a ``tf2_msgs/TFMessage``, whose child frames are ``<name>/base_link``.

        Args:
            message: The message.
            parent: Take only transforms from this frame; default: from any.
        """
        for item in message.transforms:
            name = frame_name(item.child_frame_id)
            if name is None or (parent is not None and item.header.frame_id.lstrip("/") != parent):
                continue
            moved = item.transform.translation
            self.place(name, moved.x, moved.y, yaw_of_quaternion(item.transform.rotation))

    def release(self) -> None:
        """Remove what was written, so that the animation of the stage shows again."""
        for path in self.paths.values():
            spec = self.stage.GetSessionLayer().GetPrimAtPath(path)
            for attribute in list(spec.properties) if spec else []:
                spec.RemoveProperty(attribute)
        self._shown.clear()
        self._yaw.clear()

    def _show(self, path: str, shown: bool) -> None:
        if self._shown.get(path) == shown:
            return
        from pxr import Usd, UsdGeom

        with Usd.EditContext(self.stage, self.stage.GetSessionLayer()):
            seen = UsdGeom.Imageable(self.stage.GetPrimAtPath(path)).CreateVisibilityAttr()
            seen.Set("inherited" if shown else "invisible")
        self._shown[path] = shown


def frame_name(frame: str) -> str | None:
    """The object of a frame ``<name>/base_link``; None for other frames, such as a lidar's."""
    name, _, rest = frame.lstrip("/").rpartition("/")
    return name if name and rest == "base_link" else None


def yaw_of_quaternion(q: Any) -> float:
    """Yaw [rad] of a quaternion with the attributes x, y, z, w."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def _plain(name: str) -> str:
    """A name as topics and frames of ROS have it."""
    return re.sub(r"[^A-Za-z0-9_]", "_", name)


def _moved(transform: list[list[float]], x: float, y: float, yaw: float) -> tuple[float, float, float, float]:
    """Place, height and yaw after a transform."""
    place = [row[0] * x + row[1] * y + row[3] for row in transform[:3]]
    ahead = [row[0] * math.cos(yaw) + row[1] * math.sin(yaw) for row in transform[:2]]
    return place[0], place[1], place[2], math.atan2(ahead[1], ahead[0])


def _operations(prim: Any) -> tuple[Any, Any]:
    """The operations that place a prim and turn it about z; made where they are missing."""
    from pxr import UsdGeom

    placed = UsdGeom.Xformable(prim)
    result = {operation.GetOpName(): operation for operation in placed.GetOrderedXformOps()}
    translate, rotate = result.get("xformOp:translate"), result.get("xformOp:rotateZ")
    if translate is not None and rotate is not None:
        return translate, rotate
    placed.ClearXformOpOrder()
    double = UsdGeom.XformOp.PrecisionDouble
    kept = [operation for name, operation in result.items() if name.startswith("xformOp:scale")]
    made = translate or placed.AddTranslateOp(double), rotate or placed.AddRotateZOp(double)
    placed.SetXformOpOrder([*made, *kept])
    return made
