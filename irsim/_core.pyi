"""Types of the compiled core (irsim/core): arrays in, arrays out, without YAML and without Python objects.

There are W worlds of N objects each, so R = N * W rows; row w * N + i is object i of world w. Array
properties are writable views of the memory of the core (no copies), of type float64 unless stated otherwise.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Any, ClassVar, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.uint8]
Bools = NDArray[np.bool_]
Real = TypeVar("Real", np.float32, np.float64)

sources: str
"""SHA-256 of all sources that this core was compiled from, in hexadecimal; line ends do not count."""

class _Options:
    """Base of every options class: its constructor requires all fields as keywords; `fields` lists them in order."""

    fields: ClassVar[tuple[str, ...]]

# kinematics (one header each in core/kinematics/)
class DiffOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float], track: float) -> None: ...

class OmniOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float]) -> None: ...

class OmniAngularOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float]) -> None: ...

class AckerOptions(_Options):
    def __init__(self, *, noise: bool, alpha: Sequence[float], mode: str, wheelbase: float, psi_max: float) -> None: ...

class TricycleOptions(_Options):
    def __init__(
        self,
        *,
        noise: bool,
        alpha: Sequence[float],
        mode: str,
        wheelbase: float,
        psi_max: float,
        steer_rate: float,
        steer_acce: float,
        steer_lag: float,
    ) -> None: ...

class SkidSteerOptions(_Options):
    def __init__(
        self,
        *,
        noise: bool,
        alpha: Sequence[float],
        believed_track: float,
        icr_left: float,
        icr_right: float,
        icr_ahead: float,
        traction_left: float,
        traction_right: float,
        speed_max: float,
        track: float,
    ) -> None: ...

class SingleTrackOptions(_Options):
    def __init__(
        self,
        *,
        noise: bool,
        alpha: Sequence[float],
        model: str,
        tyres: str,
        mode: str,
        wheelbase: float,
        psi_max: float,
        steer_rate: float,
        acce_max: float,
        speed_switch: float,
        speed_min: float,
        speed_max: float,
        mass: float,
        inertia: float,
        front: float,
        rear: float,
        height: float,
        friction: float,
        stiffness_front: float,
        stiffness_rear: float,
    ) -> None: ...

class DiffDynamicOptions(_Options):
    def __init__(
        self,
        *,
        noise: bool,
        alpha: Sequence[float],
        mass: float,
        inertia: float,
        wheel_radius: float,
        track: float,
        drag: float,
        turn_drag: float,
        torque_max: float,
        voltage: float,
        resistance: float,
        torque_constant: float,
        gear: float,
        response: float,
        friction: float,
        slip_stiffness: float,
    ) -> None: ...

# behaviors (core/behaviors/)
class AvocadoOptions(_Options):
    def __init__(
        self,
        *,
        neighborDist: float,
        maxNeighbors: int,
        timeHorizon: float,
        timeHorizonObst: float,
        maxSpeed: float | None,
        approach_time: float | None,
        sidestep: float | None,
        safe_radius: float | None,
        forgetting: float,
        own_weight: float,
        evidence_weight: float,
        evidence_gain: float,
        evidence: str,
        memory: bool,
        bias: float,
        attention_time: float,
        attention_step: float,
        noise: float,
        keep_gap: bool | None,
    ) -> None: ...

class DashOptions(_Options):
    def __init__(self, *, angle_tolerance: float) -> None: ...

class FootprintOrcaOptions(_Options):
    def __init__(
        self,
        *,
        neighborDist: float,
        maxNeighbors: int,
        timeHorizon: float,
        timeHorizonObst: float,
        safe_distance: float,
        maxSpeed: float | None,
        backward: bool,
    ) -> None: ...

class OrcaOptions(_Options):
    def __init__(
        self,
        *,
        neighborDist: float,
        maxNeighbors: int,
        timeHorizon: float,
        timeHorizonObst: float,
        maxSpeed: float | None,
        approach_time: float | None,
        sidestep: float | None,
        safe_radius: float,
        responsibility: float | None,
    ) -> None: ...

class ReplayOptions(_Options):
    def __init__(
        self, *, times: Sequence[float], poses: Sequence[Sequence[float]], interpolation: str, vanish: bool
    ) -> None: ...

class RvoOptions(_Options):
    def __init__(
        self,
        *,
        vxmax: float,
        vymax: float,
        acce: float,
        factor: float,
        mode: str,
        neighbor_threshold: float,
        sidestep: float | None,
        turning: str,
        keep_gap: bool | None,
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
        sidestep: float | None,
        keep_gap: bool | None,
        social_groups: Sequence[Sequence[int]] | None,
        force_factor_coherence: float,
        force_factor_group_repulsion: float,
        group_repulsion_threshold: float | None,
        force_factor_gaze: float,
        gaze_vision_angle: float,
    ) -> None: ...

# observation parts (core/parts/)
class OwnOptions(_Options):
    def __init__(
        self,
        *,
        features: Sequence[str],
        frame: str,
        controls: int,
        speed_max: float,
        yaw_rate_max: float,
        radius_max: float,
        steering_max: float,
        limit_max: float,
        clip: bool,
    ) -> None: ...

class ArrivalOptions(_Options):
    def __init__(self, *, each: bool) -> None: ...

class ClearanceOptions(_Options):
    def __init__(self, *, margin: float, to: str) -> None: ...

class CollisionOptions(_Options):
    def __init__(self) -> None: ...

class ProgressOptions(_Options):
    def __init__(self) -> None: ...

class SmoothnessOptions(_Options):
    def __init__(self, *, of: str) -> None: ...

class SocialOptions(_Options):
    def __init__(self, *, distance: float) -> None: ...

class TimeOptions(_Options):
    def __init__(self) -> None: ...

class GoalOptions(_Options):
    def __init__(
        self, *, features: Sequence[str], frame: str, distance_max: float, decay: float, clip: bool
    ) -> None: ...

class NeighborsOptions(_Options):
    def __init__(
        self,
        *,
        features: Sequence[str],
        count: int,
        range: float | None,
        nearest_last: bool,
        frame: str,
        relative_velocity: bool,
        distance_max: float,
        speed_max: float,
        radius_max: float,
        decay: float,
        clip: bool,
    ) -> None: ...

class RvoConesOptions(_Options):
    def __init__(
        self,
        *,
        count: int,
        nearest: int,
        range: float,
        margin: float,
        horizon: float,
        velocity: str,
        decimals: int | None,
        zero_row: bool,
    ) -> None: ...

class RvoSelfOptions(_Options):
    def __init__(self, *, speed: float | None, margin: float, decimals: int | None) -> None: ...

class ScanOptions(_Options):
    def __init__(self, *, sectors: int, range_max: float | None, nearness: bool) -> None: ...

class MapOptions(_Options):
    def __init__(self, *, cells: int, size: float, frame: str, outside_occupied: bool) -> None: ...

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

class Actuation(_Options):
    """What happens to commands before a drive executes them; the numbers are for three controls, in their units.

    Args:
        command_period: Time for which a command is held [s]; 0: a step.
        delay: Dead time [s].
        resolution: Commands are rounded to multiples of this; 0: they are not.
        jerk: Largest change of the rate of change [per s^2], may be infinite.
        lag: Time constant [s].
        dead_band: Smaller controls are executed as 0.
        noise: Standard deviation of the executed control.
    """

    def __init__(
        self,
        *,
        command_period: float,
        delay: Sequence[float],
        resolution: Sequence[float],
        jerk: Sequence[float],
        lag: Sequence[float],
        dead_band: Sequence[float],
        noise: Sequence[float],
    ) -> None: ...

class Ground(_Options):
    """The ground of a zone.

    Args:
        zone: Index of the zone, which is an area.
        slip: Mean share of a wheel's way that the body does not move, 0 to 1.
        slip_std: Standard deviation of that share.
        slip_time: Time in which a deviation falls to 1 / e [s]; 0: each step has its own.
        grip: Factor on the friction of wheels.
        spread: Track of `skid_steer` as it turns, over the distance of its sides; 0: as the drive says.
        traction: Speed over ground per speed of a side of `skid_steer`, where `spread` is given.
    """

    def __init__(
        self,
        *,
        zone: int,
        slip: float,
        slip_std: float,
        slip_time: float,
        grip: float,
        spread: float,
        traction: float,
    ) -> None: ...

class RouteOptions(_Options):
    """How an object plans a path for its behavior to follow; 0 switches `replan` or `lookahead` off.

    `within` are the corners x, y of an area that the path does not leave [m]; without any, it may go everywhere.
    `avoid` are the indices of the zones of the world that are solid for the object.
    """

    def __init__(
        self,
        *,
        planner: object,
        replan: float,
        lookahead: float,
        within: Sequence[Sequence[float]],
        avoid: Sequence[int],
    ) -> None: ...

class Terrain:
    """Obstacles for planning, within a rectangle that footprints must not leave.

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
        """Plan a path for a body of these parts at a heading; without parts, for a body as large as a cell.

        Returns:
            (N, 2) points from start to goal, or None; the length of the path; (K, 2) points examined; (K,) the index of
            the point from which each was reached, or -1; (K,) the length of the path to each.
        """
    def open_cells(self, parts: Sequence[object], heading: float, cells: Cells) -> Flags:
        """(nx, ny) 1 for cells that grid planners may use."""
    def collides(self, parts: Sequence[object], pose: Sequence[float]) -> bool:
        """Whether a body touches an obstacle or leaves the rectangle."""
    def clear(self, parts: Sequence[object], heading: float, start: Sequence[float], goal: Sequence[float]) -> bool:
        """Whether a body of fixed heading can move straight from start to goal."""

class Clearance:
    """Distances from the centres of cells to the nearest obstacle, and the widest paths between cells.

    Distances are never too short; in rare cases they are too long by much less than a cell. Obstacles outside of the
    cells are ignored. A body that contains a disc of radius r about its origin passes only cells with a distance of at
    least r minus half the diagonal of a cell.
    """

    def __init__(self, terrain: Terrain, cells: Cells) -> None: ...
    distance: NDArray[np.float32]  # (nx, ny) [m]; 0 inside of an obstacle, infinity without obstacles; a copy
    def widest(self, start: Sequence[float], goal: Sequence[float], reach: float) -> tuple[float, float, float]:
        """Clearance [m] of the widest path from `start` to within `reach` [m] of `goal`, and its narrowest point x, y.

        The clearance is -infinity without a path.
        """
    def climb(self, start: Sequence[float], reach: float) -> tuple[float, float]:
        """Follow growing distances from `start`, at most `reach` [m] away, and return the last point."""
    def way(self, start: Sequence[float], goal: Sequence[float], room: float) -> Floats:
        """(K, 2) shortest path over cells with a distance of at least `room` [m]; (0, 2) without a path."""

# sensors (core/sensors/)
class LidarErrors(_Options):
    def __init__(
        self,
        *,
        std_per_meter: float,
        bias_std: float,
        scale_std: float,
        resolution: float,
        resolution_growth: float,
        dropout: float,
        short_share: float,
        short_rate: float,
        random_share: float,
        range_dark: float,
        fade: float,
        incidence_max: float,
        blind: Sequence[Sequence[float]],
        divergence: float,
        rays: int,
        mixed: str,
        beam_time: float,
        segments: int,
    ) -> None: ...

class Lidar2dOptions(_Options):
    def __init__(
        self,
        *,
        range_min: float,
        range_max: float,
        angle_range: float,
        number: int,
        endpoint: bool,
        noise: bool,
        std: float,
        angle_std: float,
        offset: Sequence[float],
        has_velocity: bool,
        realism: LidarErrors | None,
    ) -> None: ...

class FmcwLidar2dOptions(_Options):
    def __init__(
        self,
        *,
        range_min: float,
        range_max: float,
        angle_range: float,
        number: int,
        endpoint: bool,
        noise: bool,
        std: float,
        angle_std: float,
        offset: Sequence[float],
        motion_compensate: bool,
        velocity_noise_std: float,
        realism: LidarErrors | None,
    ) -> None: ...

class DepthScanOptions(_Options):
    def __init__(
        self,
        *,
        range_min: float,
        range_max: float,
        angle_range: float,
        number: int,
        endpoint: bool,
        noise: bool,
        std: float,
        angle_std: float,
        offset: Sequence[float],
        has_velocity: bool,
        realism: LidarErrors | None,
        depth_min: float,
        depth_std: float,
        depth_growth: float,
        depth_from: float,
    ) -> None: ...

class SonarOptions(_Options):
    def __init__(
        self,
        *,
        offset: Sequence[float],
        range_min: float,
        range_max: float,
        cone: float,
        incidence_max: float,
        std: float,
        std_per_meter: float,
        resolution: float,
        dropout: float,
        crosstalk: float,
    ) -> None: ...

class IrRangeOptions(_Options):
    def __init__(
        self,
        *,
        offset: Sequence[float],
        range_min: float,
        range_max: float,
        cone: float,
        incidence_max: float,
        std: float,
        std_per_meter: float,
        resolution: float,
        dropout: float,
        folds: bool,
    ) -> None: ...

class BumperOptions(_Options):
    def __init__(
        self,
        *,
        sectors: Sequence[Sequence[float]],
        reach: float,
    ) -> None: ...

class CliffOptions(_Options):
    def __init__(
        self,
        *,
        points: Sequence[Sequence[float]],
        zones: Sequence[int],
        miss_share: float,
        false_share: float,
    ) -> None: ...

class UwbOptions(_Options):
    def __init__(
        self,
        *,
        anchors: Sequence[Sequence[float]],
        offset: Sequence[float],
        range_max: float,
        std: float,
        nlos_bias: float,
        nlos_std: float,
        outlier_share: float,
        outlier_mean: float,
        dropout: float,
    ) -> None: ...

class OdometryOptions(_Options):
    def __init__(
        self,
        *,
        track: float,
        wheel_radius: float,
        ticks_per_turn: int,
        diameter_error: float,
        track_error: float,
        scale_error: float,
        diameter_std: float,
        track_std: float,
        scale_std: float,
        distance_noise: float,
        heading_noise: float,
        turning_noise: float,
    ) -> None: ...

class ImuOptions(_Options):
    def __init__(
        self,
        *,
        offset: Sequence[float],
        gyro_noise: float,
        gyro_bias_std: float,
        gyro_drift_std: float,
        gyro_drift_time: float,
        gyro_scale_std: float,
        gyro_resolution: float,
        gyro_range: float,
        accel_noise: float,
        accel_bias_std: float,
        accel_drift_std: float,
        accel_drift_time: float,
        accel_scale_std: float,
        accel_resolution: float,
        accel_range: float,
        misalignment_std: float,
        tilt_std: float,
    ) -> None: ...

class GnssOptions(_Options):
    def __init__(
        self,
        *,
        offset: Sequence[float],
        std: float,
        drift_std: float,
        drift_time: float,
        rtk: bool,
        fixed_std: float,
        fixed_time: float,
        float_std: float,
        float_time: float,
        blocked: Sequence[int],
        reflecting: Sequence[int],
        reflection: float,
    ) -> None: ...

class DetectorOptions(_Options):
    """`targets` is "all", "robot" or "obstacle"."""

    def __init__(
        self,
        *,
        offset: Sequence[float],
        range_max: float,
        angle_range: float,
        targets: str,
        probability: float,
        half_range: float,
        range_softness: float,
        occlusion: bool,
        min_visible: float,
        position_std: float,
        velocity_std: float,
        false_tracks: float,
        false_radius: float,
        id_switches: float,
        keep: float,
        max_tracks: int,
    ) -> None: ...

class LocalizationOptions(_Options):
    def __init__(
        self,
        *,
        position_std: float,
        heading_std: float,
        time: float,
        min_distance: float,
        min_turn: float,
        distance_noise: float,
        heading_noise: float,
        turning_noise: float,
        jumps_per_km: float,
        jump_std: float,
    ) -> None: ...

# shapes (core/shapes/): body frame
class Circle:
    radius: float
    center: list[float]
    def __init__(self, *, radius: float, center: Sequence[float]) -> None: ...

class Polygon:
    """A closed, filled, simple polygon, convex or not."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class Linestring:
    """An open polyline without thickness."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class RandomCircle:
    """A circle whose radius is drawn for each scene."""

    def __init__(self, *, radius_range: Sequence[float], center: Sequence[float]) -> None: ...

class RandomPolygon:
    """A polygon, or an open polyline if not `closed`, drawn for each scene (reference/dynamics.md section 10)."""

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
    """A closed line that is solid outside: the walls around a world."""

    vertices: list[list[float]]

    def __init__(self, *, vertices: Sequence[Sequence[float]]) -> None: ...

class OccupancyGrid:
    """Cells of a map, of which the occupied ones are closed boxes. A grid never changes, so worlds share it.

    Args:
        occupied: (nx, ny), i along +x, j along +y; non-zero where occupied.
        origin: Lower left corner, world frame [m].
        cell: Extent of a cell along x and y [m].
        unknown: (nx, ny) non-zero where unknown; occupied cells are known. None if all are known.
    """

    def __init__(
        self,
        occupied: NDArray[np.uint8],
        origin: Sequence[float],
        cell: Sequence[float],
        unknown: NDArray[np.uint8] | None = None,
    ) -> None: ...
    shape: tuple[int, int]  # (nx, ny)
    origin: tuple[float, float]
    cell: tuple[float, float]
    count: int  # number of occupied cells
    closed_count: int  # number of occupied and of unknown cells, which planners avoid
    occupied: Flags  # (nx, ny), a copy
    unknown: Flags | None  # (nx, ny), a copy; None if all cells are known
    clearance: Flags  # (nx, ny) steps to any of 8 neighbors up to the nearest occupied cell, at most 255; a copy
    def outline(self) -> list[Floats]:
        """Rings around the occupied cells, (K, 2) corners each, with the occupied side on the left."""
    def cast(self, from_: Sequence[float], direction: Sequence[float], limit: float) -> float:
        """Distance at which a beam (unit direction) first meets the outline; infinity beyond `limit` [m]."""

class GridCells:
    """The occupied cells of a grid, which the pose of the object does not move."""

    grid: OccupancyGrid

    def __init__(self, *, grid: OccupancyGrid) -> None: ...

class PerlinCells:
    """Cells of gradient noise, drawn for each scene from the stream `map`.

    Args:
        size: Cells of the noise along x and y.
        every: One of this many cells is kept along each axis.
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
    """(columns, rows) 1 for the share `fill` of cells with the highest noise; `permutation` is one of 0 to 255."""

Part = Circle | Polygon | Linestring | RandomCircle | RandomPolygon | Room | GridCells | PerlinCells

class SensorTiming(_Options):
    """When a sensor measures, and when its data arrive.

    Args:
        rate: Measurements per second [Hz], the k-th in the first step that ends at k / rate or later; 0: one in each
            step.
        latency: Time from a measurement to the step in which the sensor shows it [s], rounded up to steps.
    """

    def __init__(self, *, rate: float, latency: float) -> None: ...

def shown_step(timing: SensorTiming, step_time: float, step: int) -> int:
    """The step in which the data were measured that a sensor shows after a step; -1 if there are none yet."""

class ObjectSpec:
    """One object of the template world. All keyword arguments are required.

    Args:
        number: Id in random draws and events, which thus do not change when other objects are added or removed; -1: the
            index in the list.
        role: 0 robot, 1 obstacle.
        group: Group id.
        drive: Kinematics options, or None for an object that never moves.
        parts: Shape; several parts make a compound, their union.
        static, unobstructed, wander, loop: Flags.
        pose: x, y, theta. Ignored for objects of a random placement.
        extra: Extra state rows (steering angle first for acker); may be empty.
        control: Initial control, padded to 3.
        vel_min, vel_max, acce: Limits, padded to 3.
        angle_range: Interval of the heading [rad].
        goals: Queue of goals, 2 or 3 numbers each; may be empty.
        goal_threshold: Arrival distance [m].
        arrive_mode: 0 position, 1 state.
        range_low, range_high: Box of wander goals (3 each).
        target_roles: 0 all, 1 robots, 2 obstacles.
        behavior: Options of a native behavior, or None.
        grouped: Whether the behavior belongs to the group and decides for all members at once.
        route: How the object plans a path for its behavior to follow, or None.
        sensors: Options of the sensors, in order; None in the place of one that the core does not compute.
        timing: Times of each sensor; empty if all measure in each step and their data arrive at once.
        centroid: Centre of mass x, y in the body frame [m], and optionally the square of the radius of gyration [m^2].
            If empty, both follow from the shape, in which overlaps of parts count twice.
        mass: Mass [kg], infinity for an object that cannot be pushed.
        friction: Coefficient of friction with the ground.
        inertia: Moment of inertia [kg m^2]; if NaN, it follows from shape and mass.
        restitution: Bounciness, 0 to 1.
        tau: Time constant of the drive [s].
        driven: Whether the object has a drive, native or in Python. Contacts alone move an object that has none and is
            not static; its control is a world-frame velocity and a yaw rate.
        start_step: Number of steps for which the object stands still at its start.
        appear_step: Number of steps for which the object is not in the world.
        vanish_step: Step in which it leaves the world; 0: never.
        reflectivity: Share of the light of lidars that its surface throws back.
        material: What its surface does with the light of lidars with errors: "matt", "glass" or "mirror".
        actuation: What happens to commands before the drive executes them; None executes them at once, within limits.
        perceives_estimate: Whether it decides from the pose that its localization, or else its odometry, reports.
        perceives_tracks: Whether it decides from the tracks of its detector instead of other moving objects.
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
        timing: Sequence[SensorTiming],
        centroid: Sequence[float],
        mass: float,
        friction: float,
        inertia: float,
        restitution: float,
        tau: float,
        driven: bool,
        start_step: int,
        appear_step: int,
        vanish_step: int,
        reflectivity: float,
        material: str,
        actuation: Actuation | None,
        perceives_estimate: bool,
        perceives_tracks: bool,
    ) -> None: ...

class RandomPlacement:
    """Objects of one `random` distribution: states, then goals, are drawn for each scene (D7).

    Goals of wandering objects are drawn at every reset instead. The goals of static objects keep no distance.
    Starts lie between `range_low` and `range_high`, goals between `goal_low` and `goal_high` (x, y [m], heading [rad]).
    Footprints keep clear of the discs `keep_points` (x, y, radius [m]), and by `keep_radii` [m] of `keep_objects` at
    their starts and goals, as far as these are known. A goal is at least `goal_distance` [m] from its start.
    """

    def __init__(
        self,
        *,
        objects: Sequence[int],
        range_low: Sequence[float],
        range_high: Sequence[float],
        goal_low: Sequence[float],
        goal_high: Sequence[float],
        min_distance: float,
        goal_distance: float,
        keep_points: Sequence[Sequence[float]],
        keep_objects: Sequence[int],
        keep_radii: Sequence[float],
        attempts: int,
    ) -> None: ...

class CircleCrossing:
    """Objects of one `circle_crossing` distribution: each start is drawn with its goal, which is opposite."""

    def __init__(
        self,
        *,
        objects: Sequence[int],
        center: Sequence[float],
        radius: float,
        noise: float,
        clearance: float,
        attempts: int,
    ) -> None: ...

class SquareCrossing:
    """Objects of one `square_crossing` distribution: each start is drawn with its goal, which is on the other side."""

    def __init__(
        self, *, objects: Sequence[int], center: Sequence[float], width: float, clearance: float, attempts: int
    ) -> None: ...

class Perturbation:
    """How far start, speeds and departure of an object may differ between scenes: uniform draws within these spreads.

    Starts do not overlap other objects, except those that overlap at the poses of the template, do not leave `extent`,
    and have no static object between them and the start of the template.

    Args:
        position: Largest change of x and of y [m].
        heading: Largest change of the heading [rad].
        speed: Largest change of the speeds, as a share of them.
        delay: Longest time for which the object stands still at its start [s].
        speeds: Controls that are speeds.
        attempts: Maximum number of draws of a start.
    """

    def __init__(
        self,
        *,
        object: int,
        position: float,
        heading: float,
        speed: float,
        delay: float,
        speeds: Sequence[int],
        attempts: int,
    ) -> None: ...

class Variation:
    """A quantity that is drawn for each scene from the stream `task`, uniformly.

    A `number` says how many of the objects take part, `latency` is a whole number of steps, and the others are factors:
    `size` (of the footprint about the origin of the body frame), `speed` and `acceleration` (of the limits),
    `sensor_noise` (of the standard deviations), `delay` and `lag` (of the actuators), `sensor_rate` and
    `sensor_latency` (of sensors that have them), `slip` and `grip` (of zones, as the object feels them). Objects are
    drawn one by one, or with `same` together.
    """

    def __init__(self, *, quantity: str, objects: Sequence[int], low: float, high: float, same: bool) -> None: ...

class Level:
    """What is drawn at one level: `variations`, and one of `variants` variants from `first_variant` on."""

    def __init__(self, *, variations: Sequence[Variation], first_variant: int, variants: int) -> None: ...

class View:
    """The field of view of an object: a sector of `angle` [rad] about its heading and of `reach` [m].

    With `occlusion`, what is hidden behind objects that are not `unobstructed` is not seen.
    """

    def __init__(self, *, object: int, angle: float, reach: float, occlusion: bool) -> None: ...

class Fog:
    """Cells over the world that robots explore: (columns, rows) over `size` from the lower left corner `origin`.

    Args:
        carriers: Objects whose first native sensor clears the fog along its beams.
        views: Fields of view that clear the fog.
    """

    def __init__(
        self,
        *,
        origin: Sequence[float],
        size: Sequence[float],
        columns: int,
        rows: int,
        carriers: Sequence[int],
        views: Sequence[View],
    ) -> None: ...

class World:
    """What never changes during an episode (shapes, drives, limits, options), for `copies` worlds of one template.

    Args:
        zones: Lines (a Linestring of two points) and regions (a Circle or Polygon), world frame. Events name who
            crosses or enters them.
        views: Fields of view that are watched. Events name which targets come into them or go out of them.
        targets: Indices of the objects that count as seen.
        grounds: What zones do to wheels, in the order of the zones.
    """

    def __init__(
        self,
        *,
        step_time: float,
        collision_mode: int,
        gravity: float,
        objects: Sequence[ObjectSpec],
        placements: Sequence[RandomPlacement | CircleCrossing | SquareCrossing],
        copies: int,
        fog: Fog | None = None,
        perturbations: Sequence[Perturbation] = (),
        zones: Sequence[Part] = (),
        views: Sequence[View] = (),
        targets: Sequence[int] = (),
        grounds: Sequence[Ground] = (),
    ) -> None: ...
    # collision_mode: 0 stop, 1 unobstructed, 2 unobstructed_obstacles, 3 contact
    copies: int
    objects: int  # N
    step_time: float
    collision_mode: int  # may be set at run time
    after_arrival: int  # 0: arrived only while at the goal, 1: stands still for good, 2: arrived for good
    contacts: int  # which count as collisions, 0: at the ends of steps, 1: within steps, too
    integration: int  # of drives, 0: Euler, 1: exact arcs
    extent: tuple[float, float, float, float]  # x0, y0, x1, y1 [m] of the box in which paths are planned; may be set
    def set_levels(self, levels: Sequence[Level], speeds: Sequence[Sequence[int]]) -> None:
        """Let scenes vary; a state draws those of its `level`. Call it before a state is made.

        Args:
            levels: What is drawn at each level.
            speeds: Controls of each object that are speeds.
        """
    def set_variants(self, variants: Sequence[World]) -> None:
        """Set worlds of the same objects with other places, goals and shapes, from which levels choose.

        Call it before `set_levels`.
        """
    def scans(self) -> list[tuple[int, int, int]]:
        """(object, first beam, number of beams) of each native sensor of one world, in order.

        The beams of world w start at w * beams_per_world.
        """
    beams_per_world: int
    def velocity_slices(self) -> list[tuple[int, int]]:
        """(first, rows) of each native sensor: it has rows x beams velocities from index `first` of its world."""
    velocities_per_world: int
    def gauges(self) -> list[tuple[int, int, int]]:
        """(object, first, number) of each sensor without beams: its readings, from index `first` of its world."""
    readings_per_world: int

class State:
    """What changes during an episode: poses, controls, goals, flags, scans, counters, random keys.

    The constructor draws scene 0 of every world and evaluates collisions, arrival and sensors (D12).
    """

    @overload
    def __init__(self, world: World, seeds: NDArray[np.uint64], history: bool) -> None: ...
    @overload
    def __init__(self, world: World, before: State, origins: Sequence[tuple[State, int]]) -> None:
        """Continue from `before`, which has one world, with other objects.

        Clock, keys and events are those of `before`; object i has the pose, initial values, goals, flags, history and
        shape of its origin, a row of `before` or of another state. Flags are those of the last step; sensors take a new
        scan.
        """
    pose: Floats  # (R, 3) x, y, theta
    extra: Floats  # (R, E) extra state rows, E >= 1
    control: Floats  # (R, 3) executed control without noise
    twist: Floats  # (R, 3) true vx, vy (world frame), yaw rate of the last step
    command: Floats  # (R, 3) control wanted for the next step
    commanded: Floats  # (R, 2) velocity that `follow_rows` last asked a row to follow, world frame; zero before [m/s]
    drive: Floats  # (R, 3) control of the drives in `collision_mode: contact`, before contacts change it
    actuated: (
        Floats  # (R, 12) of actuators: command held, control within limits, its rate, control after the lag; or (0, 12)
    )
    contact_time: Floats  # (R,) time for which the row has touched something [s]
    air_time: Floats  # (R,) time for which the row has touched nothing [s]
    touching: Flags  # (R,) bit 0: in contact in the last step, bit 1: in the one before
    given: Flags  # (R,) 1: the caller wrote `command`, so behaviors skip the row; every step clears it
    arrived: Flags  # (R,)
    believes_arrived: Flags  # (R,) of rows that go by an estimate: whether they rest where they take their goal to be
    collided: Flags  # (R,)
    stopped: Flags  # (R,)
    radius: Floats  # (R,) radius of the minimum bounding circle [m]
    vel_min: Floats  # (R, 3) lower limits of the controls in this scene
    vel_max: Floats  # (R, 3) upper limits likewise
    acce: Floats  # (R, 3) limits of their changes [per s] in this scene
    takes_part: Flags  # (R,) 0: the object is absent in this scene, see Variation
    size_scale: Floats  # (R,) factors of this scene on the footprint,
    speed_scale: Floats  # (R,) on the limits of speeds, which `pace` contains,
    acceleration_scale: Floats  # (R,) on the limits of accelerations,
    noise_scale: Floats  # (R,) on the standard deviations of sensors,
    delay_scale: Floats  # (R,) on the dead time of actuators,
    lag_scale: Floats  # (R,) on their lag,
    sensor_rate_scale: Floats  # (R,) on the rates of sensors,
    sensor_latency_scale: Floats  # (R,) on their latencies,
    slip_scale: Floats  # (R,) on the slip of zones under the wheels of the object,
    grip_scale: Floats  # (R,) and on their grip
    latency: NDArray[np.int32]  # (R,) steps after which the caller is asked to execute an action
    level: NDArray[np.int32]  # (W,) level of the scenes drawn from now on; may be set
    variant: NDArray[np.int32]  # (W,) index among the variants of the world in this scene; -1 without any
    pace: Floats  # (R,) factor on the speeds of the object in this scene
    start_step: NDArray[np.int64]  # (R,) steps for which the object stands still at its start in this scene
    appeared: NDArray[
        np.int64
    ]  # (R,) step in which the object came into the world; -1 before, -2 minus that step afterwards
    between_steps: NDArray[np.int32]  # (R,) contacts of the episode between two steps, with nothing touched at either
    infeasible: NDArray[np.int32]  # (R,) steps of the episode in which no velocity avoided every collision
    goal: Floats  # (R, 3) head of the goal queue; theta NaN for 2 numbers; x NaN without goal
    ranges: Floats  # (W * beams_per_world,)
    hits: NDArray[np.int32]  # same length: index within its world of the object hit by each beam, -1 without a hit
    valid: Flags  # same length: 1 where the beam hit something at a (noisy) range within [range_min, range_max]
    beam_angles: Floats  # same length: nominal angle of each beam in the sensor frame
    readings: Floats  # (W * readings_per_world,) numbers of sensors without beams, see World.gauges
    stamp: (
        Floats  # (W, sensors) time of measurement of what a sensor shows [s]; `scans`, then `gauges`; NaN: nothing yet
    )
    velocities: Floats  # (W * velocities_per_world,) measured velocities [m/s], see World.velocity_slices
    explored: Flags  # (W, columns, rows) 1 where the fog is cleared; (W, 0, 0) without fog
    count: NDArray[np.int64]  # (W,) executed steps of the episode
    scene: NDArray[np.uint32]  # (W,)
    noise: NDArray[np.uint32]  # (W,)
    seed: NDArray[np.uint64]  # (W,)
    event_count: int  # number of events since the state was made, a cheap check for new ones
    failed_placement: NDArray[np.int32]  # (W,) first object that could not be placed, -1 if all were placed
    def reset(self, mask: NDArray[np.uint8], next_scene: bool, threads: int = 1) -> None:
        """Reset the worlds where mask is 1.

        Without `next_scene`, objects return to their initial poses and `noise` increases by 1. With it, `scene`
        increases by 1, `noise` becomes 0, and shapes, placements and goals are drawn again. Then collisions, arrival
        and sensors are evaluated. Worlds are distributed over the threads; results do not depend on their number.
        """
    def reseed(self, seeds: NDArray[np.uint64], mask: NDArray[np.uint8]) -> None:
        """Set new seeds; the next reset of these worlds, of either kind, draws scene 0 with noise 0."""
    def save(self) -> bytes:
        """The whole state, from which :meth:`load` goes on bit for bit; its format is that of this build."""
    def load(self, bytes: bytes) -> None:
        """Continue from what :meth:`save` returned for a state of an equal world.

        Raises:
            ValueError: The bytes are of another world, or damaged; the state is then not usable.
        """
    def refresh(self) -> None:
        """Re-evaluate geometry, collisions, stops and sensors (not arrival) after poses were written."""
    def all_done(self) -> Flags:
        """(W,) whether every robot of each world has arrived or stopped; False without robots."""
    def done(self, world: int) -> bool:
        """Whether every robot of the world has arrived or stopped; False without robots."""
    def events(self, world: int, start: int = 0) -> list[tuple[str, int, int, int, float, float]]:
        """Events since the last reset except the first `start`: (kind, step, object, partner or -1, x, y).

        The kind is "arrival", "waypoint", "collision", "no_path", "overshoot", "zone_entry", "zone_exit",
        "crossing_to_right", "crossing_to_left", "sight_start", "sight_end", "contact_between_steps" or
        "passed_through". Objects are given by their number, zones by their index in place of the partner. Who sees is
        the object, who is seen is the partner.
        """
    def moments(self, world: int, start: int = 0) -> list[tuple[float, float]]:
        """When each of these events happened within its step (0 its beginning, 1 its end), and the deepest overlap [m].

        The overlap is 0 unless the event is a contact between steps.
        """
    def collision_pairs(self, world: int) -> NDArray[np.int32]:
        """(P, 2) sorted pairs i < j whose closed shapes intersect now, including `unobstructed` ones."""
    def contacts(self, world: int) -> list[tuple[int, int, float, float, float, float, float, float]]:
        """Contacts of the last step: a, b, normal x, y (from b to a), depth [m], point x, y, force [N]."""
    def body(self, row: int) -> tuple[float, float, float, float, float]:
        """1 / mass, 1 / inertia, square of the shape's radius of gyration [m^2], centroid x, y in the body frame."""
    def pieces(self, row: int) -> list[Floats]:
        """Convex pieces of the shape, (M, 2) each, body frame; a circle is its centre, lines are segments."""
    def goals(self, row: int) -> list[list[float]]: ...
    def set_goals(self, row: int, goals: Sequence[Sequence[float]], init: bool) -> None: ...
    def set_initial(self, row: int, pose: bool, control: bool) -> None:
        """Make the present pose (and extra rows) or control of the row, or both, the initial one for `reset`."""
    def route(self, row: int) -> Floats | None:
        """(K, 2) corners of the path that a row follows, from the place of planning to the goal; None without one."""
    def rest(self, row: int) -> None:
        """Let the actuators of a row be at rest at its present control, as if it had been commanded for long."""
    def opinions(self, row: int) -> list[tuple[int, float, float]]:
        """What an object with `avocado` thinks of others: number in :class:`ObjectSpec`, opinion, attention.

        They are those of the last decision, nearest first. An opinion of -1 expects no avoidance, 1 all of it.
        """
    def initial_state(self, row: int) -> Floats:
        """(3 + E,) initial pose and extra rows, to which `reset` returns."""
    def velocity_world(self, row: int) -> tuple[float, float]:
        """World-frame velocity [m/s] from the present control and pose."""
    def velocities_world(self, world: int) -> NDArray[np.float64]:
        """(N, 2) world-frame velocity [m/s] of every object of a world, as `velocity_world` gives it."""
    def near_row(self, row: int) -> list[int]:
        """Indices, ascending, of other objects of its world whose bounding boxes meet that of a row now."""
    def drive_velocity_world(self, row: int) -> tuple[float, float]:
        """World-frame velocity [m/s] from `drive` and the present pose."""
    def moved(self, row: int) -> None:
        """Update cached geometry after the pose of a row was written (flags and scans follow in the next step)."""
    def in_view(self, row: int, angle: float, reach: float, occlusion: bool) -> list[int]:
        """Ids, ascending, of other objects that are partly or wholly in the view of a row at the present poses.

        Args:
            row: Row of the observer.
            angle: Full opening angle about the heading [rad]; 2 pi or more is all directions.
            reach: Range from the origin of the observer [m].
            occlusion: Whether parts hidden behind objects that are not `unobstructed` are left out.
        """
    def reset_row(self, row: int) -> None:
        """Return one object to its initial pose, control and goals and clear its flags and history."""
    def reshape(self, row: int, parts: Sequence[Part], seed: int) -> None:
        """Replace the shape of the row until the next scene is drawn; `seed` is for random parts."""
    def look(self) -> None:
        """Take every scan again at the present poses; collisions and flags change only in a step or `refresh`."""
    def vertices(self, row: int, part: int, world_frame: bool) -> Floats:
        """(M, 2) vertices of a polygon or linestring part; (0, 2) for a circle."""
    def circle(self, row: int, part: int, world_frame: bool) -> tuple[float, float, float]:
        """Centre x, y and radius of a circle part."""
    def parts(self, row: int) -> list[str]:
        """Kinds of the parts: "circle", "polygon", "linestring", "room", "cells" (vertices: corners of their box)."""
    def cells(self, row: int) -> OccupancyGrid | None:
        """The cells of a row that is a map; None for other rows."""
    def recorded(self, row: int) -> int:
        """Number K of states in the trajectory of a row."""
    def trajectory(self, row: int, first: int = 0) -> Floats:
        """(K - first, 3 + E) state after each executed step since the last reset, if the state was made with history.

        Steps in which the object was static or stopped are left out, and so are the ``first`` ones of the others; a
        stopped one that can be pushed (`collision_mode: contact`) has them all.
        """
    def standings(self, row: int) -> tuple[NDArray[np.int64], Floats, Flags]:
        """(K,) steps, (K, 3) goals and (K,) `stopped` of an object that can move, one entry per change.

        Each entry holds at the ends of steps from its step on. The state must have been made with history.
        """

class Trace:
    """Values of every step: arrays of shape (steps executed, R, …)."""

    pose: Floats
    control: Floats
    goal: Floats
    arrived: Flags
    collided: Flags
    stopped: Flags
    steps: NDArray[np.int64]  # (W,) steps executed by each world
    ranges: Floats
    returns: NDArray[np.float32]  # (steps, W * beams) ranges [m], infinite without a valid hit

class Log:
    """The record of world 0 of a state: one row for each step while it is attached.

    Arrays are views of the memory of the log and do not change when rows are added. Goals, flags and ranges are stored
    only for the rows in which they differ from the row before.
    """

    def __init__(self, world: World, movers: Sequence[int], columns: int, scans: bool) -> None: ...
    def attach(self, state: State) -> None: ...
    def detach(self, state: State) -> None: ...
    def add(self, state: State) -> None:
        """Add a row with the present state; native steps do this automatically."""

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
        """(rows, movers, 3) poses."""

    @property
    def control(self) -> NDArray[np.float32]:
        """(rows, movers, columns) controls."""

    @property
    def commanded(self) -> list[int]:
        """Indices of the objects whose commands are recorded, because they pass through actuators."""

    @property
    def command(self) -> NDArray[np.float32]:
        """(rows, commanded, columns) commands."""

    @property
    def goal_rows(self) -> NDArray[np.int64]: ...
    @property
    def goal(self) -> Floats:
        """(goal_rows, N, 3) goals, NaN without one."""

    @property
    def flag_rows(self) -> NDArray[np.int64]: ...
    @property
    def flags(self) -> Flags:
        """(flag_rows, N) sums of 1 arrived, 2 collided, 4 stopped, 8 believes to have arrived."""

    @property
    def scan_rows(self) -> NDArray[np.int64]: ...
    @property
    def ranges(self) -> NDArray[np.float32]:
        """(scan_rows, beams) ranges [m], infinite without a valid hit."""

    @property
    def reading_rows(self) -> NDArray[np.int64]: ...
    @property
    def readings(self) -> Floats:
        """(reading_rows, readings of a world) numbers of sensors that report numbers instead of ranges."""

def advance(
    world: World, state: State, steps: int, *, threads: int = 1, until_done: bool = False, external: bool = False
) -> int:
    """Run `steps` periods of every world; rows with `given` use `command` in the first one.

    With `until_done` a world ends once every robot has stopped or arrived; a world without robots never does. With
    `external` the caller has set the poses, and only the phases from `finish` to `watch` run. Releases the GIL. Returns
    the largest number of steps that a world executed.
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
    """Advance as `advance` does and return the values of every step."""

# The phases of one step, for worlds with drives or behaviors in Python. `advance(1)` runs all of them in order.
def decide(world: World, state: State) -> None:
    """Renew goals (wander, loop), then let native behaviors fill `command` of rows that are not `given`.

    Rows without any behavior get zero.
    """

def limit(world: World, state: State) -> None: ...
def integrate(world: World, state: State) -> None:
    """Move rows with a native drive; for others the caller writes pose, extra and twist."""

def push_apart(world: World, state: State) -> None:
    """Push overlapping bodies apart; call after `integrate`, with `collision_mode` 3 only."""

def collide(world: World, state: State) -> None: ...
def arrive(world: World, state: State) -> None: ...
def sense(world: World, state: State) -> None: ...
def watch(world: World, state: State) -> None:
    """Log who enters, leaves or crosses a zone, and who comes into or goes out of a field of view."""

def scan(world: World, state: State, index: int, sensor: int, pose: Sequence[float]) -> None:
    """Let a sensor of world `index`, numbered as in `World.scans`, show a scan taken with its carrier at `pose`."""

def finish(world: World, state: State) -> None:
    """Count the step, append the history, clear `given`.

    The order is decide, limit, integrate, (push_apart,) finish, collide, arrive, sense, watch.
    """

# Used by the Python API and by tests
def follow(world: World, state: State, row: int, velocity: tuple[float, float]) -> tuple[float, float, float]:
    """Controls with which the drive of a row realises a world-frame velocity [m/s]; without a drive, the velocity."""

# Used by policies, which decide for many rows at once
def follow_rows(world: World, state: State, rows: NDArray[np.int64], velocities: Floats) -> None:
    """Fill `command` of (B,) rows so that they follow (B, 2) world-frame velocities [m/s], as behaviors would.

    A row with a drive in Python gets the velocity as its command.
    """

def believed_rows(world: World, state: State, rows: NDArray[np.int64]) -> tuple[Floats, Floats, Flags]:
    """What (B,) rows believe of themselves: (B, 3) poses, (B, 2) world-frame velocities, (B,) whether they arrived.

    Of rows that go by no estimate it is the truth.
    """

class Belief(AbstractContextManager[None]):
    """Context in which the state holds what one row believes: its own pose, and other moving objects."""

    def __init__(self, world: World, state: State, row: int) -> None: ...
    def __enter__(self) -> None: ...
    def __exit__(self, kind: object, error: object, trace: object) -> None: ...

def bounding_circles(world: World, state: State) -> Floats:
    """(R, 3) x, y of the centre and radius of the minimum bounding circle of each row at its present pose [m]."""

class Looking:
    """What rows observe besides themselves.

    Args:
        neighbors: Number of nearest other objects.
        reach: Largest gap between bounding circles [m]. Objects count whose role the row targets.
        statics: Whether static objects count, except unobstructed ones, maps and the walls round a world.
        steered: (N,) whether the first extra state of an object is a steering angle.
        first_beam: (N,) first beam of the lidar of each object among those of its world.
        beams: Number of beams of a lidar; 0 if it is not observed.
        range_max: Largest range of a lidar [m].
    """

    def __init__(
        self,
        neighbors: int,
        reach: float,
        statics: bool,
        extents: bool,
        steered: Sequence[int],
        first_beam: Sequence[int],
        beams: int,
        range_max: float,
    ) -> None: ...

class SeenRows:
    """What B robots observed, for `look`: the arrays of :class:`irsim.policies.Observations`."""

    def __init__(
        self,
        *,
        pose: Floats,
        steering: Floats,
        velocity: Floats,
        commanded: Floats,
        yaw_rate: Floats,
        control: Floats,
        low: Floats,
        high: Floats,
        goal: Floats,
        goal_threshold: Floats,
        radius: Floats,
        arrived: Flags,
    ) -> None: ...
    def set_neighbors(
        self,
        present: Flags,
        position: Floats,
        heading: Floats,
        velocity: Floats,
        radius: Floats,
        arrived: Flags,
        robot: Flags,
        extent: Floats,
        own_extent: Floats,
    ) -> None: ...
    def set_scan(self, ranges: Floats, range_max: float) -> None: ...
    def set_pictures(
        self, pictures: Sequence[tuple[Flags, tuple[float, float], float]], which: Sequence[int]
    ) -> None: ...

def look(options: object, rows: SeenRows) -> tuple[Floats, Flags | None]:
    """(B, F) numbers of an observation part, or (B, K, F) and the (B, K) mask of the members that are present."""

def observe_rows(
    world: World,
    state: State,
    looking: Looking,
    parts: Sequence[tuple[object, int]],
    rows: NDArray[np.int64],
    out: NDArray[np.float32],
    threads: int = 1,
) -> None:
    """Write the observation parts of (B,) rows to ``out`` (B, D), each from the column that is given for it on.

    The numbers are those of `look`, rounded to single precision; absent members of sets hold zeros.
    """

def gaps(world: World, state: State, rows: NDArray[np.int64], kinds: Flags, reach: float, threads: int = 1) -> Floats:
    """(B, 3) distance [m] between the footprint of each row and the nearest robot, human and static object.

    Args:
        world: The world.
        state: The state.
        rows: (B,) rows.
        kinds: (N,) what each object is: 0 robot, 1 human, 2 static, 3 ignored.
        reach: Larger distances are infinite [m]. Those of overlaps are negative.
        threads: Number of threads.
    """

class Learners:
    """The A learners in each of the W worlds of a state, which must live as long.

    The arrays are views; the caller sets them when episodes begin, and each step updates them.

    Args:
        world: The world.
        state: The state.
        indices: (A,) indices of the learners in a world.
        kinds: (N,) what each object is to them, see `gaps`.
        terms: Options of each term of the reward, or None if it is computed elsewhere, and its weight.
        arrival: Whether the episode of a learner ends when it arrives.
        collision: Whether it ends when the learner begins to collide.
        ends: When a world is over: ``all`` of its learners are done, ``any`` is, or a ``collision`` begins.

    Attributes:
        taking_part: (W, A) whether the learner earns something in this episode.
        ended: (W, A) whether the episode of the learner has ended.
        arrived, collided: (W, A) whether it had arrived, and whether it touched something, at the end of the last step.
        over: (W,) whether the world is over.
        horizon: (W,) steps after which it is.

    Raises:
        ValueError: There are no such objects or kinds.
    """

    taking_part: Bools
    ended: Bools
    arrived: Bools
    collided: Bools
    over: Bools
    horizon: NDArray[np.int64]

    def __init__(
        self,
        world: World,
        state: State,
        *,
        indices: Sequence[int],
        kinds: Flags,
        terms: Sequence[tuple[object | None, float]],
        arrival: bool,
        collision: bool,
        ends: str,
    ) -> None: ...
    def begin(self, world: World, state: State, wanted: Floats | None, velocities: bool) -> None:
        """Command the learners, before the step of the simulation. Those whose episode has ended stand still.

        Args:
            world: The world.
            state: The state.
            wanted: (W * A, C) controls, or (W * A, 2) velocities [m/s], world frame; None leaves them to behaviors.
            velocities: Whether these are velocities.
        """

    def end(self, world: World, state: State, threads: int) -> tuple[Any, ...]:
        """The arrays of a :class:`irsim.learning.step.Result`, after the step of the simulation.

        Terms that are computed elsewhere are 0.
        """

    def step(
        self,
        world: World,
        state: State,
        wanted: Floats | None,
        velocities: bool,
        looking: Looking,
        parts: Sequence[tuple[object, int]],
        seen: NDArray[np.float32],
        threads: int,
    ) -> tuple[Any, ...]:
        """`begin`, one period of every world, `end`, and `observe_rows` of the learners, world by world."""

def find_neighbors(
    world: World, state: State, looking: Looking, rows: NDArray[np.int64]
) -> tuple[Flags, NDArray[np.int64], Floats, Floats, Floats, Floats, Flags, Flags, Floats, Floats]:
    """The nearest other objects of (B,) rows, sorted by the gap between bounding circles, then by index.

    Returns:
        (B, K) whether there is one, its index among the objects of the world (-1: none), (B, K, 2) position of the
        middle of its bounding circle [m], (B, K) heading [rad], (B, K, 2) velocity [m/s], (B, K) radius [m], whether it
        is a robot that has reached its last goal, whether it is a robot, how far its footprint reaches toward the row
        along the line between the centers [m], and how far that of the row reaches toward it; zeros unless measured.
    """

# The phases for a single object; they depend neither on `given` of others nor on the clock
def renew_row(world: World, state: State, row: int) -> None:
    """Give a wandering object its next random goal and a looping one its goals again; others do not change."""

def decide_row(world: World, state: State, row: int) -> None:
    """Let the native behavior of a row fill its `command`; zero without one."""

def impose_row(world: World, state: State, row: int, control: Sequence[float] | NDArray[np.float64]) -> bool:
    """Impose a control on a row for the next step, and return whether limits of speed or acceleration will cut it."""

def limit_row(world: World, state: State, row: int) -> None: ...
def integrate_row(world: World, state: State, row: int) -> None: ...
def remember_row(world: World, state: State, row: int) -> None:
    """Append the row's present pose to its history."""

# Drives without a world
def drive_step(
    drive: _Options, state: Sequence[float], control: Sequence[float], dt: float, integration: int = ...
) -> tuple[list[float], list[float]]:
    """State after one period, with as many rows as given (at least 3), and twist; `integration` as in a world."""

def single_track_rates(
    drive: SingleTrackOptions, state: Sequence[float], rate: float, acceleration: float
) -> list[float]:
    """Derivatives of CommonRoad's state at steering angle, speed, heading, yaw rate and slip angle."""

def drive_follow(
    drive: _Options,
    state: Sequence[float],
    velocity: Sequence[float],
    min_speed: float = ...,
    tolerance: float = ...,
    guarantee_time: float = ...,
    max_rate: float = ...,
    acce: float = ...,
    dt: float = ...,
) -> list[float]:
    """Three controls (surplus ones zero) with which a drive realises a world-frame velocity [m/s].

    `acce`: limit of changes of the turn rate [rad/s^2], with which turns of periods of `dt` [s] end at the heading.
    """

def drive_deviation(drive: _Options, control: Sequence[float]) -> list[float]:
    """Standard deviations of the motion noise of three controls."""

def shift(world: World, state: State, row: int, by: tuple[float, float], turn: float) -> None:
    """Move a row by `by` [m] and turn it about its centroid within one period, which changes its velocity, too."""

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
    """Push these pairs of objects of world `index` apart where they overlap; see `state.contacts(index)`."""

def neighbors(
    world: World, state: State, index: int, centre: tuple[float, float], reach: float
) -> list[tuple[int, float, float, float, float, float]]:
    """Discs that behaviors of world `index` see near a point now: id, centre x, y, velocity x, y, radius.

    They are all moving objects except linestrings, and all static circles, whose bounding circles have their centre
    within `reach` [m], with ascending ids.
    """

def walls(
    world: World, state: State, index: int, centre: tuple[float, float], reach: float
) -> list[tuple[float, float, float, float, int, int, int]]:
    """Wall segments within `reach` [m] of a point: x, y of both ends, object, next, previous.

    They are the outlines of the static objects that are not circles, with the solid side on their left. A linestring
    has them on both sides. Those that are `unobstructed` have none, linestrings excepted.
    """

def clearances(
    world: World, state: State, index: int, poses: Floats, robots: Sequence[int], kinds: Flags
) -> tuple[Floats, NDArray[np.int32]]:
    """Distances [m] between footprints over recorded poses (rows, N, 3) of world `index` in its present scene.

    kinds: (N,) what each object is to a robot: 0 robot, 1 human, 2 static, 3 ignored. Returns (rows, robots, 3) the
    distance to the nearest object of the kinds 0 to 2, negative where they overlap, and its index; NaN and -1 without
    such an object. Releases the GIL.
    """

def free_lines(
    world: World, state: State, index: int, start: Floats, end: Floats, blocking: NDArray[np.uint8]
) -> Flags:
    """(K,) 1 where the straight line from (K, 2) starts to (K, 2) ends meets no static object of world `index`.

    Args:
        world: The world.
        state: The state, whose static objects are where they are now.
        index: Index of the world.
        start: Starts [m].
        end: Ends [m]; a line that is not finite meets nothing.
        blocking: (N,) 1 for static objects that count.
    """

def least_clearances(
    world: World,
    state: State,
    index: int,
    poses: Floats,
    robots: Sequence[int],
    kinds: Flags,
    ends: Sequence[int],
) -> tuple[Floats, NDArray[np.int32], NDArray[np.int32]]:
    """Smallest distance [m] of each robot to any object in its first `ends` rows, the object and the row, (R,) each.

    Arguments are as for :func:`clearances`, of which this is the minimum over kinds and rows, found much faster.
    Releases the GIL.
    """

def intersects(
    parts_a: Sequence[Part], pose_a: Sequence[float], parts_b: Sequence[Part], pose_b: Sequence[float]
) -> bool: ...
def distance(
    parts_a: Sequence[Part], pose_a: Sequence[float], parts_b: Sequence[Part], pose_b: Sequence[float]
) -> float:
    """Distance [m] between the footprints of two bodies, as of :func:`clearances`: negative where they overlap."""

def best_velocity(
    planes: Sequence[Sequence[float]], hard: int, max_speed: float, preferred: tuple[float, float]
) -> tuple[float, float, bool]:
    """The velocity nearest to `preferred` within half-planes (point x, y, direction x, y; allowed on the left).

    If no velocity is within all of them (last value False), it is the one with the smallest violation within the first
    `hard` half-planes.
    """

def nearest_points(
    points: Sequence[tuple[float, float]],
    centre: tuple[float, float],
    ahead: tuple[float, float],
    reach: float,
    most: int,
) -> list[int]:
    """Indices of up to `most` points less than `reach` [m] away, nearest first, of equally near ones the right one."""

def random_bits(seed: int, scene: int, noise: int, stream: int, object: int, draw: int) -> tuple[int, int, int, int]:
    """The Philox4x64-10 block of key (seed, scene << 32 | noise) and counter (draw, object, stream, 0)."""

# layers of neural networks (core/networks/): a row has the same bits alone, among others, and on every processor
def dense(x: NDArray[Real], w: NDArray[Real], b: NDArray[Real]) -> NDArray[Real]:
    """Return (B, O) `x w + b` of x (B, I), w (I, O), b (O,); products are added in the order of the inputs."""

def elementwise(name: str, x: NDArray[Real]) -> NDArray[Real]:
    """Return (n,) values of relu, tanh, sigmoid, elu, gelu, gelu_tanh, silu, exp, sin or cos, computed in double."""

def normalize(x: NDArray[Real], epsilon: float) -> NDArray[Real]:
    """Return (B, I) rows shifted to mean 0 and divided by sqrt(variance + epsilon)."""

def softmax(x: NDArray[Real], mask: Flags | None = None) -> NDArray[Real]:
    """Return (B, K) weights over the columns whose mask is 1; zeros elsewhere, and in rows without any."""

def attention(
    query: NDArray[Real], key: NDArray[Real], value: NDArray[Real], mask: Flags | None = None, heads: int = 1
) -> NDArray[Real]:
    """Scaled dot-product attention: query (B, Q, D), key (B, K, D), value (B, K, V), mask (B, K).

    Returns (B, Q, V); zeros where no key is present. The heads are equal slices of D and V.
    """

# pictures (core/pictures/): pixels are (height, width, 4) red, green, blue and opacity, top row first; boxes are left,
# top, right, bottom [px]; colours with opacity are four numbers of 0..1
class Painter:
    """Paints shapes of a plane into pictures of one size, as Agg would draw them.

    `view` are xx, xy, x0, yx, yy, y0: a point is at pixel (xx x + xy y + x0, yx x + yy y + y0), y downwards.
    """

    def __init__(
        self,
        size: tuple[int, int],
        clip: tuple[int, int, int, int],
        view: tuple[float, float, float, float, float, float],
    ) -> None: ...
    def glow(
        self,
        pixels: NDArray[np.uint8],
        points: Floats,
        x: float,
        y: float,
        reach: float,
        fill: tuple[float, float, float, float],
    ) -> None:
        """Paint a polygon that is bright at (x, y), paler with the distance, and ends softly at `reach` [m]."""

    def shapes(
        self,
        pixels: NDArray[np.uint8],
        points: Floats,
        ranges: NDArray[np.int64],
        radii: Floats,
        inks: NDArray[np.uint8],
        widths: Floats,
        closed: bool,
        join: str,
        round_caps: bool,
        dashes: Sequence[float] = ...,
    ) -> None:
        """Paint shapes, one over the other, whose `points` (K, 2) lie in one array, from and to `ranges` (N, 2).

        A shape is the circle about its point if its radius (N,) is at least 0, else a polygon if `closed`, else a line.
        `inks` (N, 2, 4) are the colours of fill and edge, 0..255; `widths` (N,) are those of edges [px].
        """

    def beams(
        self,
        pixels: NDArray[np.uint8],
        origin: tuple[float, float],
        ends: Floats,
        inks: NDArray[np.uint8],
        widths: Floats,
    ) -> None:
        """Paint lines from one point to `ends` (B, 2), with colours (B, 4) of 0..255 and widths (B,) [px]."""

    def image(self, pixels: NDArray[np.uint8], above: NDArray[np.uint8], left: int, top: int) -> None:
        """Lay a picture over another; the clip box does not cut it."""

    def take_boxes(self) -> list[tuple[int, int, int, int]]:
        """Return the boxes that were painted since this was last asked."""

    def line_mask(
        self, mask: NDArray[np.uint8], points: Floats, width: float, round_caps: bool, snapped: bool
    ) -> tuple[int, int, int, int] | None:
        """Raise the levels of a mask (height, width) to those of a line; return the box that was touched."""

def compose(
    pixels: NDArray[np.uint8],
    ground: NDArray[np.uint8],
    boxes: Sequence[tuple[int, int, int, int]],
    layers: Sequence[tuple[NDArray[np.uint8], int, int, tuple[float, float, float], float]],
) -> None:
    """Put parts of a picture together from the same parts of `ground` and layers above it, the lowest first.

    A layer is an image (h, w, 4) or a mask (h, w), left and top, and colour (0..255) and opacity of the mask.
    """

def copy_boxes(
    source: NDArray[np.uint8], target: NDArray[np.uint8], boxes: Sequence[tuple[int, int, int, int]]
) -> None:
    """Copy parts of a picture to another of the same size."""

def trails(
    state: State, rows: Sequence[int], offsets: Sequence[float], ages: Sequence[int], longest: int, least: float
) -> tuple[Floats, NDArray[np.int64]]:
    """Return the trails of rows as lines in pieces.

    Args:
        state: The state, which keeps its history.
        rows: Rows (N).
        offsets: How far each line runs to the left of the position of its object (N) [m].
        ages: Borders (K + 1) of the pieces [steps], the oldest first; -1 is the start.
        longest: How far back trails reach [steps]; -1 is the start.
        least: Least distance from one point to the next [m]; borders of pieces are always points.

    Returns:
        (P, 2) points [m], and (N, K, 2) the first and the end of the points of each piece, which may have none.
    """

def place_names(
    wishes: Floats,
    height: float,
    inside: tuple[float, float, float, float],
    taken: Floats,
    walls: Floats,
    plans: Floats,
    plan_ranges: NDArray[np.int64],
    trails: Floats,
) -> list[tuple[int, float, float, float, float]]:
    """Find places for names beside the things that they name, the most important first.

    Args:
        wishes: (N, 5) middle of the thing x, y, half its width and height, width of the name.
        height: Height of all names.
        inside: Left, bottom, right and top of the part of the picture in which names stay.
        taken: (T, 4) boxes that names may not overlap.
        walls: (W, 4) boxes that they should not overlap.
        plans: (P, 2) points of lines that they should not cover, one line after the other.
        plan_ranges: (L, 2) first and end of the points of each line.
        trails: (Q, 2) points that they should not cover.

    Returns:
        For each name the number of its place, of which 8 are at each of three distances, or -1, and its box.
    """

def rgb_rows(pixels: NDArray[np.uint8]) -> bytes:
    """Return a zero and the red, green and blue of all pixels for each row, which is what PNG compresses."""

def changed_box(
    before: NDArray[np.uint8],
    after: NDArray[np.uint8],
    boxes: Sequence[tuple[int, int, int, int]] | None = None,
) -> tuple[int, int, int, int] | None:
    """Return the box that differs between two pictures, of which only `boxes` are compared; None without difference."""

def opaque_box(pixels: NDArray[np.uint8]) -> tuple[int, int, int, int] | None:
    """Return the box outside of which a picture is transparent; None if all of it is."""

class Palette:
    """Finds the nearest of at most 256 colours (0..255)."""

    def __init__(self, colors: Sequence[tuple[int, int, int]]) -> None: ...
    def encode(
        self,
        pixels: NDArray[np.uint8],
        before: NDArray[np.uint8] | None,
        box: tuple[int, int, int, int],
        boxes: Sequence[tuple[int, int, int, int]] | None,
        transparent: int,
    ) -> tuple[int, bytes]:
        """Compress a part of a picture for a GIF; return the number of pixels far from their colour, and the data.

        Pixels that are as before get the index `transparent`; only those in `boxes` may have changed.
        """

STREAMS: dict[
    str, int
]  # name → number: placement, shape, goal, motion, sensor, behavior, planner, map, user, perturbation, policy, task
