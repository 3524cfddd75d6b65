"""Things that users name and the language does not: what each is in a scenario, or what takes its place."""

from __future__ import annotations

from irsim.lookup.guides import GUIDES, Guide
from irsim.lookup.python_guides import PYTHON

__all__ = ["ALL_GUIDES", "NO", "THINGS"]

NO = "irsim has no"
"""How the text of a thing begins that is not simulated."""

THINGS: dict[str, Guide] = {
    "agv": Guide(
        "a transport robot, diff or omni, a rectangle, 1 to 2 m/s",
        "An AGV or AMR turns on the spot (kinematics diff; omni with mecanum wheels), is a rectangle of about 1.0 x "
        "0.6 m and drives 1 to 2 m/s. Along lanes: waypoints with dash; around racks and other robots: behavior follow "
        "with local: {name: orca}. Templates: warehouse, mixed-fleet. Loads, orders and batteries do not exist.",
        "robot:\n  - name: agv\n    kinematics: {name: diff}\n    shape: {name: rectangle, length: 1.0, width: 0.6}\n"
        "    state: [1, 1, 0]\n    goal: [9, 6]\n    vel_max: [1.5, 1.5]\n"
        "    behavior: {name: follow, local: {name: orca}}",
        (
            *("amr", "automated guided vehicle", "autonomous mobile robot", "transport robot"),
            *("delivery robot", "logistics robot", "service robot", "fts", "fahrerloses transportsystem"),
            *("transportroboter", "lieferroboter", "robot de reparto", "vehículo guiado", "搬运机器人", "送货机器人"),
        ),
    ),
    "forklift": Guide(
        "kinematics tricycle and a rectangle; it lifts nothing",
        "Take kinematics tricycle with a rectangle of about 2.4 x 1.2 m, wheelbase 1.5 m and 2 to 3 m/s; a pallet "
        "jack: 1.8 x 0.7 m, walking pace. It drives away from its forks, whose axle is the fixed one. "
        f"{NO} forks or loads: a pallet is an obstacle with shape rectangle (1.2 x 0.8 m), and it stays where it is. "
        "Pushing: world.collision_mode: contact. Template: warehouse.",
        "robot: {kinematics: {name: tricycle, steer_rate: 1.5}, state: [2, 2, 0], goal: [14, 8],\n"
        "        shape: {name: rectangle, length: 2.4, width: 1.2, wheelbase: 1.5},\n"
        "        vel_max: [2, 1.57], vel_min: [-2, -1.57], behavior: {name: follow}}",
        (
            *("fork lift", "forklift truck", "pallet jack", "pallet truck", "pallet"),
            *("reach truck", "stacker", "gabelstapler", "stapler", "hubwagen", "palette", "carretilla elevadora"),
            *("montacargas", "transpaleta", "palé", "叉车", "托盘"),
        ),
    ),
    "tug": Guide(
        "kinematics acker, without trailers",
        f"{NO} couplings: a trailer does not follow its tractor. Take kinematics acker for the tractor alone, or one "
        "long rectangle that covers both and turns wider than the real thing; several vehicles one behind the other "
        "are robots with the same waypoints and start_time in turn. Say so in the report.",
        "robot: {kinematics: {name: acker}, shape: {name: rectangle, length: 1.8, width: 1.0, wheelbase: 1.2}}",
        (
            *("tugger", "tow truck", "tractor", "trailer", "towing", "tow", "tugger train", "convoy", "platoon"),
            *("schlepper", "schleppzug", "anhänger", "traktor", "remolque", "remolcador", "拖车", "牵引车"),
        ),
    ),
    "cart": Guide(
        "a rectangle, which stands or is pushed",
        "Standing: an obstacle with shape rectangle, about 1.0 x 0.6 m. Pushed by a person: one obstacle with "
        "kinematics diff and a shape compound (cart and person), tags: [pedestrian], 1.0 m/s. Pushed by a robot: "
        "world.collision_mode: contact with mass, friction and drag on both.",
        "obstacle: {kinematics: {name: diff}, shape: {name: rectangle, length: 1.4, width: 0.6}, tags: [pedestrian],\n"
        "           state: [2, 2, 0], goal: [8, 2], vel_max: [1.0, 1.0], behavior: {name: orca}}",
        (
            *("trolley", "shopping cart", "hand cart", "handcart", "luggage cart", "stroller", "pram", "pushchair"),
            *("hospital bed", "bed", "gurney", "einkaufswagen", "karren", "wagen", "kinderwagen", "carro", "carrito"),
            *("手推车", "购物车", "推车"),
        ),
    ),
    "wheelchair": Guide(
        "kinematics diff and a rectangle, at walking pace",
        "Take kinematics diff with a rectangle of about 1.1 x 0.65 m and 1 to 1.7 m/s, as a robot if it is tested, as "
        "an obstacle with tags: [pedestrian] if it is one of the people. Its door must be 0.8 m wide or more.",
        "obstacle: {kinematics: {name: diff}, shape: {name: rectangle, length: 1.1, width: 0.65}, tags: [pedestrian],\n"
        "           state: [2, 2, 0], goal: [8, 2], vel_max: [1.2, 1.5], behavior: {name: orca}}",
        (
            *("wheel chair", "powered wheelchair", "mobility scooter", "rollstuhl"),
            *("silla de ruedas", "轮椅"),
        ),
    ),
    "vacuum": Guide(
        "kinematics diff and a disc of radius 0.17 m, 0.3 m/s",
        "It drives at random with behavior dash and wander: true (targets within range_low to range_high), or along "
        "waypoints in rows. Nothing is cleaned; world.fog_map with a short lidar measures the share of the floor that "
        "it has seen. Its sensors are bumper and cliff; with collision_mode stop the first touch ends its run.",
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.17}, state: [2, 2, 0],\n"
        "        vel_max: [0.3, 1.5], behavior: {name: dash, wander: true}}",
        (
            *("roomba", "vacuum cleaner", "robot vacuum", "vacuum robot", "cleaning robot", "cleaner", "lawn mower"),
            *("lawnmower", "mower", "saugroboter", "staubsauger", "putzroboter", "mähroboter", "aspiradora"),
            *("robot aspirador", "cortacésped", "扫地机器人", "吸尘器"),
        ),
    ),
    "shuttle": Guide(
        "a vehicle that goes back and forth, or a bus",
        "Back and forth between two places: waypoints with behavior {name: dash, loop: true}; among others the same "
        "keys of orca or follow. As a bus: kinematics acker, a rectangle of 5 x 2 m, behavior follow. "
        f"{NO} stops of a given length: split the ride into runs, or use start_time for the first one.",
        "behavior: {name: dash, loop: true}",
        ("shuttle bus", "people mover", "ferry", "pendelbus", "lanzadera", "摆渡车", "班车"),
    ),
    "legged": Guide(
        "omni_angular with the outline of the body; no legs",
        f"{NO} legs, gaits or balance. Seen from above a quadruped is kinematics omni_angular (it steps sideways and "
        "turns on the spot) with a rectangle of about 1.1 x 0.5 m and up to 1.6 m/s; a humanoid is a circle of radius "
        "0.3 m, up to 1.2 m/s. Steps, slopes and rough ground are not simulated: say so.",
        "robot: {kinematics: {name: omni_angular}, shape: {name: rectangle, length: 1.1, width: 0.5},\n"
        "        state: [2, 2, 0], goal: [8, 5], vel_max: [1.6, 0.8, 1.5]}",
        (
            *("quadruped", "legged robot", "robot dog", "anymal", "unitree", "hexapod", "biped"),
            *("humanoid", "humanoid robot", "walking robot", "leg", "laufroboter", "vierbeiner"),
            *("roboterhund", "humanoider roboter", "cuadrúpedo", "perro robot", "humanoide", "四足机器人", "机器狗"),
            *("人形机器人",),
        ),
    ),
    "drone": Guide(
        "only one that keeps its height",
        f"{NO} heights: nothing passes over or under another thing. A drone that keeps its height is kinematics omni "
        "(omni_angular if its heading matters) with a circle of about 0.25 m radius and 2 to 5 m/s. Take-off, landing "
        "and flying over shelves cannot be shown: say so, then offer this. More: limits.",
        "robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 2], goal: [8, 5],\n"
        "        vel_max: [3, 3], behavior: {name: orca}}",
        (
            *("uav", "quadcopter", "quadrotor", "multicopter", "aerial", "helicopter", "fly"),
            *("flying", "flight", "drohne", "drohnen", "fliegen", "dron", "volar", "无人机", "飞行"),
        ),
    ),
    "arm": Guide(
        "no arms and grippers; the base alone",
        f"{NO} joints, arms, grippers, picking or placing. The base of a mobile manipulator can drive to the place "
        "where it would reach (arrive_mode: state for its heading); an arm that stands out is a part of its shape "
        "compound and does not move by itself. Pushing exists: world.collision_mode: contact. Arms need another "
        "simulator (irsim export writes mjcf, usd and sdf).",
        None,
        (
            *("robot arm", "robotic arm", "manipulator", "mobile manipulator", "gripper", "grasp", "grasping"),
            *("pick", "pick up", "pick and place", "joint", "roboterarm", "greifer", "greifen", "brazo"),
            *("brazo robótico", "pinza", "机械臂", "抓取"),
        ),
    ),
    "camera": Guide(
        "no images; a depth camera as a scan, or a field of view",
        f"{NO} cameras and images. Nearest: depth_scan is one row of a depth camera with its noise, and fov of an "
        "object says whom it sees, with fov_occlusion: true not through walls. For pictures from the robot, irsim "
        "bridge preview renders a recorded run among splats, and irsim export --to colmap writes its camera poses.",
        "robot: {fov: 1.5, fov_radius: 5, fov_occlusion: true, sensors: [{name: depth_scan, device: d435}]}",
        (
            *("rgb camera", "webcam", "image", "vision"),
            *("object detection", "point cloud", "kamera", "cámara", "相机", "摄像头"),
        ),
    ),
    "compass": Guide(
        "no compass and no barometer; the heading is known, or estimated",
        f"{NO} compass, magnetometer or barometer. Nearest: localization reports a heading with errors, imu a yaw "
        "rate, odometry the heading that wheels add up to; robot.state has the true one.",
        "robot: {sensors: [{name: localization}, {name: imu, device: adis16448}]}",
        ("magnetometer", "barometer", "altimeter", "kompass", "brújula"),
    ),
    "elevator": Guide(
        "there is one flat floor",
        f"{NO} floors above one another and no doors that open. Show the part on one floor: the cabin is a small room "
        "(a linestring with a gap of 0.9 to 1.1 m as its door), people come out by start_time, and the robot has its "
        "goal in the cabin; or one file for each floor. Waiting before the ride: start_time of the robot.",
        "obstacle: {shape: {name: linestring, vertices: [[0, 0], [0, 2], [2, 2], [2, 0], [1.5, 0]]}, state: [6, 4, 0]}",
        (
            *("lift", "escalator", "storey", "aufzug", "fahrstuhl", "rolltreppe", "stockwerk"),
            *("ascensor", "elevador", "escalera mecánica", "电梯", "扶梯"),
        ),
    ),
    "stairs": Guide(
        "no stairs, ramps or slopes, as the world is flat",
        f"{NO} heights. A place that a robot must keep off is an obstacle, or a zone that the behavior follow avoids "
        "(see keep-out); a ramp that it may use is a corridor like any other, and a lower vel_max holds for the whole "
        "run. Refuse what depends on the climb, with this reason. More: limits.",
        "world: {zones: [{name: stairs, rectangle: [4, 2, 6, 4]}]}\n"
        "robot: {state: [1, 3, 0], goal: [9, 3], behavior: {name: follow, avoid: [stairs]}}",
        (
            *("stairway", "staircase", "ramp", "slope", "curb", "kerb", "hill"),
            *("terrain", "uneven", "treppe", "treppen", "rampe", "stufe", "bordstein", "escalera"),
            *("rampa", "escalón", "楼梯", "台阶", "坡道", "斜坡"),
        ),
    ),
    "floor": Guide(
        "areas on which wheels slip: slip, grip and surface of world.zones",
        "slip: 0.2 takes a fifth of the way of each wheel that is on the area, so a robot with one wheel on it turns; "
        "slip_std lets it wander. grip: 0.1 (ice) acts on drives with forces, single_track and diff_dynamic; surface: "
        "gravel on skid_steer. Wheel odometry then reports more than the way. plot: {show_zones: true} draws the area. "
        "Behaviors and planners do not know of it, nothing is slower there by itself, and heights, bumps and sinking "
        "in are not simulated.",
        "world: {zones: [{name: wet, rectangle: [4, 2, 6, 4], slip: 0.2, slip_std: 0.05}]}\n"
        "robot: {state: [1, 3, 0], goal: [9, 3], behavior: {name: dash}, sensors: [{name: odometry}]}",
        (
            *("carpet", "rug", "tile", "grass", "mud", "sand", "gravel", "slippery", "ice", "wet floor"),
            *("surface", "ground", "teppich", "boden", "rutschig", "alfombra", "suelo", "resbaladizo", "地毯", "地面"),
        ),
    ),
    "person": Guide(
        "an obstacle with tags: [pedestrian]; sizes and speeds by age",
        "A grown-up is a circle of radius 0.2 to 0.3 m and walks 1.3 m/s; a child: 0.15 m, 0.9 m/s (running 2); an "
        "elderly person: 0.25 m, 0.8 m/s; a jogger: 2.5 m/s. Walking: kinematics and a behavior, such as "
        "{name: orca, safe_radius: 0.1}, or sfm with world.collision_mode: unobstructed_obstacles; strolling: "
        "{name: dash, wander: true}; standing: neither kinematics nor behavior. Crowds: number 20 or more, about 0.3 "
        "persons per m2. See also standing-group.",
        "obstacle:\n  - name: child\n    kinematics: {name: omni}\n    shape: {name: circle, radius: 0.15}\n"
        "    tags: [pedestrian]\n    state: [2, 2, 0]\n    goal: [8, 5]\n    vel_max: [0.9, 0.9]\n"
        "    behavior: {name: orca, safe_radius: 0.1}",
        (
            *("kid", "child", "children", "toddler", "baby", "elderly", "old man", "old woman"),
            *("man", "woman", "worker", "staff", "nurse", "patient", "visitor", "customer", "passer-by", "jogger"),
            *("runner", "adult", "fußgänger", "passant", "mensch", "menschen", "leute", "personen", "kinder"),
            *("menge", "menschenmenge", "peatón", "peatones", "persona", "gente", "niño", "niña"),
            *("multitud", "行人", "人", "人群", "路人", "儿童", "孩子", "小孩", "老人"),
        ),
    ),
    "animal": Guide(
        "a small moving obstacle",
        "An obstacle with kinematics omni, a circle of about 0.2 m radius, 1 to 3 m/s and behavior {name: dash, "
        "wander: true}, or sfm; without tags: [pedestrian], so that it does not count as a person.",
        "obstacle: {name: dog, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 2],\n"
        "           vel_max: [2, 2], behavior: {name: dash, wander: true}}",
        ("dog", "cat", "pet", "hund", "katze", "tier", "perro", "gato", "狗", "猫"),
    ),
    "endless": Guide(
        "a run always ends",
        "Going on for ever is behavior {name: dash, loop: true} (waypoints, back to the first) or wander: true; the "
        "run ends at world.time_limit, which you set to the time that shall be seen. A program may call env.step as "
        "long as it likes.",
        "world: {time_limit: 120}\nrobot: {waypoints: [[2, 2], [8, 2]], behavior: {name: dash, loop: true}}",
        (
            *(
                "for ever",
                "forever",
                "endlessly",
                "indefinitely",
                "infinite",
                "infinitely",
                "never stops",
                "never ends",
            ),
            *("keeps going", "non-stop", "nonstop", "endlos", "unendlich", "para siempre", "sin fin", "永远", "无限"),
        ),
    ),
    "waiting": Guide(
        "waiting goes by the clock",
        "A body that sets off later has start_time. On the way, behavior replay stands still between two equal poses, "
        "at fixed times; orca and footprint_orca let others pass by themselves. A robot that has arrived stays there, "
        "and the run ends when all robots have arrived, unless it is run until time_limit.",
        "obstacle: {name: pedestrian, kinematics: {name: omni}, shape: {name: circle, radius: 0.25},\n"
        "           state: [5, 1, 1.5708], behavior: {name: replay, times: [0, 2, 5, 8],\n"
        "           poses: [[5, 1], [5, 3], [5, 3], [5, 6]]}}  # with vanish: false also after 8 s",
        (
            *("wait", "pause", "dwell", "stands still", "stay put", "warten", "wartet", "pausieren"),
            *("esperar", "espera", "pausa", "等待", "等一下", "停留", "暂停", "站住"),
        ),
    ),
    "encounter": Guide(
        "who gives way to whom",
        "Avoidance laws know who is near, also behind a wall. "
        "Sharing: orca for all, sidestep 10 (right; -10 left) for who meets head-on. People make way, the robot does "
        "not: robot dash, people orca with timeHorizon 4 and sidestep 10, started a little off its line. The robot "
        "makes way for people who do not care: robot orca, people dash. No avoidance: dash for all. A first, then B: "
        "B has start_time = A's way / speed + 1 s and starts beside A's way; a robot that must see by itself when the "
        "way is free needs a program. Overtake: template overtaking. Surround, gather: dash to goals on a ring, "
        "start_time so that the last ones close it. Walk beside or behind a person: the same speed and way, moved by "
        "the offset; the robot does not see whether the person stops.",
        "obstacle: {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [9, 2.2],\n"
        "           goal: [1, 2], behavior: {name: orca, timeHorizon: 4, sidestep: 10}}",
        (
            *("give way", "make way", "step aside", "let pass", "let through", "goes first", "priority"),
            *("right of way", "surround", "gather", "crowd around", "walk beside", "escort", "ausweichen"),
            *("platz machen", "vorrang", "vorfahrt", "umringen", "ceder el paso", "dejar pasar", "rodear"),
            *("让路", "让行", "先走", "围住", "围观", "并排走"),
        ),
    ),
    "conveyor": Guide(
        "no conveyors, doors that open, cranes or turntables",
        f"{NO} machines that move other things or switch. A thing that moves by itself is an obstacle with kinematics "
        "omni and a route (waypoints, dash); a door that slides to and fro has loop: true and knows no signal; a door "
        "that is open is a gap.",
        "obstacle: {name: sliding_door, kinematics: {name: omni}, shape: {name: rectangle, length: 1, width: 0.1},\n"
        "           state: [5, 3, 0], waypoints: [[6, 3], [5, 3]], vel_max: [0.5, 0.5],\n"
        "           behavior: {name: dash, loop: true}}",
        (
            *("conveyor belt", "automatic door", "sliding door", "revolving door", "swing door", "turnstile", "crane"),
            *("förderband", "schiebetür", "drehtür", "kran", "cinta transportadora", "puerta automática", "传送带"),
            *("自动门",),
        ),
    ),
    "dock": Guide(
        "a goal with a heading; no batteries",
        "The place is the robot's goal with arrive_mode: state (its heading counts) and a small goal_threshold; the "
        "housing of the station is a rectangle behind it, at least half a robot's length away from the goal. "
        f"{NO} batteries and no rest at a place.",
        "robot: {state: [2, 2, 0], goal: [8, 5, 1.5708], arrive_mode: state, goal_threshold: 0.05, "
        "kinematics: {name: diff}}",
        (
            *("docking", "docking station", "charger", "charging", "charging station", "charge", "ladestation"),
            *("laden", "estación de carga", "cargar", "充电", "充电桩", "充电站"),
        ),
    ),
}
"""Name -> what to write, an example, and the names that users have for it in English, German, Spanish and Chinese."""

ALL_GUIDES = GUIDES | PYTHON | THINGS
"""The guides, with those about things."""
