"""Shapes as objects with shapely geometries: what ``robot.gf`` is."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
import shapely
from shapely.affinity import affine_transform

from irsim.common.arrays import Floats
from irsim.compat.functions.polygons import polygon_inequality, random_generate_polygon
from irsim.simulation.active_env import current_rng

__all__ = [
    "CircleGeometry",
    "CompoundGeometry",
    "GeometryFactory",
    "LinestringGeometry",
    "PointsGeometry",
    "PolygonGeometry",
    "RectangleGeometry",
    "geometry_handler",
    "handler_of",
]

Inequality = tuple[Floats | None, Floats | None, str | None, bool | None]
_NOT_CONVEX: Inequality = (None, None, None, False)
_NO_AREA: Inequality = (None, None, None, None)
_SQUARE = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
_RANDOM_KEYS = ("center_range", "avg_radius_range", "irregularity_range", "spikeyness_range", "num_vertices_range")


class geometry_handler:
    """A shape in its body frame, and its geometry at the pose of the last :meth:`step`.

    Args:
        name: Name of the shape.
        **kwargs: Keys of its YAML mapping.

    Attributes:
        geometry: Shapely geometry at the pose of the last :meth:`step`, world frame.
        length, width: Extent along x and y of the body frame [m].
        wheelbase: Distance of the axles [m], or None.
    """

    init_vertices: None = None
    kind = ""
    """Default name."""

    def __init__(self, name: str | None = None, **kwargs: Any) -> None:
        self.name = name or self.kind
        self.wheelbase: float | None = kwargs.get("wheelbase")
        self._original = self.construct_original_geometry(**kwargs)
        self.geometry: Any = self._original
        self.length, self.width = self.cal_length_width(self._original)
        self.radius = float(shapely.minimum_bounding_radius(self._original))

    def construct_original_geometry(self, *args: Any, **kwargs: Any) -> Any:
        """Return the shapely geometry in the body frame."""
        raise NotImplementedError

    @staticmethod
    def cal_length_width(geometry: Any) -> tuple[float, float]:
        """Return the extent of a geometry along x and y [m]."""
        low_x, low_y, high_x, high_y = geometry.bounds
        return high_x - low_x, high_y - low_y

    def step(self, state: Floats) -> Any:
        """Move the shape to a pose.

        Args:
            state: (3 or more, 1) x, y [m], heading [rad].

        Returns:
            The shapely geometry at that pose.
        """
        self.geometry = _placed(self._original, state)
        return self.geometry

    @property
    def vertices(self) -> Floats | None:
        """(2, M) outline at the pose of the last :meth:`step`; None for a compound."""
        return _outline(self.geometry)

    @property
    def original_vertices(self) -> Floats | None:
        """(2, M) outline in the body frame; None for a compound."""
        return _outline(self._original)

    @property
    def original_centroid(self) -> Floats:
        """(2, 1) centroid in the body frame."""
        point = self._original.centroid
        return np.array([[point.x], [point.y]])

    def get_init_Gh(self) -> Inequality:
        """Return the matrices of ``G p <= h`` in the body frame, the cone, and whether the shape is convex."""
        vertices = self.original_vertices
        return _NOT_CONVEX if vertices is None else self.get_polygon_Gh(vertices)

    def get_Gh(self, **kwargs: Any) -> Inequality:
        """Return the matrices of ``G p <= h`` for the given vertices.

        Args:
            **kwargs: ``vertices``, (2, M).
        """
        vertices = kwargs.get("vertices")
        return _NOT_CONVEX if vertices is None else self.get_polygon_Gh(np.asarray(vertices))

    def get_polygon_Gh(self, vertices: Floats | None = None) -> Inequality:
        """Return the matrices of ``G p <= h`` for a convex polygon (2, M): outward normals, cone ``Rpositive``."""
        inequality = None if vertices is None else polygon_inequality(np.asarray(vertices, dtype=np.float64).T)
        return _NOT_CONVEX if inequality is None else (*inequality, "Rpositive", True)

    def get_circle_Gh(self, center: Floats, radius: float) -> Inequality:
        """Return the matrices of ``G p <= h`` for a disc, in the cone ``norm2``."""
        x, y = np.asarray(center, dtype=np.float64).reshape(-1)[:2]
        return np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), np.array([[x], [y], [-float(radius)]]), "norm2", True


class CircleGeometry(geometry_handler):
    """A disc, as a polygon of 64 vertices."""

    kind = "circle"

    def construct_original_geometry(
        self,
        radius: float = 0.2,
        center: Any = None,
        random_shape: bool = False,
        radius_range: Any = None,
        wheelbase: float | None = None,
    ) -> Any:
        """Return the polygon in the body frame."""
        if random_shape:
            radius = float(current_rng().uniform(*(radius_range or [0.1, 1.0])))
        x, y = center or [0.0, 0.0]
        return shapely.Point(x + (wheelbase or 0.0) / 2, y).buffer(radius, quad_segs=16)

    def get_init_Gh(self) -> Inequality:
        """Return the matrices of ``G p <= h`` in the body frame."""
        return self.get_circle_Gh(self.original_centroid, self.radius)

    def get_Gh(self, **kwargs: Any) -> Inequality:
        """Return the matrices of ``G p <= h`` for the given disc.

        Args:
            **kwargs: ``center``, (2, 1), and ``radius`` [m].

        Raises:
            TypeError: An argument is missing.
        """
        if kwargs.get("center") is None or kwargs.get("radius") is None:
            raise TypeError("a disc needs `center` and `radius`")
        return self.get_circle_Gh(kwargs["center"], kwargs["radius"])


class RectangleGeometry(geometry_handler):
    """A rectangle about the origin, or with the origin on the rear axle where there is a wheelbase."""

    kind = "rectangle"

    def construct_original_geometry(
        self, length: float = 1.0, width: float = 1.0, wheelbase: float | None = None
    ) -> Any:
        """Return the polygon in the body frame."""
        rear = -length / 2 if wheelbase is None else -(length - wheelbase) / 2
        half = width / 2
        return shapely.Polygon([(rear, -half), (rear + length, -half), (rear + length, half), (rear, half)])


class PolygonGeometry(geometry_handler):
    """A polygon by its vertices, or a random one."""

    kind = "polygon"

    def construct_original_geometry(
        self, vertices: Any = None, random_shape: bool = False, is_convex: bool = False, **kwargs: Any
    ) -> Any:
        """Return the polygon in the body frame."""
        if random_shape:
            vertices = _random_vertices(is_convex, kwargs)
        return shapely.Polygon(_SQUARE if vertices is None else np.asarray(vertices, dtype=np.float64))


class _LineGeometry(geometry_handler):
    """A shape without area."""

    def get_init_Gh(self) -> Inequality:
        """Return None for each value, because a line has no interior."""
        return _NO_AREA

    def get_Gh(self, **kwargs: Any) -> Inequality:
        """Return None for each value, because a line has no interior."""
        return _NO_AREA


class LinestringGeometry(_LineGeometry):
    """An open polyline."""

    kind = "linestring"

    def construct_original_geometry(
        self, vertices: Any = None, random_shape: bool = False, is_convex: bool = True, **kwargs: Any
    ) -> Any:
        """Return the line in the body frame."""
        if random_shape:
            vertices = _random_vertices(is_convex, kwargs)
        if vertices is None:
            raise TypeError("a linestring needs `vertices`")
        return shapely.LineString(np.asarray(vertices, dtype=np.float64))


class CompoundGeometry(geometry_handler):
    """The union of circles, rectangles and polygons."""

    _parts: ClassVar[tuple[str, ...]] = ("circle", "rectangle", "polygon")

    kind = "compound"

    def __init__(self, name: str | None = None, **kwargs: Any) -> None:
        self._pieces: list[Any] = []
        self._placed: list[Any] = []
        super().__init__(name, **kwargs)

    def construct_original_geometry(self, parts: Any = None, **kwargs: Any) -> Any:
        """Return the union of the parts in the body frame."""
        if not parts:
            raise ValueError("a compound has at least one part")
        for part in parts:
            keys = dict(part)
            kind, pose = str(keys.pop("name", "circle")).lower(), keys.pop("pose", [0.0, 0.0, 0.0])
            if kind not in self._parts:
                raise ValueError(f"a part is one of {', '.join(self._parts)}, not {kind!r}")
            made = GeometryFactory.create_geometry(kind, **keys)
            self._pieces.append(made.step(np.array(pose, dtype=np.float64)[:, None]))
        self._placed = list(self._pieces)
        return shapely.union_all(self._pieces)

    def step(self, state: Floats) -> Any:
        """Move the shape to a pose; see :meth:`geometry_handler.step`."""
        self._placed = [_placed(piece, state) for piece in self._pieces]
        return super().step(state)

    @property
    def vertices(self) -> None:
        """A compound has no single outline."""
        return None

    @property
    def original_vertices(self) -> None:
        """A compound has no single outline."""
        return None

    @property
    def part_vertices(self) -> list[Floats | None]:
        """(2, M) outline of each part at the pose of the last :meth:`step`."""
        return [_outline(piece) for piece in self._placed]

    @property
    def original_part_vertices(self) -> list[Floats | None]:
        """(2, M) outline of each part in the body frame."""
        return [_outline(piece) for piece in self._pieces]


class PointsGeometry(_LineGeometry):
    """The outlines of square cells about points, of a map."""

    kind = "map"

    def construct_original_geometry(self, points: Any = None, reso: Any = 0.1, **kwargs: Any) -> Any:
        """Return the boundary of the union of the cells."""
        size = np.broadcast_to(np.asarray(reso, dtype=np.float64).reshape(-1), (2,)) / 2
        cells = [shapely.box(x - size[0], y - size[1], x + size[0], y + size[1]) for x, y in np.asarray(points).T]
        outline: Any = shapely.union_all(cells).boundary
        return outline if outline.geom_type == "MultiLineString" else shapely.MultiLineString([outline])


_KINDS: dict[str, type[geometry_handler]] = {
    maker.kind: maker
    for maker in (
        CircleGeometry,
        CompoundGeometry,
        LinestringGeometry,
        PointsGeometry,
        PolygonGeometry,
        RectangleGeometry,
    )
}


class GeometryFactory:
    """Creates handlers by the name of the shape."""

    @staticmethod
    def create_geometry(name: str = "circle", **kwargs: Any) -> Any:
        """Create the handler of a shape.

        Args:
            name: Name of the shape, in upper or lower case.
            **kwargs: Keys of its YAML mapping.

        Raises:
            ValueError: There is no such shape. TypeError: It has no such key.
        """
        kind = name.lower()
        if kind not in _KINDS:
            raise ValueError(f"unknown shape {name!r}: choose one of {', '.join(_KINDS)}")
        maker: Any = _KINDS[kind]
        return maker(kind, **kwargs)


class _BodyGeometry(geometry_handler):
    """The geometry of an object of a simulation."""

    def construct_original_geometry(self, *args: Any, **kwargs: Any) -> Any:
        """Return the geometry that the handler was created with."""
        return kwargs["body"]


class _DiscBody(_BodyGeometry, CircleGeometry):
    pass


class _LineBody(_BodyGeometry, _LineGeometry):
    pass


def handler_of(view: Any) -> geometry_handler:
    """Return the shape of an object at its current pose."""
    kinds: dict[str, type[geometry_handler]] = {"circle": _DiscBody, "linestring": _LineBody}
    maker: Any = kinds.get(view.shape, _BodyGeometry)
    made: geometry_handler = maker(view.shape, body=view.original_geometry, wheelbase=view.wheelbase)
    made.step(view.state)
    return made


def _random_vertices(is_convex: bool, keys: dict[str, Any]) -> Any:
    chosen = {key: keys[key] for key in _RANDOM_KEYS if key in keys}
    if is_convex:
        chosen.setdefault("spikeyness_range", [0, 0])
    return random_generate_polygon(**chosen)


def _placed(geometry: Any, state: Floats) -> Any:
    x, y, theta = np.asarray(state, dtype=np.float64).reshape(-1)[:3]
    cosine, sine = math.cos(theta), math.sin(theta)
    return affine_transform(geometry, [cosine, -sine, sine, cosine, x, y])


def _outline(geometry: Any) -> Floats | None:
    """Return the (2, M) vertices of a line, or of a polygon without its repeated last vertex."""
    if geometry.geom_type == "LineString":
        return np.asarray(geometry.coords, dtype=np.float64).T[:2]
    if geometry.geom_type != "Polygon":
        return None
    return np.asarray(geometry.exterior.coords, dtype=np.float64).T[:2, :-1]
