"""Path planners, with the class and argument names of IR-SIM 2.12."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.compat.search_drawing import draw_search
from irsim.navigation.map import Cells, EnvGridMap, cells_of, footprint_of, terrain_of
from irsim.simulation.random_streams import check_seed, fresh_seed

__all__ = ["RRT", "AStarPlanner", "InformedRRTStar", "JPSPlanner", "PRMPlanner", "PathNode", "PathPlanner", "RRTStar"]

_DRAWS_PER_CALL = 2**40
"""Distance in the random stream between the first draws of two calls, so that calls never share draws."""
_MIN_POINT_NUMBERS = 2


@dataclass(eq=False, slots=True)
class PathNode:
    """A point that a planner has visited.

    Attributes:
        x, y: Position [m].
        cost: Length of the path from the start [m].
        parent: Node from which this node was reached.
    """

    x: float
    y: float
    cost: float = 0.0
    parent: PathNode | None = None


class PathPlanner:
    """Base class of the planners.

    Args:
        env_map: Result of ``env.get_map()``, or a :class:`irsim.navigation.map.Map`.
        robot: Robot whose footprint at heading 0 must fit: an object, or a shapely geometry in the body frame.
        smooth: Remove each point of a path that a straight line can bypass.
        seed: Seed for planners that draw samples; default: the planner stream of the environment.

    Attributes:
        start, end: First and last node; ``end.cost`` is the length of the last path [m], infinite without a path.
        node_list: All nodes of the last search.
    """

    def __init__(
        self, env_map: EnvGridMap, robot: Any = None, *, smooth: bool = False, seed: int | None = None
    ) -> None:
        self.map = env_map
        self.robot = robot
        self.smooth = smooth
        self.start, self.end = PathNode(0.0, 0.0), PathNode(0.0, 0.0, float("inf"))
        self.node_list: list[PathNode] = []
        key = getattr(env_map, "seed", None)
        if seed is not None or key is None:
            key = (fresh_seed() if seed is None else check_seed(seed), 0, 0)
        self._key: tuple[int, int, int] = key
        self._object = int(getattr(robot, "id", 0))
        self._calls = itertools.count()

    def planning(self, start_pose: Any, goal_pose: Any, show_animation: bool = True) -> Floats | None:
        """Search for a path.

        Args:
            start_pose: At least two numbers, x and y [m], in an array or sequence of any shape.
            goal_pose: At least two numbers, x and y [m], in an array or sequence of any shape.
            show_animation: Draw nodes and path, if a figure exists.

        Returns:
            (2, N) points from the goal back to the start [m]; None if no path was found.
        """
        return self._plan(start_pose, goal_pose, self._key, show_animation)

    def _plan(self, start_pose: Any, goal_pose: Any, key: tuple[int, int, int], show_animation: bool) -> Floats | None:
        start, goal = _point(start_pose, "start"), _point(goal_pose, "goal")
        path, cost, nodes, parents, costs = terrain_of(self.map).plan(
            self._options(**{key: getattr(self, key) for key in self._keys}),
            parts=self._footprint(),
            heading=0.0,
            start=start,
            goal=goal,
            cells=self._cells(),
            key=key,
            object=self._object,
            first_draw=next(self._calls) * _DRAWS_PER_CALL,
            smooth=self.smooth,
        )
        self.start = PathNode(*start)
        self.end = PathNode(*goal, cost)
        self._nodes = nodes, parents, costs
        self.node_list = _link_nodes(nodes, parents, costs) if self._keeps_nodes else []
        points = None if path is None else np.ascontiguousarray(path[::-1].T)
        if show_animation:
            draw_search(self.map, nodes, parents, points, start, goal)
        return points

    _keeps_nodes = False
    _options: Any = None
    """Class of the options of the search in the core."""
    _keys: tuple[str, ...] = ()
    """Attributes that are options of the search."""

    def _footprint(self) -> list[Any]:
        return footprint_of(self.robot)

    def _cells(self) -> Cells:
        return cells_of(self.map)


class _GridPlanner(PathPlanner):
    """Planner on the cells of the map.

    Without ``robot``, the default robot of the map is used; without that one, the footprint is one cell.

    Attributes:
        resolution: Size of a cell along x [m]: the cell size of the grid, or else the resolution of the map. A
            resolution that does not divide the map is rounded, when planning, to the nearest one that does. A written
            value holds for this planner only, which then searches cells of that size; the map keeps its own.
        x_width, y_width: Number of cells along x and y; a written number holds until ``resolution`` is written.
    """

    _resolution: float | None = None
    _columns: int | None = None
    _rows: int | None = None

    @property
    def resolution(self) -> float:
        """Size of a cell along x [m]; may be written."""
        if self._resolution is not None and self._columns is None:
            return self._resolution
        planned_as_given = self.map.grid is None and self._columns is None
        return float(self.map.resolution if planned_as_given else self._cells()[1][0])

    @resolution.setter
    def resolution(self, metres: float) -> None:
        size = float(metres)
        if not (math.isfinite(size) and size > 0):
            raise ValueError(f"the resolution of a planner is a positive number [m], not {metres!r}")
        self._resolution, self._columns, self._rows = size, None, None

    @property
    def x_width(self) -> int:
        """Number of cells along x; may be written."""
        return self._cells()[2]

    @x_width.setter
    def x_width(self, cells: int) -> None:
        self._columns = _cell_count(cells)

    @property
    def y_width(self) -> int:
        """Number of cells along y; may be written."""
        return self._cells()[3]

    @y_width.setter
    def y_width(self, cells: int) -> None:
        self._rows = _cell_count(cells)

    def _cells(self) -> Cells:
        origin, (width, height), columns, rows = cells_of(self.map, self._resolution)
        extent = width * columns, height * rows
        columns, rows = self._columns or columns, self._rows or rows
        return origin, (extent[0] / columns, extent[1] / rows), columns, rows

    def _footprint(self) -> list[Any]:
        return footprint_of(self.robot if self.robot is not None else getattr(self.map, "robot", None))


class AStarPlanner(_GridPlanner):
    """Finds the shortest path over the eight neighbours of each cell; the start may be occupied."""

    _options = staticmethod(functools.partial(core.AstarOptions, resolution=0.0))


class JPSPlanner(_GridPlanner):
    """Finds paths as short as A* by jumping over cells without a choice; the start must be free."""

    _options = staticmethod(functools.partial(core.JpsOptions, resolution=0.0))


class RRT(PathPlanner):
    """Grows a tree of random extensions until it reaches the goal.

    Args:
        env_map: The map.
        robot: Robot whose footprint at heading 0 must fit.
        expand_dis: Longest extension [m].
        path_resolution: Extensions have a multiple of this length [m]; collisions are checked along their whole length.
        goal_sample_rate: Share of samples that are the goal itself [%].
        max_iter: Number of samples after which the search ends.
        smooth, seed: See :class:`PathPlanner`.
    """

    _keeps_nodes = True
    _options: Any = core.RrtOptions
    _keys: tuple[str, ...] = ("expand_dis", "path_resolution", "goal_sample_rate", "max_iter")

    def __init__(
        self,
        env_map: EnvGridMap,
        robot: Any,
        expand_dis: float = 1.0,
        path_resolution: float = 0.25,
        goal_sample_rate: float = 5,
        max_iter: int = 500,
        *,
        smooth: bool = False,
        seed: int | None = None,
    ) -> None:
        super().__init__(env_map, robot, smooth=smooth, seed=seed)
        if not (expand_dis > 0 and path_resolution > 0):
            raise ValueError("expand_dis and path_resolution must be positive")
        self.expand_dis, self.path_resolution = expand_dis, path_resolution
        self.goal_sample_rate, self.max_iter = goal_sample_rate, max_iter


class RRTStar(RRT):
    """RRT that rewires the tree around each new point, which shortens the path.

    Args:
        env_map, robot, expand_dis, path_resolution, goal_sample_rate, max_iter, smooth, seed: See :class:`RRT`.
        connect_circle_dist: Scale of the radius within which the tree is rewired [m].
        search_until_max_iter: Continue to improve the path until all samples are drawn, rather than stop at the first
            path.
    """

    _options: Any = core.RrtStarOptions
    _keys = (*RRT._keys, "connect_circle_dist", "search_until_max_iter")

    def __init__(
        self,
        env_map: EnvGridMap,
        robot: Any,
        expand_dis: float = 1.5,
        path_resolution: float = 0.25,
        goal_sample_rate: float = 5,
        max_iter: int = 500,
        connect_circle_dist: float = 0.5,
        search_until_max_iter: bool = False,
        *,
        smooth: bool = False,
        seed: int | None = None,
    ) -> None:
        super().__init__(
            env_map, robot, expand_dis, path_resolution, goal_sample_rate, max_iter, smooth=smooth, seed=seed
        )
        self.connect_circle_dist, self.search_until_max_iter = connect_circle_dist, search_until_max_iter


class InformedRRTStar(RRTStar):
    """RRT* that, after it has found a path, samples only the ellipse that can contain a shorter one.

    Args:
        env_map, robot, expand_dis, path_resolution, goal_sample_rate, max_iter, smooth, seed: See :class:`RRT`.
        connect_circle_dist, search_until_max_iter: See :class:`RRTStar`.
    """

    _options = core.InformedRrtStarOptions

    def __init__(
        self,
        env_map: EnvGridMap,
        robot: Any,
        expand_dis: float = 1.5,
        path_resolution: float = 0.25,
        goal_sample_rate: float = 10,
        max_iter: int = 500,
        connect_circle_dist: float = 50.0,
        search_until_max_iter: bool = True,
        *,
        smooth: bool = False,
        seed: int | None = None,
    ) -> None:
        super().__init__(
            env_map,
            robot,
            expand_dis,
            path_resolution,
            goal_sample_rate,
            max_iter,
            connect_circle_dist,
            search_until_max_iter,
            smooth=smooth,
            seed=seed,
        )


class PRMPlanner(PathPlanner):
    """Connects random free points to a graph and returns its shortest path.

    Args:
        env_map: The map.
        robot_radius: Radius of the disc that must fit [m].
        n_sample: Number of free points to draw.
        n_knn: Largest number of edges per point.
        max_edge_len: Longest edge [m].
        smooth, seed: See :class:`PathPlanner`.
    """

    _keeps_nodes = True
    _options = core.PrmOptions
    _keys = ("n_sample", "n_knn", "max_edge_len")

    def __init__(
        self,
        env_map: EnvGridMap,
        robot_radius: float,
        n_sample: int = 500,
        n_knn: int = 10,
        max_edge_len: float = 30.0,
        *,
        smooth: bool = False,
        seed: int | None = None,
    ) -> None:
        super().__init__(env_map, smooth=smooth, seed=seed)
        if not robot_radius >= 0:
            raise ValueError("robot_radius must not be negative")
        self.robot_radius = float(robot_radius)
        self.n_sample, self.n_knn, self.max_edge_len = n_sample, n_knn, max_edge_len

    def planning(  # type: ignore[override]  # the argument order of IR-SIM 2.12
        self, start_pose: Any, goal_pose: Any, rng: np.random.Generator | None = None, show_animation: bool = True
    ) -> Floats | None:
        """Search for a path.

        Args:
            start_pose: At least two numbers, x and y [m], in an array or sequence of any shape.
            goal_pose: At least two numbers, x and y [m], in an array or sequence of any shape.
            rng: Generator that the seed of the samples is drawn from; default: the seed of the planner.
            show_animation: Draw nodes and path, if a figure exists.

        Returns:
            (2, N) points from the goal back to the start [m]; None if no path was found.
        """
        key = self._key if rng is None else (int(rng.integers(2**63)), 0, 0)
        return self._plan(start_pose, goal_pose, key, show_animation)

    def _footprint(self) -> list[Any]:
        return [core.Circle(radius=self.robot_radius, center=(0.0, 0.0))]


def _cell_count(cells: Any) -> int:
    count = int(cells)
    if count != cells or count < 1:
        raise ValueError(f"the number of cells of a planner is a positive whole number, not {cells!r}")
    return count


def _point(pose: Any, what: str) -> tuple[float, float]:
    numbers = np.asarray(pose, dtype=np.float64).reshape(-1)
    if numbers.size < _MIN_POINT_NUMBERS or not np.isfinite(numbers[:2]).all():
        raise ValueError(f"the {what} of a path must have two finite numbers, x and y, got {pose!r}")
    return float(numbers[0]), float(numbers[1])


def _link_nodes(points: Floats, parents: NDArray[np.int32], costs: Floats) -> list[PathNode]:
    nodes = [PathNode(x, y, cost) for (x, y), cost in zip(points.tolist(), costs.tolist(), strict=True)]
    for node, parent in zip(nodes, parents.tolist(), strict=True):
        node.parent = nodes[parent] if parent >= 0 else None
    return nodes
