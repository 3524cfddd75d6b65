"""Types of the compiled core (irsim/core): arrays in, arrays out; knows no YAML and no Python objects.

N objects per world, W worlds, R = N * W rows; row w * N + i is object i of world w. All arrays returned as properties
are writable views of the core's own memory (no copy), float64 unless said otherwise.
"""

from collections.abc import Sequence
from typing import ClassVar, overload

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.uint8]

class _Options:
    """Every options class: keyword-only constructor that wants every field, `fields` in declaration order."""

    fields: ClassVar[tuple[str, ...]]

# kinematics (one header each in core/kinematics/)
class DiffOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float]) -> None: ...

class OmniOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float]) -> None: ...

class OmniAngularOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float]) -> None: ...

class AckerOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float], mode: str, wheelbase: float, psi_max: float) -> None: ...

# behaviors (core/behaviors/)
class DashOptions(_Options):
    def __init__(self, *, angle_tolerance: float) -> None: ...

class OrcaOptions(_Options):
    def __init__(
        self,
        *,
        neighborDist: float,
        maxNeighbors: int,
        timeHorizon: float,
        timeHorizonObst: float,
        safe_radius: float,
        maxSpeed: float | None,
    ) -> None: ...

class RvoOptions(_Options):
    def __init__(
        self, *, vxmax: float, vymax: float, acce: float, factor: float, mode: str, neighbor_threshold: float
    ) -> None: ...

class SfmOptions(_Options):
    def __init__(
        self,
        *,
        vmax: float,
        neighbor_threshold: float,
        relaxation_time: float,
        force_factor_desired: float,
        force_factor_social: float,
        force_factor_obstacle: float,
        sigma_obstacle: float,
        lambda_importance: float,
        gamma: float,
        n_angular: float,
        n_velocity: float,
        safety_radius: float,
        social_groups: Sequence[Sequence[int]] | None,
        force_factor_coherence: float,
        force_factor_group_repulsion: float,
        group_repulsion_threshold: float | None,
        force_factor_gaze: float,
        gaze_vision_angle: float,
    ) -> None: ...

# planners (core/planners/)
class AstarOptions(_Options):
    def __init__(self, *, resolution: float) -> None: ...

class JpsOptions(_Options):
    def __init__(self, *, resolution: float) -> None: ...

class RrtOptions(_Options):
    def __init__(
        self, *, expand_dis: float, path_resolution: float, goal_sample_rate: float, max_iter: int
    ) -> None: ...

class RrtStarOptions(_Options):
    def __init__(
        self,
        *,
        expand_dis: float,
        path_resolution: float,
        goal_sample_rate: float,
        max_iter: int,
        connect_circle_dist: float,
        search_until_max_iter: bool,
    ) -> None: ...

class InformedRrtStarOptions(_Options):
    def __init__(
        self,
        *,
        expand_dis: float,
        path_resolution: float,
        goal_sample_rate: float,
        max_iter: int,
        connect_circle_dist: float,
        search_until_max_iter: bool,
    ) -> None: ...

class PrmOptions(_Options):
    def __init__(self, *, n_sample: int, n_knn: int, max_edge_len: float) -> None: ...

Cells = tuple[tuple[float, float], tuple[float, float], int, int]
"""Origin, cell size [m], columns, rows."""

class RouteOptions(_Options):
    """How an object plans a path for its behavior to follow; 0 for `replan` and `lookahead` is none."""

    def __init__(self, *, planner: object, replan: float, lookahead: float) -> None: ...

class Terrain:
    """What stands in the way of planning, within a rectangle that footprints must not leave.

    Args:
        bounds: x0, y0, x1, y1 [m].
        things: Parts and pose of each obstacle.
    """

    def __init__(self, bounds: Sequence[float], things: Sequence[tuple[Sequence[object], Sequence[float]]]) -> None: ...
    def plan(
        self,
        planner: object,
        *,
        parts: Sequence[object],
        heading: float,
        start: Sequence[float],
        goal: Sequence[float],
        cells: Cells,
        key: tuple[int, int, int],
        object: int,
        first_draw: int,
        smooth: bool,
    ) -> tuple[Floats | None, float, Floats, NDArray[np.int32], Floats]:
        """A path for a body of these parts at a heading (no parts: that of a cell).

        Returns:
            (N, 2) points from start to goal, or None; its length; (K, 2) points looked at; (K,) the index of the point
            each was reached from, or -1; (K,) length of the way there.
        """
    def open_cells(self, parts: Sequence[object], heading: float, cells: Cells) -> Flags:
        """(nx, ny) where grid planners may go."""
    def collides(self, parts: Sequence[object], pose: Sequence[float]) -> bool:
        """Whether a body touches an obstacle or leaves the rectangle."""
    def clear(self, parts: Sequence[object], heading: float, start: Sequence[float], goal: Sequence[float]) -> bool:
        """Whether a body of fixed heading can move straight from start to goal."""

class Clearance:
    """Distances from the middles of cells to what stands in the way, and the widest ways between them.

    They are never too short, and seldom (by much less than a cell) too long; what lies outside of the cells is not
    seen. A body of which a disc of radius r gets
    from one place to another passes cells with a distance of at least r minus half the diagonal of a cell.
    """

    def __init__(self, terrain: Terrain, cells: Cells) -> None: ...
    distance: NDArray[np.float32]  # (nx, ny) [m]; 0 inside of an obstacle, infinity without any; a copy
    def widest(self, start: Sequence[float], goal: Sequence[float], reach: float) -> tuple[float, float, float]:
        """Least distance on the widest way from a cell by `start` to one within `reach` [m] of `goal`, and where.

        -infinity if there is no way.
        """
    def climb(self, start: Sequence[float], reach: float) -> tuple[float, float]:
        """The roomiest place uphill from `start`, at most `reach` [m] away."""
    def way(self, start: Sequence[float], goal: Sequence[float], room: float) -> Floats:
        """(K, 2) shortest way over cells with a distance of at least `room`; (0, 2) if there is none."""

# sensors (core/sensors/)
class Lidar2dOptions(_Options):
    def __init__(
        self,
        *,
        range_min: float,
        range_max: float,
        angle_range: float,
        number: int,
        noise: bool,
        std: float,
        angle_std: float,
        offset: Sequence[float],
        has_velocity: bool,
    ) -> None: ...

class FmcwLidar2dOptions(_Options):
    def __init__(
        self,
        *,
        range_min: float,
        range_max: float,
        angle_range: float,
        number: int,
        noise: bool,
        std: float,
        angle_std: float,
        offset: Sequence[float],
        motion_compensate: bool,
        velocity_noise_std: float,
    ) -> None: ...

# shapes (core/shapes/): body frame
class Circle:
    radius: float
    center: list[float]
    def __init__(self, *, radius: float, center: Sequence[float]) -> None: ...

class Polygon:
    """Closed and filled; convex or not; simple."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class Linestring:
    """Open polyline without thickness."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class RandomCircle:
    """Radius drawn per scene."""

    def __init__(self, *, radius_range: Sequence[float], center: Sequence[float]) -> None: ...

class RandomPolygon:
    """Vertices drawn per scene (reference/dynamics.md section 10); `closed` False gives an open polyline."""

    def __init__(
        self,
        *,
        center_range: Sequence[float],
        avg_radius_range: Sequence[float],
        irregularity_range: Sequence[float],
        spikeyness_range: Sequence[float],
        num_vertices_range: Sequence[int],
        closed: bool,
    ) -> None: ...

class Room:
    """A closed line that is solid outside: the walls round a world."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class OccupancyGrid:
    """Cells of a map; the occupied ones are closed boxes. Never changes, and worlds share it.

    Args:
        occupied: (nx, ny), i along +x, j along +y; non-zero where occupied.
        origin: Lower left corner, world frame [m].
        cell: Extent of a cell along x and y [m].
    """

    def __init__(self, occupied: NDArray[np.uint8], origin: Sequence[float], cell: Sequence[float]) -> None: ...
    shape: tuple[int, int]  # (nx, ny)
    origin: tuple[float, float]
    cell: tuple[float, float]
    count: int  # of occupied cells
    occupied: Flags  # (nx, ny), a copy
    clearance: Flags  # (nx, ny) how many cells away, diagonally too, the nearest occupied one is; at most 255; a copy
    def outline(self) -> list[Floats]:
        """Rings around the occupied cells, (K, 2) corners each, straight runs merged, the occupied side on the left."""
    def cast(self, from_: Sequence[float], direction: Sequence[float], limit: float) -> float:
        """Distance at which a beam (unit direction) first meets the outline; infinity beyond `limit` [m]."""

class GridCells:
    """The occupied cells of a grid; the pose of the object does not move them."""

    grid: OccupancyGrid

    def __init__(self, *, grid: OccupancyGrid) -> None: ...

class PerlinCells:
    """Cells of gradient noise, drawn per scene from the stream `map`.

    Args:
        size: Cells of the noise along x and y; of `every` cells along an axis one is kept.
        origin: Lower left corner, world frame [m].
        cell_size: Extent of the cells that are kept [m].
        complexity, fill, fractal, attenuation: As in :class:`irsim.components.maps.perlin.PerlinMap`.
    """

    def __init__(
        self,
        *,
        size: Sequence[int],
        every: int,
        origin: Sequence[float],
        cell_size: Sequence[float],
        complexity: float,
        fill: float,
        fractal: int,
        attenuation: float,
    ) -> None: ...

def perlin_cells(
    permutation: Sequence[int],
    columns: int,
    rows: int,
    complexity: float,
    fill: float,
    fractal: int,
    attenuation: float,
) -> Flags:
    """(columns, rows) 1 where gradient noise over a permutation of 0 ... 255 is among the highest `fill` of it."""

Part = Circle | Polygon | Linestring | RandomCircle | RandomPolygon | Room | GridCells | PerlinCells

class ObjectSpec:
    """One object of the template world. All keyword arguments are required.

    Args:
        number: Names it in random draws and events, so that neither changes when other objects come and go; -1: its
            place in the list.
        role: 0 robot, 1 obstacle.
        group: Group id.
        drive: Kinematics options, or None for an object that never moves.
        parts: Shape; more than one part = compound (their union).
        static, unobstructed, wander, loop: Flags.
        pose: x, y, theta. Ignored for objects of a random placement.
        extra: Extra state rows (steering angle first for acker); may be empty.
        control: Initial control, padded to 3.
        vel_min, vel_max, acce: Limits, padded to 3.
        angle_range: Interval of the heading.
        goals: Queue of goals, 2 or 3 numbers each; may be empty.
        goal_threshold: Arrival distance [m].
        arrive_mode: 0 position, 1 state.
        range_low, range_high: Box of wander goals (3 each).
        target_roles: 0 all, 1 robots, 2 obstacles.
        behavior: Options of a native behavior, or None.
        grouped: The behavior is that of the group: it decides for all members at once.
        route: How it plans a path for its behavior to follow, or None.
        sensors: Options of the sensors, in order; None in the place of one that the core does not compute.
        centroid: x, y in the body frame, what contacts turn it about, and possibly the square of its radius of gyration
            [m^2]; empty follows from the shape, where overlaps of parts count twice.
        mass: [kg], infinity for what nothing can push.
        friction: Coefficient of friction with the ground.
        inertia: Moment of inertia [kg m^2]; NaN follows from shape and mass.
        restitution: Bounciness, 0 to 1.
        tau: Lag of the drive [s].
        driven: Whether it has a drive, native or not; what has none and is not static is moved by contacts only;
            its control is a world-frame velocity and a yaw rate.
    """

    def __init__(
        self,
        *,
        number: int,
        role: int,
        group: int,
        drive: _Options | None,
        parts: Sequence[Part],
        static: bool,
        unobstructed: bool,
        wander: bool,
        loop: bool,
        pose: Sequence[float],
        extra: Sequence[float],
        control: Sequence[float],
        vel_min: Sequence[float],
        vel_max: Sequence[float],
        acce: Sequence[float],
        angle_range: Sequence[float],
        goals: Sequence[Sequence[float]],
        goal_threshold: float,
        arrive_mode: int,
        range_low: Sequence[float],
        range_high: Sequence[float],
        target_roles: int,
        behavior: _Options | None,
        grouped: bool,
        route: RouteOptions | None,
        sensors: Sequence[_Options | None],
        centroid: Sequence[float],
        mass: float,
        friction: float,
        inertia: float,
        restitution: float,
        tau: float,
        driven: bool,
    ) -> None: ...

class RandomPlacement:
    """Objects of one `random` distribution: states, then goals, drawn per scene (D7).

    Wanderers draw no goal here but one at every reset; nothing keeps the goals of static objects apart.
    """

    def __init__(
        self,
        *,
        objects: Sequence[int],
        range_low: Sequence[float],
        range_high: Sequence[float],
        min_distance: float,
        attempts: int,
    ) -> None: ...

class FogView:
    """A robot without lidar that clears the fog in its field of view: a sector of `angle` [rad] and `reach` [m]."""

    def __init__(self, *, object: int, angle: float, reach: float, occlusion: bool) -> None: ...

class Fog:
    """Cells over the world, explored or not; (columns, rows) of them over `size` from the lower left corner `origin`.

    Args:
        carriers: Objects whose first native sensor clears it along its beams.
        views: Objects that clear it where they look.
    """

    def __init__(
        self,
        *,
        origin: Sequence[float],
        size: Sequence[float],
        columns: int,
        rows: int,
        carriers: Sequence[int],
        views: Sequence[FogView],
    ) -> None: ...

class World:
    """What never changes during an episode: shapes, drives, limits, options; `copies` worlds of one template."""

    def __init__(
        self,
        *,
        step_time: float,
        collision_mode: int,
        gravity: float,
        objects: Sequence[ObjectSpec],
        placements: Sequence[RandomPlacement],
        copies: int,
        fog: Fog | None = None,
    ) -> None: ...
    # collision_mode: 0 stop, 1 unobstructed, 2 unobstructed_obstacles, 3 contact
    copies: int
    objects: int  # N
    step_time: float
    collision_mode: int  # may be set at run time
    extent: tuple[float, float, float, float]  # x0, y0, x1, y1 [m], where paths are looked for; may be set
    def scans(self) -> list[tuple[int, int, int]]:
        """(object, first beam, beams) of each native sensor of one world, in order.

        Beams of world w follow at w * beams_per_world.
        """
    beams_per_world: int
    def velocity_slices(self) -> list[tuple[int, int]]:
        """(first, rows) of each native sensor: its velocities are rows x beams numbers from `first` of its world's."""
    velocities_per_world: int

class State:
    """What changes: poses, controls, goals, flags, scans, counters, random keys.

    Constructing draws scene 0 of every world and evaluates collisions, arrival and sensors (D12).
    """

    @overload
    def __init__(self, world: World, seeds: NDArray[np.uint64], history: bool) -> None: ...
    @overload
    def __init__(self, world: World, before: State, origins: Sequence[tuple[State, int]]) -> None:
        """Go on where `before` (of one world) is, with other objects.

        Clock, keys and events are those of `before`; object i has the pose, initial values, goals, flags, history and
        shape of its origin, a row of `before` or of another state. Flags are those of the last step; sensors look
        again.
        """
    pose: Floats  # (R, 3) x, y, theta
    extra: Floats  # (R, E) extra state rows, E >= 1
    control: Floats  # (R, 3) executed control without noise
    twist: Floats  # (R, 3) true vx, vy (world frame), yaw rate of the last step
    command: Floats  # (R, 3) control wanted for the next step
    drive: Floats  # (R, 3) control of the drives in `collision_mode: contact`, before contacts interfere
    contact_time: Floats  # (R,) how long the row has touched something [s]
    air_time: Floats  # (R,) how long it has touched nothing [s]
    touching: Flags  # (R,) bit 0: in contact in the last step, bit 1: in the one before
    given: Flags  # (R,) 1: `command` comes from outside, behaviors leave the row alone; cleared by every step
    arrived: Flags  # (R,)
    collided: Flags  # (R,)
    stopped: Flags  # (R,)
    radius: Floats  # (R,) minimum bounding circle radius of the body
    infeasible: NDArray[
        np.int32
    ]  # (R,) steps of the episode in which its behavior found no velocity free of collisions
    goal: Floats  # (R, 3) head of the goal queue; theta NaN for 2 numbers; x NaN without goal
    ranges: Floats  # (W * beams_per_world,)
    hits: NDArray[np.int32]  # same length: object (its row within the world) hit by each beam, -1 none
    valid: Flags  # same length: 1 where the beam hit something and its (noisy) range lies in [range_min, range_max]
    beam_angles: Floats  # same length: nominal angle of each beam in the sensor frame
    velocities: Floats  # (W * velocities_per_world,) measured velocities [m/s], see World.velocity_slices
    explored: Flags  # (W, columns, rows) 1 where no fog is left; no rows without fog
    count: NDArray[np.int64]  # (W,) executed steps of the episode
    scene: NDArray[np.uint32]  # (W,)
    noise: NDArray[np.uint32]  # (W,)
    seed: NDArray[np.uint64]  # (W,)
    event_count: int  # events so far in this state, for a cheap "anything new?"
    failed_placement: NDArray[np.int32]  # (W,) object that found no room, -1 if all did
    def reset(self, mask: NDArray[np.uint8], next_scene: bool) -> None:
        """Reset the worlds where mask is 1.

        next_scene False: initial poses, noise + 1. True: scene + 1, noise 0, shapes, placements and goals drawn anew.
        Then collisions, arrival and sensors are evaluated.
        """
    def reseed(self, seeds: NDArray[np.uint64], mask: NDArray[np.uint8]) -> None:
        """New seeds; the next reset of these worlds, of either kind, draws scene 0, noise 0."""
    def refresh(self) -> None:
        """Re-evaluate geometry, collisions, stops and sensors (not arrival) after poses were written from outside."""
    def done(self, world: int) -> bool:
        """Whether every robot of the world has arrived or stopped; False without robots."""
    def events(self, world: int, start: int = 0) -> list[tuple[str, int, int, int, float, float]]:
        """(kind, step, number of the object, of its partner or -1, x, y), kind "arrival", "waypoint", "collision".

        Those since the last reset, the first `start` left out.
        """
    def collision_pairs(self, world: int) -> NDArray[np.int32]:
        """(P, 2) pairs i < j whose closed shapes intersect now, sorted, `unobstructed` ones included."""
    def contacts(self, world: int) -> list[tuple[int, int, float, float, float, float, float, float]]:
        """Contacts of the last step: a, b, normal x, y (from b to a), depth [m], point x, y, force [N]."""
    def body(self, row: int) -> tuple[float, float, float, float, float]:
        """1 / mass, 1 / inertia, square of the shape's radius of gyration [m^2], centroid x, y in the body frame."""
    def pieces(self, row: int) -> list[Floats]:
        """Convex pieces of the shape, (M, 2) each, body frame; a circle is its centre, lines are segments."""
    def goals(self, row: int) -> list[list[float]]: ...
    def set_goals(self, row: int, goals: Sequence[Sequence[float]], init: bool) -> None: ...
    def set_initial(self, row: int, pose: bool, control: bool) -> None:
        """Make the row's present pose (and extra rows), or control, or both, those that reset() returns to."""
    def route(self, row: int) -> Floats | None:
        """(K, 2) corners of the path that a row follows, from where it was planned to the goal; None without one."""
    def initial_state(self, row: int) -> Floats:
        """(3 + E,) pose and extra rows that reset() returns to."""
    def velocity_world(self, row: int) -> tuple[float, float]:
        """World-frame velocity that the present control gives at the present pose."""
    def velocities_world(self, world: int) -> NDArray[np.float64]:
        """(N, 2) the same of every object of a world."""
    def near_row(self, row: int) -> list[int]:
        """Places, ascending, of the other objects of its world whose bounding boxes meet that of a row now."""
    def drive_velocity_world(self, row: int) -> tuple[float, float]:
        """World-frame velocity that `drive` gives at the present pose."""
    def moved(self, row: int) -> None:
        """The row's pose was written from outside: forget geometry cached for it (flags and scans wait for a step)."""
    def in_view(self, row: int, angle: float, reach: float, occlusion: bool) -> list[int]:
        """Ids, ascending, of the other objects of which some part lies in the view of a row, at the present poses.

        Args:
            row: Who looks.
            angle: Opening about the heading [rad]; 2 pi or more: all round.
            reach: From the origin of the object [m].
            occlusion: Parts hidden behind what is not `unobstructed` do not count.
        """
    def reset_row(self, row: int) -> None:
        """Put one object back to its initial pose, control and goals and clear its flags and history."""
    def reshape(self, row: int, parts: Sequence[Part], seed: int) -> None:
        """Give the row another body until the next scene is drawn; `seed` is for random parts."""
    def look(self) -> None:
        """Take every scan anew from where objects are now; collisions and flags wait for a step or `refresh`."""
    def vertices(self, row: int, part: int, world_frame: bool) -> Floats:
        """(M, 2) vertices of a polygon or linestring part; (0, 2) for a circle."""
    def circle(self, row: int, part: int, world_frame: bool) -> tuple[float, float, float]:
        """Centre x, y and radius of a circle part."""
    def parts(self, row: int) -> list[str]:
        """Kinds of the parts: "circle", "polygon", "linestring", "room", "cells" (vertices: corners of their box)."""
    def cells(self, row: int) -> OccupancyGrid | None:
        """The cells of a row that is a map."""
    def trajectory(self, row: int) -> Floats:
        """(K, 3 + E) state after each executed step since the last reset (history=True only).

        Steps in which the object was static or stopped are left out.
        """

class Trace:
    """Everything that happened, step by step: arrays of shape (steps executed, R, …)."""

    pose: Floats
    control: Floats
    goal: Floats
    arrived: Flags
    collided: Flags
    stopped: Flags
    steps: NDArray[np.int64]  # (W,) steps executed by each world
    ranges: Floats
    returns: NDArray[np.float32]  # (steps, W * beams) ranges, infinite where a beam hit nothing

class Log:
    """What world 0 of a state writes down of each step while it is attached.

    Arrays look at the memory of the log and stay as they are when it goes on. Goals, flags and ranges are there for the
    rows in which they differ from the row before.
    """

    def __init__(self, world: World, movers: Sequence[int], columns: int, scans: bool) -> None: ...
    def attach(self, state: State) -> None: ...
    def detach(self, state: State) -> None: ...
    def add(self, state: State) -> None:
        """Write the present state down: what native steps do by themselves."""

    def clear(self) -> None: ...
    @property
    def first(self) -> int:
        """Step of the first row."""

    @property
    def rows(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def pose(self) -> Floats:
        """(rows, movers, 3)."""

    @property
    def control(self) -> NDArray[np.float32]:
        """(rows, movers, columns)."""

    @property
    def goal_rows(self) -> NDArray[np.int64]: ...
    @property
    def goal(self) -> Floats:
        """(goal_rows, N, 3)."""

    @property
    def flag_rows(self) -> NDArray[np.int64]: ...
    @property
    def flags(self) -> Flags:
        """(flag_rows, N): 1 arrived, 2 collided, 4 stopped."""

    @property
    def scan_rows(self) -> NDArray[np.int64]: ...
    @property
    def ranges(self) -> NDArray[np.float32]:
        """(scan_rows, beams), infinite where a beam hit nothing."""

def advance(
    world: World, state: State, steps: int, *, threads: int = 1, until_done: bool = False, external: bool = False
) -> int:
    """Run `steps` periods of every world; rows with `given` use `command` in the first one.

    until_done: a world rests once every robot is stopped or arrived (a world without robots never does). external:
    poses are set by the caller, only finish … sense run. Releases the GIL. Returns the largest number of steps executed
    by a world.
    """

def rollout(
    world: World,
    state: State,
    steps: int,
    *,
    threads: int = 1,
    until_done: bool = False,
    ranges: bool = False,
    returns: bool = False,
) -> Trace:
    """Like `advance`, recording."""

# The phases of one step, for worlds in which Python code takes part. `advance(1)` is the sequence of all of them.
def decide(world: World, state: State) -> None:
    """Renew goals (wander, loop), then let native behaviors fill `command` of rows not `given`.

    Rows without any behavior get zero.
    """

def limit(world: World, state: State) -> None: ...
def integrate(world: World, state: State) -> None:
    """Move; rows without native drive keep pose, extra and twist, which are then the caller's to write."""

def push_apart(world: World, state: State) -> None:
    """Push apart what overlaps (`collision_mode` 3 only); after `integrate`."""

def collide(world: World, state: State) -> None: ...
def arrive(world: World, state: State) -> None: ...
def sense(world: World, state: State) -> None: ...
def scan(world: World, state: State, index: int, sensor: int, pose: Sequence[float]) -> None:
    """Let a native sensor of world `index`, numbered as in `World.scans`, take its scan from a carrier at `pose`."""

def finish(world: World, state: State) -> None:
    """Count the step, append the history, clear `given`.

    The order is decide, limit, integrate, (push_apart,) finish, collide, arrive, sense.
    """

# Used by the Python API and by tests
def follow(world: World, state: State, row: int, velocity: tuple[float, float]) -> tuple[float, float, float]:
    """Controls with which the drive of a row realises a world-frame velocity [m/s]; that itself without one."""

# The phases for one object alone; they look neither at `given` of others nor at the clock
def renew_row(world: World, state: State, row: int) -> None:
    """A wanderer's next random goal, a looper's goals again; nothing for others."""

def decide_row(world: World, state: State, row: int) -> None:
    """Let the native behavior of a row fill its `command`; zero without one."""

def limit_row(world: World, state: State, row: int) -> None: ...
def integrate_row(world: World, state: State, row: int) -> None: ...
def remember_row(world: World, state: State, row: int) -> None:
    """Append the row's present pose to its history."""

# Drives without a world
def drive_step(
    drive: _Options, state: Sequence[float], control: Sequence[float], dt: float
) -> tuple[list[float], list[float]]:
    """(state after one period, twist); as many state rows as given, at least 3."""

def drive_follow(
    drive: _Options,
    state: Sequence[float],
    velocity: Sequence[float],
    min_speed: float = ...,
    tolerance: float = ...,
    guarantee_time: float = ...,
    max_rate: float = ...,
) -> list[float]:
    """Three controls (surplus ones zero) with which a drive realises a world-frame velocity [m/s]."""

def drive_deviation(drive: _Options, control: Sequence[float]) -> list[float]:
    """Standard deviations of the motion noise of three controls."""

def shift(world: World, state: State, row: int, by: tuple[float, float], turn: float) -> None:
    """Move a row by `by` [m] and turn it about its centroid, as within one period: its velocity changes too."""

def push(world: World, state: State, row: int, change: tuple[float, float]) -> None:
    """Change the velocity of a row, world frame [m/s]."""

def contact_step(
    world: World,
    state: State,
    index: int,
    pairs: Sequence[tuple[int, int]],
    sweeps: int,
    slop: float,
    step_time: float,
) -> None:
    """Push apart these pairs of objects of world `index` where they overlap; `state.contacts(index)` tells how."""

def neighbors(
    world: World, state: State, index: int, centre: tuple[float, float], reach: float
) -> list[tuple[int, float, float, float, float, float]]:
    """What behaviors of world `index` see near a point, now: id, centre x, y, velocity x, y, radius; ascending ids.

    Every moving object but linestrings and every static circle whose bounding circle has its centre within `reach`.
    """

def walls(
    world: World, state: State, index: int, centre: tuple[float, float], reach: float, lines: bool
) -> list[tuple[float, float, float, float, int, int, int]]:
    """Wall segments within `reach` of a point: x, y of both ends, object, next, previous (-1: a free end).

    Those of static linestrings with `lines`, else the counter-clockwise outlines of other static objects that are
    neither circles nor `unobstructed`.
    """

def clearances(
    world: World, state: State, index: int, poses: Floats, robots: Sequence[int], company: Flags
) -> tuple[Floats, NDArray[np.int32]]:
    """Distances [m] between footprints over recorded poses (rows, N, 3) of world `index` in its present scene.

    company: (N,) what each object is to a robot: 0 robot, 1 human, 2 something that stands still, 3 nobody. Returns
    (rows, robots, 3) the distance to the nearest of the kinds 0 to 2, negative where they overlap, and its index; NaN
    and -1 where there is none. Releases the GIL.
    """

def least_clearances(
    world: World,
    state: State,
    index: int,
    poses: Floats,
    robots: Sequence[int],
    company: Flags,
    ends: Sequence[int],
) -> tuple[Floats, NDArray[np.int32], NDArray[np.int32]]:
    """For each robot the least distance [m] of its first `ends` rows to anybody, (R,), whose it is, and in which row.

    As :func:`clearances` otherwise, of all kinds together, and much faster. Releases the GIL.
    """

def intersects(
    parts_a: Sequence[Part], pose_a: Sequence[float], parts_b: Sequence[Part], pose_b: Sequence[float]
) -> bool: ...
def best_velocity(
    planes: Sequence[Sequence[float]], hard: int, max_speed: float, preferred: tuple[float, float]
) -> tuple[float, float, bool]:
    """The velocity nearest to `preferred` within half-planes (point x, y, direction x, y; allowed: on the left).

    Where there is none (last value False), the one that is least outside, the first `hard` of them kept.
    """

def nearest_points(
    points: Sequence[tuple[float, float]], centre: tuple[float, float], reach: float, most: int
) -> list[int]:
    """Indices of the points less than `reach` away, nearest first, at most `most`."""

def random_bits(seed: int, scene: int, noise: int, stream: int, object: int, draw: int) -> tuple[int, int, int, int]:
    """The Philox4x64-10 block of a key: key (seed, scene << 32 | noise), counter (draw, object, stream, 0)."""

STREAMS: dict[str, int]  # name → number: placement, shape, goal, motion, sensor, behavior, planner, map, user
