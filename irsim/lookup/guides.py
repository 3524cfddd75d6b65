"""Short texts about subjects that are not keys of a scenario: the program around it, seeds, units, outcomes."""

from __future__ import annotations

from typing import NamedTuple

from irsim.lookup.units import UNIT_TABLE

__all__ = ["GUIDES", "Guide"]


class Guide(NamedTuple):
    """A short text, an example, and the words of a query that lead to it."""

    title: str
    text: str
    example: str | None
    words: tuple[str, ...]


_PROCESS = """\
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    if asked["type"] == "hello":
        answer = {"type": "policy", "output": "velocity", "stochastic": False}
    elif asked["type"] == "reset":
        answer = {"type": "ready"}
    else:
        decision = []
        for (x, y, _), (gx, gy, _) in zip(asked["pose"], asked["goal"]):
            d = max(((gx - x) ** 2 + (gy - y) ** 2) ** 0.5, 1e-9)
            decision.append([(gx - x) / d, (gy - y) / d])
        answer = {"type": "decision", "decision": decision}
    print(json.dumps(answer), flush=True)
"""

GUIDES: dict[str, Guide] = {
    "program": Guide(
        "the Python loop around a scenario",
        "env.step(action, id) advances one period: without action every object follows its behavior; with one, robot "
        "`id` (or a list of ids with a list of actions) executes these controls, limited as in the file: [forward, yaw "
        "rate] for diff, [forward, lateral] for omni, [forward, steering angle] for acker. "
        "env.reset() starts the same layout again; env.reset(random=True) draws the next layout: random positions, "
        "goals and shapes of robots and obstacles. With a seed (argument or world.seed) the sequence of layouts is "
        "the same every time, without one it is different. env.get_lidar_scan(id)['ranges'] goes from the rightmost "
        "beam to the leftmost; a beam that hits nothing has the value range_max; ['radial_velocity'] has "
        "the speeds of an fmcw_lidar2d. env.done() is true when every robot has arrived "
        "or stopped after a collision; env.outcome says which. A program must count its steps: world.time_limit "
        "applies only to `irsim run` and run_episode.",
        "import irsim\n\nenv = irsim.make('scenario.yaml', seed=1)\nfor _ in range(300):\n    env.step([1.0, 0.2], 0)\n"
        "    if env.done():\n        env.reset(random=True)\nenv.end()",
        ("reset", "env", "env.reset", "env.step", "step", "python", "action", "actions", "loop", "episode"),
    ),
    "seeds": Guide(
        "what is random, and how to repeat it",
        "These are random: the distributions random, circle_crossing and square_crossing, shapes with random_shape, "
        "wander goals, maps without their own seed, noise, the decisions of avocado, of footprint_orca without "
        "progress and of policies that draw numbers. The same file, seed and version give the same run, bit by bit. "
        "The argument seed overrides world.seed; "
        "without either, a seed is drawn and reported. A scenario without any of these runs the same with every seed; "
        "perturb lets the seed change its starts.",
        None,
        ("random", "randomness", "reproducible", "reproduce"),
    ),
    "which-policy": Guide(
        "which policy avoids collisions best, and what it costs",
        "`irsim policies --for FILE` ranks policies for your scene, and says why one trained elsewhere does not "
        "suit it. Compare them there: success, collision and time-out have 95 % intervals, differences are those "
        "with the same seeds, and times of decisions come with the result. The MCP tool is benchmark, with "
        "scenarios and policies. For robots with a differential drive that cross a free square, take the suite "
        "random_polygons_v1, or one of its scenarios, such as random_polygons_v1/robots-10/freeze. Its tables with 5 "
        "to 25 robots, beside the IR-SIM paper's, and what a decision costs: "
        "skills/irsim-benchmark/results/policies_of_the_paper.md (for MCP hosts: "
        "skill://irsim-benchmark/results/policies_of_the_paper.md). No policy there does better than footprint_orca, "
        "which takes 3 to 5 times as long as orca to decide and touches no other robot. Where arrived robots "
        "stay where they are (freeze) multi_robot_freeze and multi_robot come next, and orca and avocado block "
        "themselves; where they make room (yield) orca and avocado come next. Networks take 20 to 3,000 times as long "
        "as orca. A policy is as good as its training: sarl knows five people on a circle, sarl_multi_robot and rl_rvo "
        "up to ten robots, and of the trained ones only those with a lidar see static obstacles. Among walls take "
        "follow with a local behavior.",
        "irsim benchmark random_polygons_v1 --scenario robots-10 "
        "--policies orca,avocado,sarl_multi_robot,rl_rvo,ppo,footprint_orca --seeds 50",
        (
            *(
                "which policy",
                "best policy",
                "compare policies",
                "comparison of policies",
                "results",
                "table 2",
                "table",
            ),
            *("policies of the paper", "policies_of_the_paper", "table_2", "leaderboard", "cost of a decision"),
        ),
    ),
    "process": Guide(
        "a policy in another process",
        "For a stack that cannot be imported: another language, another Python, a robot's own software. --policy "
        '"{name: process, command: [python3, mine.py]}" starts the program and talks to its standard input and '
        "output; {name: process, address: '127.0.0.1:9000'} (or the path of a socket) connects to one that "
        "listens on this machine. The MCP tools never start one. Each line is a JSON object, and each that irsim "
        "sends is answered by one. `hello` (protocol, version): answer `policy` with output (velocity: [vx, vy] "
        "in the world frame, which every drive follows; control: the controls of the drive) and, if needed, name, "
        "needs ({neighbors: 5, scan: true}), drives, decision_dt, stochastic. `reset` (world, robots, step_time, "
        "decision_steps, drive, footprints, seed): answer `ready`. `act` (the fields of "
        "irsim.policies.Observations, one row for each robot that decides now; null: not a number or no limit): "
        "answer `decision` with one row for each robot. timeout (default 5 s) bounds a decision, start_timeout "
        "(30 s) the other answers. A process that hangs, ends or answers something else ends the episode with "
        "that reason (policy-lost); the next episode starts it again.",
        _PROCESS,
        (
            "other process",
            "another process",
            "socket",
            "stdin",
            "json lines",
            "external policy",
            "other language",
            "c++",
        ),
    ),
    "exports": Guide(
        "formats of recorded runs",
        "`irsim export last -o FILE` picks the format by the suffix, --to names it; `irsim run FILE --export OUT` "
        "needs no record. Tables: csv, npz, parquet. ROS 2: mcap, rosbag2. Learning: minari. Isaac Sim, Blender: usd; "
        "ways of people for Isaac Sim: isaac_people. Gazebo: sdf. MuJoCo: mjcf. CARLA, esmini: openscenario. Planners: "
        "commonroad. Cameras that look where robots go: colmap, nerfstudio, poses. --set KEY=VALUE gives a format its "
        "options, --objects chooses robots, people or names, --force replaces a file. Contents of each format: "
        "references/exports.md of the skill irsim-runner.",
        "irsim run hall.yaml --record && irsim export last --to usd -o hall.usdc",
        ("export", "export formats", "formats", "irsim export", "other programs", "recorded run as a file"),
    ),
    "audit": Guide(
        "checking a recorded run from its files alone",
        "`irsim audit RUN` (id, folder, a file of it, several, --json) reads the record and computes with NumPy and "
        "shapely, without the engine: whether each pose is where the drive takes the object under its control, whether "
        "limits of speed and acceleration were kept, which contacts there were at the ends of steps and within them "
        "(along the constant twist of each step; the bound of the subdivision is printed), who arrived, the outcome, "
        "path length, mean speed and smallest clearance. It says equal, or names object, step, both values and the "
        "tolerance; contacts within 1e-7 m of touching are listed, not decided. The record has what that needs: "
        "outlines as drawn, limits, goals, thresholds, the cells of the map, contacts with their times. A submission "
        "(`irsim benchmark SUITE --submission DIR` writes one to hand in) is checked by `irsim audit DIR`: files, "
        "scenes, rows, tables and records; --replay 60 also runs 60 of its episodes again. More: guides/audit.md of "
        "the skill irsim-benchmark.",
        "irsim run hall.yaml --seed 3 --record && irsim audit last",
        (
            *("submission", "submissions", "submit results", "audit a submission"),
            *("irsim audit", "verify a run", "check a recorded run", "tampered record", "referee", "record-incomplete"),
        ),
    ),
    "imports": Guide(
        "maps and people of other programs as scenarios",
        "`irsim map import FILE -o map.yaml` makes an occupancy grid and a scenario of a mesh (.glb, .gltf, .obj, "
        ".ply, .stl), a navigation mesh of Habitat (.navmesh), a stage of OpenUSD (.usd; it is a format of exports, "
        "too), roads of OpenDRIVE (.xodr), Gaussian splats (.ply) or a map of the ROS map server (.yaml); --level "
        "picks a storey, --add-robot adds a robot, and map.bridge.json beside it leads back to the scene. `irsim "
        "bridge preview` and `irsim bridge page` show a run among splats. `irsim bridge import-pedestrians` makes "
        "scenarios and suites of recorded people (ETH, UCY, TrajNet), `irsim bridge import-bag` of scans and odometry "
        "in a bag of ROS. Pages: bridges/ of the skill irsim-runner.",
        "irsim map import flat.glb -o flat.yaml --add-robot && irsim run flat.yaml",
        (
            *("import", "map import", "mesh", "glb", "obj", "navmesh", "habitat", "hm3d", "usd", "opendrive", "ply"),
            *("splats", "gaussian splats", "ros map", "import-pedestrians", "pedestrian data", "eth", "ucy", "trajnet"),
            *("import-bag", "floor plan", "scan of a building"),
        ),
    ),
    "unknown-cells": Guide(
        "what cells of a map count as that are neither free nor occupied",
        "In a scenario they are free by default (`unknown: free` of the map ros); pictures show them in grey. "
        "`unknown: unknown` keeps them: beams, sight and bodies pass, while planners and random places keep out. "
        "`unknown: occupied` makes them walls. Arrays have -1 for an unknown cell. `irsim map import` writes the key "
        "itself, `occupied` unless --unknown says otherwise; from a map of ROS it keeps them unknown.",
        "world: {obstacle_map: {name: ros, path: map.yaml, unknown: unknown}}",
        ("unknown cells", "unknown cell", "unknown space", "unknown area", "grey cells", "unexplored cells"),
    ),
    "cite": Guide(
        "how to cite irsim, a run and a suite",
        "Cite a benchmark with the line `Cite this run` at the end of its report: it has version, engine, suite, its "
        "hash and the seeds, which are all that is needed to run it again. Of a single run cite the scenario file and "
        "seed (the line `reproduce` has both), the version, and the engine, which run.json of a recorded run has "
        "(--record); publish the file, or the folder of the record, which holds it. Cite the program as CITATION.cff "
        "of the repository says: irsim developers, irsim, its version (`irsim --version`), MIT license. Of a suite or "
        "a policy that others published also cite its sources, which `irsim describe NAME` names.",
        "irsim benchmark crowdnav_circle_v2 --seeds 20 --out results   # results/results.md ends with the line",
        ("citation", "citing", "how to cite", "bibtex", "cite this run"),
    ),
    "interrupted": Guide(
        "Ctrl-C, and how an interrupted command goes on",
        "Ctrl-C ends a command with exit code 130 and one line that names the command to go on with. `irsim benchmark "
        "--resume` goes on with the last benchmark below the current folder, or with the one of -o FOLDER: finished "
        "episodes are kept, and the result equals an undisturbed one. `irsim train --resume -o FOLDER` goes on "
        "after the last finished round; with more --decisions also where a training was finished. A run starts again: "
        "the same file and seed give the same run.",
        "irsim benchmark --resume",
        (
            *("interrupt", "interruption", "ctrl-c", "ctrl+c", "ctrl c", "ctrl", "keyboardinterrupt", "resume"),
            *("--resume", "resume a benchmark", "resume a training", "continue", "go on", "carry on", "abort", "130"),
            *("continue a benchmark", "continue a training", "exit code 130"),
        ),
    ),
    "perturb": Guide(
        "starts that differ a little with each seed",
        "Does it still work when things start slightly differently? An option of `irsim run` and `irsim benchmark` "
        "(--perturb), an argument of run_episode, benchmark, irsim.run and irsim.benchmark; no key of a scenario. "
        "position=0.1: the start is up to 0.1 m off, in x and in y, either way. heading=10deg (or 0.17, in rad): "
        "either way. speed=10%: the limits of forward and sideways speed, and the speeds in the options of behaviors, "
        "either way. delay=2: the object stands still at its start for 0 to 2 s; the clock runs. Each is drawn "
        "uniformly by the seed, for each object on its own. objects=NAME,TAG,ROLE (robot, obstacle) chooses objects; "
        "without it, all that can move. Static objects take part only by name or tag; random starts stay random "
        "starts. A start that overlaps something, leaves the world or lies behind something static is drawn again. "
        "Several, separated by ';': the later one counts where both name an object.",
        "irsim benchmark hall.yaml --seeds 30 --perturb 'position=0.1,heading=10deg; delay=2,objects=pedestrian'",
        (
            *("perturbation", "perturbations", "robust", "robustness", "disturb", "disturbance", "jitter", "vary"),
            *("variation", "slightly different", "sensitivity"),
        ),
    ),
    "units": Guide(
        "metres, seconds, radians; x to the right, y up",
        "Lengths are in m, times in s, speeds in m/s, angles in radians, masses in kg. Heading 0 is +x (east), growing "
        f"counter-clockwise: north 1.5708, west 3.1416, south -1.5708. {UNIT_TABLE}. `irsim describe '12 ft'` (lookup, "
        "topic: 12 ft) converts any of them. The lower left corner of the world is (0, 0) unless world.offset moves "
        "it; objects do not move with it. A larger width or height extends the world at the right and at the top.",
        None,
        ("unit", "conversion", "radians", "radian", "metres", "meters", "coordinates", "angle", "heading"),
    ),
    "avoidance": Guide(
        "what each behavior avoids",
        "dash drives straight and avoids nothing. rvo, orca, footprint_orca, avocado and sfm avoid other objects and "
        "walls (behavior, or group_behavior for all but rvo) and pass single ones, but find no path: see dead-ends. "
        "follow plans a path and follows it with one of these: among walls, use follow with local: {name: orca}, "
        "for cars too. No behavior guarantees success: crowds can jam. Losses, by drive: diff brakes and turns "
        "before it can go sideways; omni loses nothing; acker cannot turn on the spot, so it needs room beside it, a "
        "circle of radius wheelbase / tan(largest steering angle). In dense crowds of robots take footprint_orca, "
        "above all if arrived robots stay where they are (after_arrival: freeze): it knows true outlines, goes round "
        "what stands, and robots that all run it do not touch: with any acce each can always stop. For the others "
        "each moving object counts as the circle around its footprint: a car of 1.8 x 0.9 m as a disc of radius 1.01 m "
        "about the middle of its body. "
        "orca, avocado, rvo and sfm respect speed, turn rate and acce: with acce they brake in time before walls and "
        "each other, whatever their horizons (10 robots, acce: [1, 4], 100 scenes of orca and of avocado: none hit). "
        "With walls, set timeHorizonObst of orca to 1 to 2 s. Robots that have arrived also give way, and return to "
        "their goals.",
        "behavior: {name: follow, local: {name: orca}}",
        (
            *("avoid", "avoid each other", "obstacle avoidance", "collision avoidance", "avoiding"),
            *("acker orca", "car orca", "orca car", "orca acker", "limits of orca"),
        ),
    ),
    "keep-out": Guide(
        "an area that a robot stays out of",
        "Name the area in world.zones, and the zone under `avoid` of follow: the zone is then solid for this robot "
        "alone, and the run says who else entered it. For people who must keep their distance, make the circle larger. "
        "Without `avoid` a zone is not an obstacle. `within` of follow is the opposite: the area of the path. "
        "Random objects keep clear of a point or an object with `keep_clear` of the distribution random.",
        "world: {zones: [{name: talk, circle: {center: [6, 6], radius: 1.2}}]}\n"
        "robot: {state: [6, 1, 1.57], goal: [6, 11], behavior: {name: follow, local: {name: orca}, avoid: [talk]}}",
        ("keep out", "keep away", "forbidden", "forbidden area", "no-go", "no-go area", "avoid area", "personal space"),
    ),
    "exploration": Guide(
        "driving through a world that is not known",
        "fog_map: true covers the world with fog that sensors clear. Robots do not look for frontiers on their own: "
        "give them waypoints, or leave out behavior and drive them by a program. Behaviors that plan use the whole "
        "map, fog or not. Template: fog-exploration.",
        "world: {width: 20, height: 15, fog_map: true, fog_map_resolution: 0.25}",
        ("explore", "explored", "frontier", "frontiers", "frontier exploration", "unknown map", "coverage"),
    ),
    "standing-group": Guide(
        "people who stand together and talk",
        "An obstacle entry with number and the distribution circle, without behavior: its objects stand on a circle "
        "and face its middle. Name the area that they take in world.zones to see who walks through it; a robot with "
        "behavior follow goes around it if its `avoid` names it. Template: talking-group.",
        "world: {zones: [{name: talk, circle: {center: [6, 6], radius: 1.2}}]}\n"
        "obstacle:\n  - {number: 3, tags: [pedestrian], kinematics: {name: static}, shape: {name: circle, "
        "radius: 0.25},\n     distribution: {name: circle, center: [6, 6], radius: 0.7}}",
        ("conversation", "talking", "standing group", "group of people", "people talking", "standing people"),
    ),
    "dead-ends": Guide(
        "traps, and the behavior that gets out of them",
        "dash, rvo, orca, avocado and sfm head for the goal and consider only what is near: in a concave "
        "obstacle (a U, a corner, a room whose door is not straight ahead) they stay caught. Single walls they "
        "pass. In such a local minimum "
        "rvo, orca, avocado and sfm usually time out; dash drives into the obstacle, which is a collision "
        "(collision_mode stop), not a time-out. follow finds a path around it: it plans on the whole map, including "
        "what no sensor has seen. To test your own exploring behavior, leave out the key behavior and drive by a "
        "program. A car that circles its goal is another case: a goal inside its turning circle, of radius wheelbase / "
        "tan(largest steering angle), cannot be reached; raise goal_threshold. Template: u-trap.",
        "behavior: {name: follow}",
        (
            *("dead end", "dead-end", "trap", "traps", "trapped", "u-trap", "local minimum", "local minima", "u-shape"),
            *("u shape", "u-shaped", "concave", "cul-de-sac", "stuck", "caught", "turning circle", "circling"),
        ),
    ),
    "limits": Guide(
        "what cannot be simulated",
        "The world is flat and seen from above: no heights, altitude, flying, stairs, ramps, slopes, bridges, falling. "
        "A robot can represent only a drone that keeps its height: omni or omni_angular, and nothing passes over or "
        "under it. (unobstructed on shelves lets it through, but then nothing is tested; on the drone it does not "
        "help.) A side view with y as height is a drawing, not a flight: label it as such. Objects "
        "can appear at a time (appear_time: 5) or stand at their start until then (start_time: 5, for all to see); "
        "nothing vanishes or is made during a run. perturb delays starts by chance. A drive that answers its commands "
        "late is actuation: {delay: 0.1, lag: 0.2}. Doors and walls that open at a time or on a signal do not exist; "
        "an object that slides back and forth is an obstacle with kinematics omni and behavior {name: dash, loop: "
        "true}. Floors are slippery where world.zones say so (see floor). No weather, speed zones, traffic "
        "lights, right of way, priorities, batteries, radio messages, pictures of cameras or arms; sensors are planar "
        "lidars and depth scans, sonar, ir_range, bumper, cliff, uwb, odometry, imu, gnss, localization and detectors. "
        "gravity, friction and mass of objects only affect pushing (collision_mode contact). Say what is not possible, "
        "and offer the closest alternative, labelled as such. (Speed limits are vel_min, vel_max and acce.)",
        None,
        (
            *("limitations", "not possible", "impossible", "unsupported", "not simulated", "3d", "z", "altitude"),
            *("elevation", "ceiling", "bridge", "jump", "climb"),
            *("delay", "delayed", "start_time", "start time", "stagger", "staggered", "spawn", "appear", "disappear"),
            *("schedule", "timer", "weather", "rain", "wind", "snow", "traffic light"),
            *("traffic lights", "priority", "right of way", "battery", "underwater"),
            *("ampel", "semáforo", "红绿灯"),
            *("boat", "ship", "submarine", "3 d", "three dimensions", "third dimension"),
        ),
    ),
    "things": Guide(
        "how everyday things are written",
        "post, pillar, column, tree, cone: obstacle with shape circle. box, crate, table, shelf, rack, parked car: "
        "rectangle. wall: rectangle, or linestring with state [0, 0, 0]; room: closed linestring. standing person: "
        "obstacle with a circle of 0.2 to 0.3 m and tags: [pedestrian]; walking person: also kinematics and behavior "
        "{name: orca, safe_radius: 0.1} (sfm looks more like people, who then touch now and then, whatever its "
        "safety_radius: with world.collision_mode unobstructed_obstacles they walk on instead of stopping for good). "
        "crowd: number 20 or more of them, about 0.3 persons per m2. "
        "start and goal of a robot: its keys state, goal.",
        "obstacle:\n  - number: 2\n    shape: {name: circle, radius: 0.25}\n    state: [[3, 3, 0], [4, 5, 0]]\n"
        "    tags: [pedestrian]",
        (
            *("post", "pillar", "column", "tree", "box", "crate", "table", "shelf", "rack", "wall", "room"),
            *("people", "pedestrian", "human", "crowd", "crowded"),
        ),
    ),
    "pictures": Guide(
        "what a picture can show besides bodies",
        "The option --overlays of `irsim render`, and the argument overlays of render_snapshot and irsim.api.snapshot; "
        "no keys of a scenario. overlays: [plan] draws the path of each robot to its goals, or `no path`, and the text "
        "says where it comes nearest to something and by how much: it shows whether a path exists. [clearance] shades "
        "where the middle of a robot cannot be, so what is white is free space for a start or a goal. names, goals, "
        "paths (where it has driven), sensors and zones switch what is drawn anyway. If no path exists, the finding "
        "goal-unreachable of `irsim validate` and validate_scenario gives the narrowest gap and a goal that can be "
        "reached.",
        "irsim render map.yaml --overlays plan,clearance -o map.png",
        ("overlay", "overlays", "picture", "snapshot", "clearance map", "planned path"),
    ),
    "outcomes": Guide(
        "success, collision, timeout",
        "A run ends when every robot has arrived or been stopped by a collision, or at its time limit: the number of "
        "steps given, else world.time_limit, else the longest time that a robot needs for the straight lines between "
        "its goals at top speed, times 4, and at least 30 s. success: every robot arrived without a collision; "
        "collision: a robot was stopped by a collision, or arrived after one; timeout: any other end (where "
        "collision_mode lets robots drive on, contacts are only counted). Contacts are reported when they begin, and "
        "judged at the ends of steps: two objects that touch within a step and are apart at both ends have an event "
        "contact_between_steps, or passed_through. The summary, and after a failure the reason, begins with the first "
        "of a robot; world.contacts: swept makes them collisions. The summary also counts contacts between people, "
        "or between other moving obstacles, objects that left the world, or jumped over their goal: passed it within "
        "goal_threshold between two steps (event overshoot) and never arrived. In a benchmark, a seed "
        "without room for an object is placement-crowded and counts in no rate. "
        "Object names are numbered through, robots first: obstacle_3 in a file with one robot is the third obstacle; "
        "pictures shorten it to o3.",
        None,
        (
            *("outcome", "success", "timeout", "time limit", "default time limit", "horizon"),
            *("contact between steps", "passed through", "tunnel"),
        ),
    ),
}
