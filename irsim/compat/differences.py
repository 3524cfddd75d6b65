"""The intended differences from IR-SIM 2.12, each with an id, and the keys and names that they affect."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["CHANGED_SCENES", "DIFFERENCES", "EXTENSIONS", "KEY_DIFFERENCES", "NAME_DIFFERENCES", "Difference"]


class Difference(NamedTuple):
    """One intended difference: the behaviour of IR-SIM 2.12, the behaviour of irsim, and the reason."""

    theirs: str
    ours: str
    why: str


DIFFERENCES: dict[str, Difference] = {
    "D1": Difference(
        "objects move one after another; later objects see the new positions of earlier ones",
        "all objects decide on one snapshot, then all move",
        "results do not depend on the order of declaration (except for contact pushing and random placement), and "
        "batches equal single runs",
    ),
    "D2": Difference("circles are 64-gons in collision and lidar", "circles are circles", "exact and faster"),
    "D3": Difference(
        "a missing scenario file results in an empty world",
        "`FileNotFoundError` with the folders searched and similar names",
        "a typo must not look like success",
    ),
    "D4": Difference(
        "unknown keys in behaviors, sensors, shapes, plot are ignored or cause a bare TypeError",
        "a diagnostic with path, line and nearest name: a warning of `make` and `irsim run` where 2.12 continues, an "
        "error in `validate`, with `strict=True` and in the MCP server. Numbers that a behavior cannot use (`vmax: "
        "-1`, `timeHorizon: 0`) are errors in `make`, too, except for `acce` of `rvo` and for keys with which 2.12 "
        "continues without a group behavior",
        "a typo must not go unnoticed",
    ),
    "D5": Difference(
        "an unknown behavior fails at the first step",
        "an error when the scenario is read (`validate`, `strict=True`); plain `make` warns, and the first step "
        "raises an error unless the name has been registered by then",
        "errors should be reported before anything runs",
    ),
    "D6": Difference(
        "polygons and maps are one disc for `rvo` and `sfm`, and invisible to `orca`; linestrings are endless cones "
        "for `rvo` at any distance, and `sfm` adds the push of all their segments, also of hidden ones",
        "static walls are walls however they are written: a rectangle, polygon, compound, linestring or block of map "
        "cells of the same outline gives the same motion (under `follow`, too, unless it plans on the cells of a map: "
        "in worlds of more than 2,500 m^2, or where its own grid of 0.1 m shows no way). Walls that stand free are "
        "passed on the nearer side by `rvo`, `sfm`, `orca` and `avocado`, walls round the object block what reaches "
        "them; posts beside a free way hold no robot back under `sfm`. `unobstructed` linestrings count for `rvo` and "
        "`sfm` as in 2.12, other `unobstructed` walls for none. Moving polygons stay discs, moving linestrings as in "
        "2.12. `orca` also sees moving objects outside its group",
        "robots drove through walls, stayed metres away from them or stood before them, and closed rooms of "
        "linestrings blocked every direction",
    ),
    "D7": Difference(
        "randomly placed objects can overlap each other and obstacles",
        "they do not overlap anything placed before; an object that cannot be placed is an error",
        "a scenario must not start in collision",
    ),
    "D8": Difference(
        "`end()` and module-level aliases change state that environments share",
        "each environment has its own state; `irsim.config.*` follows the environment used last",
        "several environments in one process must not affect each other",
    ),
    "D9": Difference("`world.name` and `role` raise an error", "they are accepted", "they are documented"),
    "D10": Difference(
        "random draws come from one generator in the order of calls",
        "each draw is keyed by seed, scene, noise episode, stream, object and number; values differ from 2.12",
        "a world gives the same draws in a batch as alone",
    ),
    "D11": Difference(
        "`orca` computes with its own velocities, in single precision; `diff` members ignore heading errors below 0.1 "
        "rad",
        "`orca` computes with the true velocities, in double precision; a member that avoids another object also turns "
        "by less than 0.1 rad (a member that avoids nothing ignores such errors as in 2.12)",
        "velocities of its own differ from the true motion; and with true velocities, a small turn that is ignored "
        "would be requested in each step without ever being executed",
    ),
    "D12": Difference(
        "status, arrival and collisions exist after the first step",
        "`make` and `reset` evaluate them, too",
        "the observation after a reset needs them",
    ),
    "D13": Difference(
        "behaviors exist for some drives only",
        "every built-in behavior works on every drive",
        "users expect it",
    ),
    "D14": Difference(
        "`state`, scans and other arrays are the internal ones",
        "they are read-only snapshots, and scans are copies; `set_state` and similar methods change them",
        "direct writes were lost or corrupted the state",
    ),
    "D15": Difference(
        "a map cell collides as a disc plus the outline; the nodes of planners are cell corners",
        "cells are squares; planners search the grid inflated by the footprint, and their nodes are cell centres",
        "the robot must fit along the whole path",
    ),
    "D16": Difference(
        "bundled maps come from third parties",
        "the maps with these names were made for irsim",
        "licences",
    ),
    "D17": Difference(
        "sampling planners, and maps without `seed`, ignore the environment's seed",
        "they draw from its named streams",
        "results are reproducible",
    ),
    "D18": Difference(
        "the field of view can miss a large object straight ahead",
        "an object is seen when any part of it lies in the sector; occlusion is optional",
        "correctness",
    ),
    "D19": Difference(
        "`object_patch`, `goal_patch`, … of an object are artists of the environment's figure",
        "the figure draws all objects together; these attributes hold what a script has drawn with `plot`, "
        "`plot_goal`, …; `plot_kwargs` and `render(…)` change the style",
        "drawing many objects stays fast",
    ),
    "D20": Difference(
        "`collision_mode: contact` resolves overlaps in at most 32 sweeps; in dense jams objects can stay inside each "
        "other",
        "the same sweeps, then up to 480 more while any overlap is deeper than 0.5 mm; in the later ones, stalled "
        "drives stop pushing and wedged bodies stay in place (fewer sweeps if more than 8,000 pairs touch at once). If "
        "32 sweeps suffice, both agree to rounding",
        "objects should not stay inside each other",
    ),
    "D21": Difference(
        "attributes can be written, but some writes have no effect (`lidar.number`, `info`, `step_mode` of the "
        "world: actions still move robots) or only part of it (`step_time`: the clock does not change)",
        "a write takes effect at once, or it is an error that names the method to call; `world_param.step_time` can be "
        "set before the first step, `collision_mode`, `step_mode` and others at any time",
        "a line without effect should not be found only through wrong results",
    ),
    "D22": Difference(
        "with `arrive_mode: state`, `dash` stops at the goal with a heading error below `angle_tolerance`, or "
        "oscillates around it, and does not arrive if position and heading error together exceed `goal_threshold`",
        "the same law, but `omni_angular`, and `diff` under every behavior, turn the rest: `diff` brakes for its goal, "
        "stands there and turns on the spot, unless its behavior avoids an object that would run into it; a car "
        "reaches goal poses under `follow`",
        "a robot at its goal should arrive",
    ),
    "D23": Difference(
        "`mdownsample: N` keeps every Nth row and column of a map, so thin walls disappear",
        "blocks of N x N cells are merged; a block has the largest occupancy of its cells",
        "a wall in the picture must be a wall in the world",
    ),
    "D24": Difference(
        "transparent pixels of a picture have the color that is stored below them, mostly black: occupied",
        "they count as white: free; a warning says how many there are",
        "a plan drawn on transparent paper is meant as it looks",
    ),
    "D25": Difference(
        "mirror-image scenes, such as two that meet head-on or a circle swap, are resolved by the order in which "
        "objects move; `sfm` takes the side of a rounding error",
        "all objects decide on one snapshot (D1); of two that are each other's mirror images and whose ways meet, both "
        "keep to their right under `rvo`, `sfm`, `orca` and `avocado`, in any order of the file, as does `orca` or "
        "`avocado` with a circle that stands exactly ahead. `sidestep: 0` is the law without this rule",
        "the circle swap that works there works here",
    ),
    "D26": Difference(
        "contacts are judged at the ends of steps, and nothing says what happened between: a fast robot passes through "
        "a wall, and the run succeeds",
        "they are judged at the ends of steps by default (`world.contacts: step_end`), and contacts within a step are "
        "reported: `contact_between_steps`, and `passed_through` if the middle of one went through the other; `swept` "
        "lets them count as collisions, and with `collision_mode: contact` bodies do not pass through others",
        "a robot that passed through a wall must not count as successful without a word",
    ),
    "D27": Difference(
        "under `rvo`, `diff` ignores heading errors below 0.1 rad and turns at most at 1.5 rad/s",
        "while it avoids something it makes each turn at once, as fast as its own limit allows; `turning: fixed` is "
        "the law of 2.12",
        "robots that swap places over and over touched each other, however well they chose their velocities",
    ),
    "D28": Difference(
        "behaviors choose velocities as if speeds changed at once: with `acce` a heading swings about the wanted one, "
        "and robots drive into walls and each other",
        "with `acce` turns end at the wanted heading, and `rvo`, `sfm` and `orca` brake in time; without it nothing "
        "changes",
        "behaviors that ignore a limit collide (success of 10 robots under `orca`, `acce: [1, 4]`: 53 -> 95 %)",
    ),
    "D29": Difference(
        "under `rvo` and `sfm`, robots run into each other where every velocity is blocked, while they turn, and where "
        "forces are too weak",
        "in one step a robot takes at most two fifths of the gap to another circle: two that do so never touch; "
        "`keep_gap: false` is the law of 2.12, which obstacles keep",
        "of 50 robots that swap places over and over some touched, and under `sfm` nearly all",
    ),
    "D30": Difference("cells of arrays below 0 are free", "they are unknown", "maps of ROS have -1 for unknown"),
    "D31": Difference("pictures have one style", "commands draw in the style `modern`", "it is easier to read"),
    "format-3": Difference(
        "`obstacle: {…}` joins group 0 and follows its group behavior",
        "the same, with a warning; the map is in no group",
        "this is rarely intended",
    ),
    "format-12": Difference(
        "a self-crossing polygon becomes its bounding box",
        "an error that suggests a repaired outline; `make` warns and uses the repaired outline",
        "the box is not the shape in the file",
    ),
    "format-17": Difference(
        "headings of the circle distribution are not wrapped, and a goal of the entry is ignored",
        "headings are in [-π, π), and a goal of the entry takes precedence",
        "one convention for angles",
    ),
    "format-18": Difference(
        "`wander` without a range draws goals in 10 m × 10 m at the origin",
        "it draws them in the extent of the world",
        "goals could lie outside the world",
    ),
    "dynamics-18": Difference(
        "state rows that the drive does not have are overwritten in each step",
        "they keep their value",
        "an error in 2.12",
    ),
    "api-6": Difference(
        "after `reset()`, a wandering robot heads for the configured goal",
        "it draws a new goal",
        "a wandering robot has random goals",
    ),
    "api-7": Difference("`world_param.time` is stale after `reset()`", "it is 0", "an error in 2.12"),
    "api-10": Difference(
        "deleted objects stay in their behavior group, and added ones join none",
        "groups follow the objects",
        "an error in 2.12",
    ),
    "api-12": Difference(
        "`random_obstacle_position` moves the map, and `random_polygon_shape` fails with one obstacle",
        "the map stays, and one obstacle works",
        "errors in 2.12",
    ),
    "api-13": Difference("`get_obstacle_info_list` fails with a map", "it works", "an error in 2.12"),
    "api-15": Difference("`info.goal` is stale after `set_goal`", "it follows", "an error in 2.12"),
    "api-18": Difference(
        "A* returns a path of one point if it finds no path", "it returns None", "as the other planners do"
    ),
    "api-19": Difference(
        "a saved frame lags by one render", "it shows the state at which it is saved", "pictures must be correct"
    ),
    "api-22": Difference(
        "the key `v` saves to the animation buffer", "it saves to `figure`", "figures belong in this folder"
    ),
    "api-24": Difference("`render(show_goal=False)` hides nothing", "it hides the goal", "as the option says"),
    "api-25": Difference("environments share one animation buffer", "each has its own", "frames must not mix"),
    "api-26": Difference("notebooks may save pictures inside Python", "in the working directory", "it is theirs"),
}
"""Id -> difference. Ids with a D are general; the others name the part of IR-SIM 2.12 in which it was found."""

KEY_DIFFERENCES: dict[str, str] = {
    "world.name": "D9",
    "world.collision_mode": "D20, D26",
    "world.obstacle_map": "D15, D16, D17, D24, D30",
    "world.mdownsample": "D23",
    "entry.role": "D9",
    "entry.distribution": "D7, format-17",
    "entry.arrive_mode": "D22",
    "entry.acce": "D28",
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
    "behavior.rvo": "D1, D6, D25, D27, D29",
    "behavior.sfm": "D1, D6, D25, D29",
    "behavior.orca": "D6, D11, D25",
}
"""Key -> ids: ``world.KEY``, ``entry.KEY`` of robots and obstacles, ``behavior.KEY``."""

FEATURES: dict[str, tuple[str, ...]] = {
    "behavior": ("dash", "orca", "rvo", "sfm"),
    "bridge": (),
    "distribution": ("circle", "manual", "random"),
    "kinematics": ("acker", "diff", "omni", "omni_angular", "static"),
    "map": ("image", "perlin"),
    "planner": ("astar", "informed_rrt_star", "jps", "prm", "rrt", "rrt_star"),
    "sensor": ("contact2d", "fmcw_lidar2d", "lidar2d"),
    "shape": ("circle", "compound", "linestring", "polygon", "rectangle"),
}
"""Kind -> features that IR-SIM 2.12 has, too; all others are additions."""

EXTENSIONS: dict[str, str] = {
    "bridges": "connections to other programs",
    "world.boundary": "walls at the edge of the world",
    "kinematics.diff.track": "for `world.zones` with `slip`",
    "entry.actuation": "dead time, lag, jerk and noise between a command and its execution",
    "world.seed": "default seed",
    "world.contacts": "contacts within a step can count as collisions",
    "world.integration": "exact arcs within a step instead of Euler's law",
    "world.time_limit": "time horizon of a run",
    "world.description": "any text",
    "world.metadata": "any mapping",
    "world.zones": "lines and areas that are watched, and areas whose ground lets wheels slip",
    "world.plot.show_zones": "draw them",
    "entry.tags": "any words; metrics count objects with the tag pedestrian as humans",
    "entry.waypoints": "several goals in order, with fewer brackets than in `goal`",
    "entry.fov_occlusion": "hidden objects are not seen",
    "entry.reflectivity": "for lidars with `realism`",
    "entry.material": "for lidars with `realism`",
    "entry.perceives": "behaviors and policies decide from an estimate of the pose, or from tracks of other objects",
    **{f"sensor.{lidar}.device": "a lidar that one can buy" for lidar in ("lidar2d", "fmcw_lidar2d")},
    **{f"sensor.{lidar}.realism": "errors of its ranges" for lidar in ("lidar2d", "fmcw_lidar2d")},
    **{f"sensor.{lidar}.rate": "scans per second" for lidar in ("lidar2d", "fmcw_lidar2d")},
    **{f"sensor.{lidar}.latency": "age of the scans that programs read" for lidar in ("lidar2d", "fmcw_lidar2d")},
    "behavior.follow": "plan a path and follow it with a local behavior",
    "behavior.rvo.sidestep": "a side on which to pass, or the law of ties (D25)",
    "behavior.rvo.turning": "turns of the drive while it avoids something (D27)",
    "behavior.rvo.keep_gap": "whether a step takes only a share of a gap (D29)",
    "behavior.sfm.keep_gap": "whether a step takes only a share of a gap (D29)",
    "behavior.sfm.sidestep": "a side on which to pass, or the law of ties (D25)",
    "behavior.orca.sidestep": "a side on which to pass, or the law of ties (D25)",
    "kinematics.acker.psi_max": "largest steering angle",
    "map.ros": "maps of ROS map_server",
}
"""Keys that only irsim has; the meaning of files without them does not change."""

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
"""``Class.name`` -> ids."""

CHANGED_SCENES: dict[str, tuple[str, str]] = {
    "templates/room-evacuation": ("D25", "people start as mirror images of each other on both sides of the door"),
    "templates/circle-swap": ("D27", "robots with `rvo` and a `diff` drive avoid each other"),
    "templates/crowd": ("D27", "the robot, with `rvo` and a `diff` drive, avoids people"),
    "templates/head-on": ("D27", "robots with `rvo` and a `diff` drive avoid each other"),
}
"""Folder of a scene of this repository that a difference has changed -> its id, and what meets there.

All other templates and all scenes recorded from 2.12 move as before; its recorded decisions, too, with
`turning: fixed` and `keep_gap: false`, and without static lines (D6) and `acce` (D28).
"""
