"""The intended differences, each under an id, and the keys and names they touch."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["ABSENT", "DIFFERENCES", "EXTENSIONS", "KEY_DIFFERENCES", "NAME_DIFFERENCES", "Difference"]


class Difference(NamedTuple):
    """One intended difference."""

    theirs: str
    ours: str
    why: str


DIFFERENCES: dict[str, Difference] = {
    "D1": Difference(
        "objects move one after another; later ones see earlier ones already moved",
        "all decide on one snapshot, then all move",
        "results do not depend on the order of declaration (contact pushing and random placement excepted), and "
        "batches equal single runs",
    ),
    "D2": Difference("circles are 64-gons in collision and lidar", "circles are circles", "exact and faster"),
    "D3": Difference(
        "a missing scenario file makes an empty world",
        "`FileNotFoundError` with the places searched and near matches",
        "a typo must not look like success",
    ),
    "D4": Difference(
        "unknown keys in behaviors, sensors, shapes, plot: silence or a bare TypeError",
        "a diagnostic with path, line and nearest name; `make` and `irsim run` warn where 2.12 carries on, "
        "`validate`, `strict=True` and the MCP server refuse. Numbers that a behavior cannot use (`vmax: -1`, "
        "`timeHorizon: 0`) are refused by `make`, too, but for `acce` of `rvo` and for keys with which 2.12 goes on "
        "without a group behavior",
        "whoever mistypes needs to be told",
    ),
    "D5": Difference(
        "an unknown behavior fails at the first step",
        "an error when the scenario is read (`validate`, `strict=True`); plain `make` warns, and the first step "
        "raises unless something has registered the name by then",
        "told before anything runs",
    ),
    "D6": Difference(
        "polygons and maps are one disc for `rvo` and `sfm`, and invisible to `orca`",
        "walls are walls: their segments are avoided; `orca` also sees movers outside its group",
        "robots drove through walls or stayed metres away",
    ),
    "D7": Difference(
        "entries placed at random may overlap each other and obstacles",
        "they keep clear of everything placed before; what finds no room is an error",
        "a scenario must not start in collision",
    ),
    "D8": Difference(
        "`end()` and module-level aliases touch state that environments share",
        "everything belongs to its environment; `irsim.config.*` follows the one used last",
        "several environments in one process",
    ),
    "D9": Difference("`world.name` and `role` raise", "they are accepted", "they are documented"),
    "D10": Difference(
        "random draws come from one generator in the order of calls",
        "each draw is keyed by seed, scene, noise episode, stream, object and number",
        "a world of a batch draws what it draws alone; numbers differ from 2.12",
    ),
    "D11": Difference(
        "`orca` keeps velocities of its own, in single precision; `diff` members leave heading errors below 0.1 rad "
        "alone",
        "real velocities, double precision; who avoids somebody turns however little the new velocity is off its "
        "heading (who avoids nobody leaves 0.1 rad alone as in 2.12)",
        "the solver planned from fiction: fed with the real velocity, it would ask for the same small turn again and "
        "again, and nobody would ever make it",
    ),
    "D12": Difference(
        "status, arrival and collisions exist after the first step",
        "they are evaluated by `make` and `reset`, too",
        "observations of a reset",
    ),
    "D13": Difference(
        "behaviors exist for some drives only",
        "every built-in behavior works on every drive",
        "users expect it",
    ),
    "D14": Difference(
        "`state`, scans and others are live internals",
        "read-only snapshots, scans are copies; write through `set_state` and its like",
        "writes that vanish or corrupt",
    ),
    "D15": Difference(
        "a map cell collides as a disc plus the outline; planners stand on cell corners",
        "cells are squares; planners search the grid inflated by the footprint, nodes in cell centres",
        "the robot that has to drive the path",
    ),
    "D16": Difference(
        "bundled maps of third parties",
        "maps of our own under the old names",
        "licences",
    ),
    "D17": Difference(
        "sampling planners, and maps without `seed`, ignore the environment's seed",
        "they draw from its named streams",
        "reproducible",
    ),
    "D18": Difference(
        "the field of view can miss a large object straight ahead",
        "an object is seen when any part of it lies in the sector; occlusion is optional",
        "correct",
    ),
    "D19": Difference(
        "`object_patch`, `goal_patch`, … of an object are artists of the environment's figure",
        "the figure draws all objects together; these are what a script has drawn with `plot`, `plot_goal`, …; "
        "`plot_kwargs` and `render(…)` change looks",
        "pictures of many objects stay fast",
    ),
    "D20": Difference(
        "`collision_mode: contact` resolves overlaps in at most 32 sweeps; dense jams may stay inside each other",
        "the same sweeps, then up to 480 more while anything is deeper than 0.5 mm, the later ones with drivers that "
        "stall and wedged bodies that stay put (fewer of both where more than 8,000 pairs touch at once); where 32 "
        "suffice both agree to rounding",
        "things should not stay inside each other",
    ),
    "D21": Difference(
        "attributes can be written, but some writes are only kept (`lidar.number`, `info`), or half of them "
        "(`step_time`: the clock goes on as before)",
        "a write takes effect at once, or it is an error that names what to call; `world_param.step_time` may be set "
        "before the first step, `collision_mode` and others at any time",
        "nobody should learn from wrong results that a line did nothing",
    ),
    "D22": Difference(
        "under `arrive_mode: state` `dash` stands at the goal with a heading error below `angle_tolerance`, or swings "
        "about it, and does not arrive where position and heading together are off by `goal_threshold`",
        "the same law, but where it would leave `omni_angular` standing or swinging it turns the rest; under the other "
        "behaviors it turns there, too",
        "a robot at its goal should arrive",
    ),
    "format-3": Difference(
        "`obstacle: {…}` joins group 0 and is driven by its group behavior",
        "the same, with a warning; the map is in no group",
        "rarely meant",
    ),
    "format-12": Difference(
        "a self-crossing polygon becomes its bounding box",
        "an error with a repaired outline; `make` warns and uses the repaired one",
        "the box is not what was drawn",
    ),
    "format-17": Difference(
        "headings of the circle distribution are not wrapped, a goal of the entry is ignored",
        "headings in [-π, π); a goal that is given wins",
        "one convention for angles",
    ),
    "format-18": Difference(
        "`wander` without a range draws goals in 10 m × 10 m at the origin",
        "the world's own extent",
        "goals outside the world",
    ),
    "dynamics-18": Difference(
        "state rows beyond those of the drive are overwritten in each step",
        "they keep their value",
        "a slip",
    ),
    "api-6": Difference(
        "after `reset()` a wanderer heads for the configured goal", "it draws one again", "it is a wanderer"
    ),
    "api-7": Difference("`world_param.time` is stale after `reset()`", "it is 0", "a slip"),
    "api-10": Difference(
        "deleted objects stay in their behavior group, added ones join none", "groups follow the objects", "a slip"
    ),
    "api-12": Difference(
        "`random_obstacle_position` moves the map, `random_polygon_shape` fails with one obstacle",
        "the map stays, one obstacle works",
        "slips",
    ),
    "api-13": Difference("`get_obstacle_info_list` fails with a map", "it works", "a slip"),
    "api-15": Difference("`info.goal` is stale after `set_goal`", "it follows", "a slip"),
    "api-18": Difference("A* gives a one-point path if there is none", "None", "as the other planners"),
    "api-19": Difference(
        "a saved frame lags by one render", "it shows the state it is saved at", "pictures one can trust"
    ),
    "api-22": Difference("the key `v` saves into the animation buffer", "into `figure`", "where figures go"),
    "api-24": Difference("`render(show_goal=False)` hides nothing", "it hides the goal", "as written"),
    "api-25": Difference("environments share one animation buffer", "each has its own", "frames do not mix"),
}
"""Those with a D are general; the others name the surprise of the reference they settle."""

KEY_DIFFERENCES: dict[str, str] = {
    "world.name": "D9",
    "world.collision_mode": "D20",
    "world.obstacle_map": "D15, D16, D17",
    "entry.role": "D9",
    "entry.distribution": "D7, format-17",
    "entry.arrive_mode": "D22",
    "entry.fov": "D18",
    "entry.fov_radius": "D18",
    "entry.group": "format-3",
    "entry.state_dim": "dynamics-18",
    "entry.behavior": "D5, D13",
    "entry.group_behavior": "D5, D11, D13",
    "entry.shape": "D2, format-12",
    "behavior.wander": "format-18",
    "behavior.range_low": "format-18",
    "behavior.range_high": "format-18",
    "behavior.rvo": "D1, D6",
    "behavior.sfm": "D1, D6",
    "behavior.orca": "D6, D11",
}
"""By place: ``world.KEY``, ``entry.KEY`` of robots and obstacles, ``behavior.KEY``."""

EXTENSIONS: dict[str, str] = {
    "world.boundary": "walls at the world's edge",
    "world.seed": "default seed",
    "world.time_limit": "horizon of a run",
    "world.description": "free text",
    "world.metadata": "free mapping",
    "entry.tags": "free words; pedestrian is what metrics count as human",
    "entry.waypoints": "goals one after the other, without the third bracket",
    "entry.fov_occlusion": "what is hidden is not seen",
    "behavior.follow": "plan a path, follow it with a local behavior",
    "kinematics.acker.psi_max": "largest steering angle",
    "map.ros": "maps of ROS map_server",
}
"""Keys of irsim that 2.12 does not have; files without them mean the same."""

NAME_DIFFERENCES: dict[str, str] = {
    "EnvBase.step": "D1",
    "EnvBase.end": "D8",
    "EnvBase.reset": "D12, api-6",
    "EnvBase.render": "api-19, api-24",
    "EnvBase.get_obstacle_info_list": "api-13",
    "EnvBase.delete_object": "api-10",
    "EnvBase.add_object": "api-10",
    "EnvBase.random_obstacle_position": "D10, api-12",
    "EnvBase.random_polygon_shape": "D10, api-12",
    "EnvBase.set_random_seed": "D10",
    "EnvBase.get_robot_state": "D14",
    "EnvBase.get_map": "D15",
    "EnvBase.objects": "D21",
    "ObjectBase.beh_config": "D21",
    "ObjectBase.state": "D14",
    "ObjectBase.velocity": "D14",
    "ObjectBase.goal": "D14",
    "ObjectBase.fov_detect_object": "D18",
    "ObjectBase.get_fov_detected_objects": "D18",
    "ObjectBase.check_collision": "D2, D15",
    "ObjectBase.set_random_goal": "D10",
    "ObjectBase.plot": "D19",
    "ObjectBase.plot_clear": "D19",
    "EnvPlot.step": "D19",
    "EnvPlot.clear_components": "D19",
    "EnvPlot.draw_components": "D19",
    "AStarPlanner.planning": "D15, api-18",
    "JPSPlanner.planning": "D15",
    "RRT.planning": "D17",
    "RRTStar.planning": "D17",
    "InformedRRTStar.planning": "D17",
    "PRMPlanner.planning": "D17",
    "Map.is_collision": "D15",
}
"""By ``Class.name``."""

_SEARCH = "the search runs in the engine: `planning` gives the path, `node_list` what was searched"
_SEARCH_STEPS = {
    "AStarPlanner": "Node calc_final_path calc_grid_index calc_grid_position calc_heuristic calc_xy_index check_node "
    "get_motion_model verify_node",
    "JPSPlanner": "calc_grid_index_from_xy calc_grid_position calc_xy_index is_collision",
    "PRMPlanner": "check_node dijkstra_planning generate_road_map is_collision plot_road_map sample_points",
    **dict.fromkeys(
        ("RRT", "RRTStar", "InformedRRTStar"),
        "AreaBounds Node calc_dist_to_goal calc_distance_and_angle draw_graph get_random_node is_collision steer",
    ),
}

_INSIDE = "a part of 2.12's inside that no script needs"
_INTERNAL = (
    "irsim.lib.path_planners.grid_planner_base",
    "irsim.util.decorator",
    "irsim.util.message",
    "irsim.world.map.perlin_map_generator.generate_perlin_noise",
    "irsim.world.object_plot",
)

ABSENT: dict[str, str] = {
    **dict.fromkeys(_INTERNAL, _INSIDE),
    "irsim.lib.algorithm.contact": "contacts are found in the engine: `irsim.lib.contact_step`, `env.contacts`",
    "irsim.env.env_logger:EnvLogger.CONSOLE_FORMAT": "lines are written without loguru, in this same format",
    **dict.fromkeys(
        (f"irsim.world.sensors:Contact2D.{name}" for name in ("add", "add_force", "clear", "reset", "tick")),
        "the step of the engine writes contacts; read `reports`, `records`, `force`",
    ),
    **{
        f"irsim.lib.path_planners:{planner}.{name}": _SEARCH
        for planner, names in _SEARCH_STEPS.items()
        for name in names.split()
    },
}
"""Names of 2.12 that are not here, and the reason."""
