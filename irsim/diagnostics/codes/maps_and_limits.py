"""Codes of maps, and of scenarios that the engine cannot simulate or place."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["MAPS_AND_LIMITS"]

MAPS_AND_LIMITS: dict[str, Code] = {
    # maps
    "map-not-found": Code(
        "map file not found",
        "A map is searched as given, beside the scenario, below sys.path[0], beside the running script, and among "
        "the bundled ones: cave.png, office.png, maze.png, flat_1.png, flat_2.png.",
    ),
    "map-unreadable": Code(
        "map file cannot be read",
        "A map is a picture that Pillow reads (PNG, PGM, JPEG, BMP, ...), black where it is occupied. A ROS map is "
        "a YAML file with the keys image, resolution and origin.",
    ),
    "map-too-large": Code(
        "map too large",
        "A map may have 64 million cells and, as a file, 256 MiB; servers allow less. Scale the picture down: cells"
        " of 5 cm are fine enough for most robots.",
    ),
    "map-empty": Code(
        "map without walls", "No cell is occupied, so there is no map object. Black is occupied, white is free."
    ),
    "map-full": Code(
        "map without free space",
        "Every cell is occupied. Black is occupied, white is free.",
    ),
    "map-values": Code(
        "not an occupancy grid",
        "A map given as an array must have the shape (nx, ny) and numbers from 0 to 100.",
    ),
    "map-generator": Code(
        "map generator failed",
        "The Python class registered under this name raised an exception, or returned no grid.",
    ),
    "no-map": Code(
        "no map",
        "The scenario has no 'world.obstacle_map', so no map can be exported.",
    ),
    "map-stand-in": Code(
        "another map is used",
        "The indoor scans of IR-SIM may not be redistributed; maps of flats made for irsim replace them "
        "under the same names.",
    ),
    # engine
    "not-yet-simulated": Code(
        "valid, but not simulated yet",
        "The language has the feature, but the engine of this version does not simulate it and reports that instead"
        " of ignoring it.",
    ),
    "too-large": Code(
        "number beyond any world",
        "Lengths and positions of more than 1e7 m, and speeds above 1e7 m/s, lose their precision to rounding. "
        "Lengths are in metres.",
    ),
    "placement-impossible": Code(
        "more objects than fit",
        "The objects of this entry keep a distance (twice the radius, or 'min_distance'), and no arrangement of "
        "that number of points fits into the range. No other seed or order can help: use fewer or smaller objects, "
        "or a larger range.",
    ),
    "placement-tight": Code(
        "random placement is likely to fail",
        "Objects that are placed at random, one after another, block each other when they cover about half of the "
        "area. Some seeds may succeed, most end with 'placement-crowded'. irsim validate tries 20 seeds and reports"
        " how many fail.",
    ),
    "heading-not-reached": Code(
        "heading of the goal is not steered for",
        "With 'arrive_mode: state' an arrival needs position and heading. Under every built-in behavior 'diff' and "
        "'omni_angular' turn to the goal's heading once they are within 'goal_threshold' of the position. A car "
        "('acker') cannot turn on the spot: only 'follow' plans its way so that it comes in with the heading. "
        "'omni' keeps the heading of its start.",
    ),
    "steering-limit": Code(
        "steering angle beyond a quarter turn",
        "The second control of 'acker' is the steering angle in radians, in mode 'steer', and 'psi_max' the largest in "
        "any mode. Wheels turned by more than 1.5708 drive backwards; 30 degrees are 0.5236.",
    ),
    "placement-crowded": Code(
        "random placement or a perturbation found no free place",
        "No free pose was found within the attempts. Use fewer or smaller objects, a larger range, or a smaller "
        "min_distance; with perturb, a smaller spread. In a benchmark it is the outcome of that seed: it counts in no "
        "rate and no mean, and the first line says which seeds these are.",
    ),
    "bridges-not-opened": Code(
        "simulated without the bridges of the scenario",
        "Benchmarks, training and pictures do not open the bridges of a scenario: robots that another program moves or "
        "commands in irsim run follow their own behavior here. Compare such numbers with care, or use irsim run.",
    ),
    "too-many-problems": Code(
        "more problems than are shown",
        "Fix the first problems and validate again.",
    ),
}
"""Codes of maps, and of what exceeds the engine."""
