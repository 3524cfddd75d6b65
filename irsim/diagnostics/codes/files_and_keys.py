"""Codes of files, YAML, keys, values, maps and limits of size."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["FILE_AND_YAML", "KEYS_AND_VALUES", "MAPS_AND_LIMITS"]

_OWN = " One of your own is registered by its module: irsim run --import MODULE, or import it in a program."
"""The end of the explanation of a name that a module of the user may register."""

FILE_AND_YAML: dict[str, Code] = {
    # the file
    "file-not-found": Code(
        "scenario file not found",
        "No file of that name is in the places searched: as given, below sys.path[0], below the current directory, "
        "beside the running script. The message lists them and files with similar names.",
    ),
    "not-a-file": Code(
        "not a regular file", "The path names a directory, a device or a pipe. Name the YAML file itself."
    ),
    "image-not-found": Code(
        "image named by 'description' not found",
        "`description` names an image that is drawn instead of the shape: a file beside the scenario or the script,"
        " or a bundled one. Without it the shape is drawn, but for a car, which is a picture unless it has "
        "`description: ''`. Addresses such as http: are not fetched.",
    ),
    "unreadable": Code(
        "file cannot be read", "The system refuses to read the file. Check the permissions and the path."
    ),
    "not-text": Code("not a text file", "The file holds bytes that are not UTF-8 text. Save the scenario as UTF-8."),
    "file-too-large": Code(
        "file too large",
        "A scenario may have 16 MiB (servers may allow less). Write groups of objects with 'number' and "
        "'distribution' instead of one entry each.",
    ),
    "path-outside-workspace": Code(
        "path leads out of the workspace",
        "The program is confined to a folder, as irsim-mcp is to its --workspace. Scenarios, and the maps and "
        "pictures they name, must be in that folder, and paths must be relative to it (or to the scenario): no "
        "'..', no absolute path, no link that leads out, no device.",
    ),
    # YAML
    "yaml-syntax": Code(
        "not valid YAML",
        "The text breaks the grammar of YAML at this place. The cause is often a line earlier: a missing ':', an "
        "unclosed bracket or quote, a tab, or uneven indentation.",
    ),
    "empty-document": Code("nothing in the file", "The file has only blanks or comments. A scenario is a mapping."),
    "multiple-documents": Code(
        "more than one YAML document", "A line '---' starts a second document. One file holds one scenario."
    ),
    "not-a-scenario": Code(
        "not a scenario",
        "The file is valid YAML, but its content is a list or a single value, or it is a file of another kind, such as"
        " a task or a suite. A scenario is a mapping with the keys world, robot, obstacle, gui, bridges, custom.",
    ),
    "duplicate-key": Code(
        "key given twice", "A mapping has the same key twice. YAML keeps the last value; remove one of them."
    ),
    "bad-key": Code(
        "not usable as a key", "Keys must be words. Lists and mappings cannot be keys; '<<' merges mappings."
    ),
    "unsupported-tag": Code(
        "YAML tag not supported",
        "Tags such as !!python/object construct program objects, and other programs would run them. Here a scenario"
        " is plain data: tags are reported and never executed. Remove the tag, and its value too if that makes no "
        "sense alone.",
    ),
    "recursive-alias": Code(
        "alias inside its own anchor", "The value would contain itself endlessly. Write it out instead."
    ),
    "alias-expansion": Code(
        "aliases expand to too much",
        "Aliases (*name) and merge keys (<<) repeat so much that the scenario would not fit into memory.",
    ),
    "too-many-events": Code(
        "too many values",
        "The file has more values and brackets than the limit of 2 million, or more than 100,000 keys in a mapping.",
    ),
    "too-deep": Code("nested too deeply", "Lists and mappings are nested more than 64 levels deep."),
    "yaml-number-text": Code(
        "number that YAML 1.1 reads as text",
        "In YAML 1.1 a float needs a decimal point, a sign in its exponent, and a digit before the point if it has "
        "a sign: 1e3 and -.5 are text; 1.0e+3, 1000 and -0.5 are numbers.",
    ),
    "yaml-boolean": Code(
        "word that YAML 1.1 reads as a boolean",
        "yes, no, on, off, true and false are booleans unless quoted. Quote the word to keep it as text.",
    ),
    "yaml-sexagesimal": Code(
        "number in base 60",
        "YAML 1.1 reads 12:30:45 as 45045, in base 60. Quote it to keep it as text, or write the number.",
    ),
    "hash-comment": Code(
        "color read as a comment",
        "An unquoted # after a space begins a comment, so that the value before it is empty. Put the color in quotes.",
    ),
    "yaml-octal": Code(
        "octal number", "YAML 1.1 reads a number that starts with 0, such as 010, in base 8. Drop the leading zero."
    ),
}
"""Codes of a file that cannot be read, and of text that is not plain YAML data."""


KEYS_AND_VALUES: dict[str, Code] = {
    # keys and values
    "unknown-key": Code(
        "unknown key",
        "The key is not part of the language at this place; 'allowed' lists the known keys. IR-SIM 2.12 ignores most "
        "unknown keys: irsim.make and irsim run do so too, with a warning; strict reading refuses them.",
    ),
    "missing-key": Code("key missing", "This mapping needs the key, which has no default."),
    "conflicting-keys": Code("keys exclude each other", "Two keys set the same thing in different ways. Keep one."),
    "ignored-key": Code("key without effect", "Another key of the same entry makes this one meaningless."),
    "wrong-type": Code(
        "value of the wrong kind",
        "The key takes another type of value, such as a number instead of text; 'allowed' says which.",
    ),
    "wrong-length": Code(
        "wrong number of elements",
        "A vector has too few or too many numbers. Poses are [x, y] or [x, y, theta]; vel_min, vel_max, acce and "
        "velocity have one number per control component of the kinematics.",
    ),
    "scalar-list": Code(
        "list where a single number is needed",
        "A list of plain numbers is one vector for all objects, so keys that take a single number cannot be given "
        "per object (mass, friction, inertia and restitution can). Write one entry per value. In 'state' and 'goal'"
        " the cause is one level of brackets too many.",
    ),
    "not-a-mapping": Code(
        "mapping expected", "A feature is a mapping with a name: 'kinematics: {name: diff}', not 'kinematics: diff'."
    ),
    "unknown-value": Code("unknown word", "The key takes one of a fixed set of words; 'allowed' lists them."),
    "invalid-value": Code("invalid value", "The value is not valid for this key; the message says why."),
    "out-of-range": Code(
        "number out of range", "The number is outside the bounds of this key, which are in 'allowed'."
    ),
    "range-order": Code(
        "bounds in the wrong order", "The lower bound of a range must not be greater than the upper bound."
    ),
    "infinite-number": Code("infinity not allowed", "Only acce, mass and inertia may be infinite (.inf)."),
    "not-a-number": Code("NaN not allowed", "NaN (not a number) has no meaning in a scenario. Give a number."),
    "angle-over-full-turn": Code(
        "angle larger than a full turn",
        "Opening angles must be from 0 to 2π = 6.28318 radians. A value such as 90, 180 or 360 is probably in degrees.",
    ),
    "unknown-color": Code(
        "unknown color",
        "Colors are names ('red', 'tab:blue', 'xkcd:sky blue'), '#RRGGBB', a grey level as text ('0.5'), or [r, g, b] "
        "with numbers from 0 to 1.",
    ),
    # names of features
    "unknown-reward": Code(
        "unknown reward",
        "No term of rewards of that name is built in or installed; `irsim describe task.reward` lists them. A "
        'function of your own is {name: python, function: "module:function"}.',
    ),
    "unknown-part": Code(
        "unknown part of an observation",
        "No part of observations of that name is built in or installed; `irsim describe task.observation` lists them.",
    ),
    "unknown-behavior": Code(
        "unknown behavior",
        "No behavior of that name is built in or registered for the object's kinematics. Register your own with "
        "irsim.register_behavior before the scenario is read: in a Python program, or with --import MODULE on the "
        "command line. Random goals and loops are keys of every behavior, not behaviors: {name: dash, wander: "
        "true}, {name: dash, loop: true}.",
    ),
    "behavior-for-other-drive": Code(
        "behavior registered for other kinematics",
        "This behavior is registered, but not for the kinematics of this object. Register it for these kinematics too.",
    ),
    "not-a-group-behavior": Code(
        "not a group behavior", "This behavior decides for each object separately: write it under 'behavior'."
    ),
    "bad-social-group": Code(
        "social group with missing or repeated members",
        "'social_groups' of a group 'sfm' lists which members walk together, by the index of each member in its "
        "group, counted from 0 in the order of the file. Each index must be below the number of members and may "
        "occur once.",
    ),
    "unknown-kinematics": Code("unknown kinematics", "No drive of that name is built in or registered." + _OWN),
    "unknown-shape": Code("unknown shape", "No shape of that name is built in or registered." + _OWN),
    "unknown-sensor": Code("unknown sensor", "No sensor of that name is built in or registered." + _OWN),
    "unknown-distribution": Code(
        "unknown distribution", "No distribution of that name is built in or registered." + _OWN
    ),
    "unknown-map": Code("unknown map generator", "No map generator of that name is built in or registered." + _OWN),
    "unknown-planner": Code("unknown planner", "No path planner of that name is built in or registered." + _OWN),
    "unknown-bridge": Code("unknown bridge", "No bridge of that name is built in or offered by an installed package."),
    "unknown-object": Code("unknown object", "No object of the scenario has that name."),
    "unknown-zone": Code("unknown zone", "No zone of 'world.zones' has that name."),
}
"""Codes of a key or value that the language does not have."""


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
        "Every cell is occupied or unknown. Black is occupied, white is free.",
    ),
    "map-values": Code(
        "not an occupancy grid",
        "A map given as an array must have the shape (nx, ny) and numbers from 0 to 100, or -1 for unknown cells.",
    ),
    "map-generator": Code(
        "map generator failed", "The Python class registered under this name raised an exception, or returned no grid."
    ),
    "no-map": Code("no map", "The scenario has no 'world.obstacle_map', so no map can be exported."),
    "map-stand-in": Code(
        "another map is used",
        "The indoor scans of IR-SIM may not be redistributed; maps of flats made for irsim replace them "
        "under the same names.",
    ),
    "map-transparent": Code(
        "map with transparent parts",
        "Transparent pixels count as the white paper below them, so they are free. Flatten the picture on the color "
        "that you mean.",
    ),
    "map-read-as": Code(
        "how a map was read",
        "The file of a map leaves something open, or names a picture by a path of another computer. The message says "
        "what was taken; correct the file if that is wrong.",
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
        "('acker', 'tricycle') does not turn there: only 'follow' plans its way so that it comes in with the heading. "
        "'omni' keeps the heading of its start.",
    ),
    "steering-limit": Code(
        "steering angle beyond a quarter turn",
        "The second control of 'acker' is the steering angle in radians, in mode 'steer', and 'psi_max' the largest in "
        "any mode. Wheels turned by more than 1.5708 drive backwards; 30 degrees are 0.5236.",
    ),
    "placement-crowded": Code(
        "no free place for an object",
        "No free pose was found within the attempts, or the message says by arithmetic why no seed can find one: "
        "objects keep a distance, twice the radius or 'min_distance', and goals a 'goal_distance'. Use fewer or "
        "smaller objects, a larger range, or a smaller distance; with perturb, a smaller spread. In a benchmark it is "
        "the outcome of that seed: it counts in no rate and no mean, and the first line says which seeds these are.",
    ),
    "bridges-not-opened": Code(
        "simulated without the bridges of the scenario",
        "Benchmarks, training and pictures do not open the bridges of a scenario: robots that another program moves or "
        "commands in irsim run follow their own behavior here. Compare such numbers with care, or use irsim run.",
    ),
    "too-many-problems": Code("more problems than are shown", "Fix the first problems and validate again."),
}
"""Codes of maps, and of what exceeds the engine."""
