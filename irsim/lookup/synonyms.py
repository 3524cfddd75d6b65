"""Everyday words for the parts of the language, and the topics that they stand for."""

from __future__ import annotations

from irsim.lookup.full_text import STOP_WORDS, words_of
from irsim.lookup.units import UNIT_WORDS

__all__ = ["EVERYDAY", "named"]

EVERYDAY: dict[str, str] = {
    "units": UNIT_WORDS,
    "bridges": "real robot, real hardware, other program, other simulator, co-simulation, external simulator, socket",
    "bridges.ros2": "ros, rviz, turtlebot hardware, dds, zenoh, nav2",
    "bridges.rosbridge": "ros, rosbridge, websocket, real robot",
    "bridges.ros1": "ros, ros 1, noetic, rospy",
    "bridges.mujoco": "physics, wheel slip, co-simulation, inertia of wheels",
    "bridges.carla": "town, autonomous driving simulator, unreal",
    "robot.behavior.replay": "replay, recorded pedestrians, recorded trajectory, trajectory file, csv, eth ucy, "
    "data set of people",
    "robot.sensors.sonar": "sonar, ultrasonic, ultrasound, ultrasonic sensor, hc-sr04, hcsr04, echo, parking sensor, "
    "ultraschall, ultrasonido, 超声波",
    "robot.sensors.ir_range": "infrared, ir sensor, infrared sensor, time of flight, tof, gp2y0a21, vl53l0x, "
    "infrarot, infrarrojo, 红外",
    "robot.sensors.odometry": "odometry, odometer, wheel encoder, encoder, wheel odometry, dead reckoning, odom, "
    "drift, odometrie, odometría, 里程计",
    "robot.sensors.imu": "imu, accelerometer, gyroscope, gyro, inertial sensor, inertial measurement unit, "
    "beschleunigungssensor, acelerómetro, 惯性",
    "robot.sensors.detector": "detector, people detector, person detector, leg detector, tracker, tracking, tracks, "
    "perception, missed detections, false positives, occlusion, detektor, personenerkennung, 行人检测",
    "robot.perceives": "perceives, belief, believed pose, estimated pose, localization error, perception, "
    "ground truth, partial observability, noisy state",
    "robot.sensors.gnss": "gnss, gps, satellite navigation, satellite, rtk, galileo, glonass",
    "robot.sensors.localization": "localization, localisation, slam, amcl, pose estimate, estimated pose, "
    "map frame, 定位",
    "robot.sensors.lidar2d": "lidar, lidar sensor, laser, laser scanner, scanner, lidar scanner, "
    "range finder, rangefinder, ladar, "
    "720, 720 beams, 1080 beams, 360 beams, distance sensor, proximity sensor, beam, sensor range"
    ", laserscanner, abstandssensor, láser, escáner láser, 激光雷达, 激光",
    "robot.sensors.fmcw_lidar2d": "lidar, fmcw, fmcw lidar, doppler, radar, velocity lidar, radial velocity",
    "robot.sensors.bumper": "bumper, bump sensor, touch sensor, collision sensor, stoßstange, parachoques, 碰撞传感器",
    "robot.sensors.cliff": "cliff, cliff sensor, drop sensor, edge detection, floor sensor, absturzsensor, 悬崖",
    "robot.sensors.depth_scan": "depth camera, rgbd, realsense, kinect, d435, stereo camera, depth image, "
    "tiefenkamera, 深度相机",
    "robot.sensors.uwb": "uwb, ultra-wideband, beacon, anchors, radio ranging, dw1000, "
    "trilateration, indoor positioning, funkbake, 超宽带",
    "robot.sensors.contact2d": "contact sensor, contact forces, tactile, force sensor",
    "robot.sensors": "sensor",
    "robot.sensors.fmcw_lidar2d.motion_compensate": "ego motion, own motion",
    "robot.sensors.lidar2d.rate": "scan rate, sensor rate, update rate, sampling rate, scans per second",
    "robot.sensors.lidar2d.latency": "sensor delay, sensor latency, old data, late data, late scans",
    "robot.sensors.lidar2d.noise": "lidar noise, laser noise, sensor noise, measurement noise, noise",
    "robot.kinematics.diff.noise": "motion noise, actuator noise, odometry noise, noise",
    "robot.fov": "field of view, view angle, visual range, sees, seen, visible, visibility, surveillance, guard, "
    "vision cone, view cone, sight cone, cone of vision, cone, line of sight, watch, sight",
    "robot.kinematics.acker": "car, ackermann, ackerman, car-like, bicycle, bicycle model, vehicle, truck, bus, "
    "steering, lorry"
    ", auto, lkw, fahrzeug, coche, camión, 汽车, 卡车, 车辆",
    "robot.kinematics.tricycle": "three wheels, three-wheeler, forklift, pallet truck, steered drive wheel, dreirad, "
    "front wheel drive, triciclo",
    "robot.kinematics.diff": "differential, differential drive, diff drive, unicycle, turtlebot, two wheels",
    "robot.kinematics.diff_dynamic": "motors, torque, mass, inertia, heavy, voltage, wheel torque, dynamics, "
    "träge, inercia",
    "robot.kinematics.single_track": "race car, racing car, racecar, f1tenth, f1/10, commonroad, drift, understeer, "
    "tyres, tires, tyre slip, vehicle dynamics, car dynamics, rennwagen, coche de carreras",
    "robot.kinematics.skid_steer": "skid steer, tank, tracks, tracked, crawler, caterpillar, four-wheeled, "
    "jackal, husky, pioneer, slip, slippery, raupe, kettenfahrzeug, oruga",
    "robot.kinematics.omni": "omnidirectional, holonomic, mecanum, omni wheels, omniwheel, swerve, point mass",
    "robot.kinematics.omni_angular": "omnidirectional, holonomic, mecanum, turn in place",
    "robot.kinematics.static": "static obstacle, fixed, immovable",
    "robot.kinematics": "drive, motion model, drive model, kinematic model, dynamics, locomotion, mobile base",
    "robot.behavior.sfm": "social force, social force model, pedestrian, human, crowd, people, walker",
    "robot.behavior.orca": "evade, dodge, swerve around, get out of the way, "
    "reciprocal collision avoidance, optimal reciprocal collision avoidance, pedestrian, "
    "collision avoidance, obstacle avoidance",
    "robot.behavior.avocado": "adaptive collision avoidance, opinion, opinion dynamics, cooperation, cooperative, "
    "non-cooperative, uncooperative, unknown behavior, collision avoidance",
    "robot.behavior.footprint_orca": "dense crowd, deadlock, jam, blocked goal, arrived robots in the way, polygons, "
    "true footprint, exact outline, buffered voronoi cells, multi-robot, collision avoidance",
    "robot.behavior.rvo": "velocity obstacle, reciprocal velocity obstacle, vo, hrvo, collision avoidance",
    "robot.behavior.dash": "straight line, drive straight, go straight, go to goal, point to point",
    "robot.behavior.dash.wander": "wander, random walk, roam, wandering, random goals",
    "robot.behavior.dash.loop": "loop, patrol, patrolling, back and forth, shuttle, to and fro, guard"
    ", hin und her, de ida y vuelta, ida y vuelta, patrullar, 巡逻, 来回",
    "robot.behavior.follow": "path following, follow path, navigate, path planning, route, plan, pure pursuit, "
    "global planner",
    "robot.behavior": "behavior, behaviour, controller, policy, local planner, navigation",
    "robot.group_behavior": "swarm, flocking, flock, group behavior, formation",
    "robot.behavior.follow.planner": "planner, path planning, global planner, route, shortest path, search algorithm",
    "robot.behavior.follow.planner.astar": "a star, dijkstra, grid search, shortest path",
    "robot.behavior.follow.planner.rrt": "rapidly exploring, random tree, sampling planner",
    "robot.behavior.follow.planner.rrt_star": "rrt star",
    "robot.behavior.follow.planner.informed_rrt_star": "informed rrt star",
    "robot.behavior.follow.planner.jps": "jump point search",
    "robot.behavior.follow.planner.prm": "probabilistic roadmap, roadmap",
    "robot.shape": "shape, footprint, geometry, body, robot size, obstacle size, size",
    "robot.shape.circle": "disc, disk, round, cylinder, post, pillar, robot size, säule, columna, 柱子",
    "robot.shape.rectangle": "box, square, crate, table, shelf, oblong, wall"
    ", kiste, regal, tisch, caja, mesa, estante, 箱子, 货架, 桌子",
    "robot.shape.polygon": "triangle, hexagon, polyhedron, irregular, vertex, vertices",
    "robot.shape.linestring": "line, wall, fence, segment, polyline, barrier, courtyard, yard, room, bend, l-bend, "
    "corner"
    ", wand, mauer, zimmer, pared, muro, habitación, sala, 墙, 房间",
    "robot.shape.compound": "l-shape, l-shaped, t-shape, several parts, composite",
    "robot.shape.circle.radius": "radius, diameter",
    "robot.state": "start, start position, initial position, initial pose, start pose, pose, spawn, position, "
    "orientation"
    ", startposition, salida, inicio, 起点",
    "robot.goal": "goal, destination, target, target position, end position, go to goal"
    ", ziel, meta, objetivo, destino, 目标, 终点",
    "robot.waypoints": "waypoint, via point, checkpoint, route, several goals, multiple goals",
    "robot.goal_threshold": "goal tolerance, arrival tolerance, goal radius, arrive",
    "robot.arrive_mode": "goal angle threshold, goal heading, goal angle, goal yaw, final heading, heading tolerance, "
    "heading threshold, yaw tolerance, arrival heading",
    "robot.number": "number of robots, how many robots, number of obstacles, count, fleet size",
    "robot.vel_max": "sprint, run fast, hurry, turn rate, "
    "speed limit, max speed, maximum speed, top speed, velocity limit, speed, fast, slow, velocity"
    ", geschwindigkeit, velocidad, 速度",
    "robot.acce": "acceleration, acceleration limit, braking, brake, braking distance, stopping distance, deceleration",
    "robot.actuation": "actuator, motor, latency, lag, command delay, control delay, input delay, reaction time, "
    "response time, sluggish, slow to react, time constant, hardware effects",
    "robot.actuation.delay": "dead time, transport delay, latency, command delay, control latency",
    "robot.actuation.lag": "lag, first-order lag, time constant, inertia of the drive",
    "robot.actuation.jerk": "jerk limit, smooth acceleration, s-curve",
    "robot.actuation.dead_band": "deadband, dead zone, static friction, stiction",
    "robot.actuation.command_period": "control rate, control frequency, zero-order hold",
    "robot.distribution": "random positions, random placement, random start, scatter, spread, placement",
    "robot.distribution.random": "random positions, random placement, random start, scatter",
    "robot.distribution.circle_crossing": "crowdnav, circle crossing, random angles of a circle, opposite goals",
    "robot.distribution.square_crossing": "crowdnav, square crossing, opposite sides",
    "robot.color": "colour",
    "robot.plot": "drawing, draw, label, appearance",
    "robot.plot.show_trajectory": "trajectory, trail, path drawn, show path",
    "robot": "robot, agent, multi robot, several robots, roboter, 机器人",
    "obstacle": "obstacle, moving obstacle, dynamic obstacle, static obstacle, door, chair"
    ", hindernis, hindernisse, obstáculo, 障碍物",
    "world": "environment, arena, scene",
    "world.width": "world size, arena size, size of the world",
    "world.boundary": "boundary, border, wall, edge of the world, closed world, courtyard, yard",
    "world.obstacle_map": "map, occupancy grid, grid map, gridmap, floor plan, grid, bitmap, terrain"
    ", karte, mapa, 地图",
    "world.obstacle_map.image": "image map, png, floor plan, bitmap, picture",
    "world.obstacle_map.ros": "ros map, map server, pgm, slam",
    "world.obstacle_map.perlin": "random map, forest, procedural",
    "world.zones": "zone, region, gate, finish line, race, criterion, trip wire, geofence, enters, "
    "crosses a line, restricted area, surveillance",
    "world.zones.slip": "slippery floor, wet floor, slippage, wheel slip, slip ratio, rutschig, resbaladizo",
    "world.zones.grip": "ice, icy, low friction, mu, friction of the ground, traction",
    "world.zones.surface": "gravel, grass, sand, asphalt, terrain type, ground type",
    "world.plot.title": "title, caption, heading of the picture",
    "world.collision_mode": "collision, crash, hit, bump, collide, impact",
    "world.time_limit": "time limit, timeout, duration, horizon, episode length, max steps, deadline",
    "world.step_time": "time step, step time, timestep, dt, period, frequency, sampling time, step size",
    "world.seed": "seed, random seed, reproducible",
    "gui.keyboard": "keyboard, teleop, manual control, joystick",
    "crowd-stops": "freeze, frozen, frozen crowd, crowd freezes, crowd stops, people stop, people freeze",
    "world.after_arrival": "freeze",
    "goal-unreachable": "path exist, path must exist, path to the goal exist, path to goal exist, way must exist, "
    "way to the goal exist, no path, no way to the goal, reachable, unreachable, can reach, connected",
    "goal-blocked": "free space, goal in an obstacle, goal in free space",
    "pictures": "path exist, path must exist, path to the goal exist, path to goal exist, way must exist, "
    "way to the goal exist, reachable, free space, draw the path, show the path",
    "avoidance": "between walls, among walls",
    "dead-ends": "deadlock, stuck, trap",
    "door-jam": "jam, jam at door, jam in a door, jammed, congestion, bottleneck, blocked door",
    "turning-circle": "three-point turn, u-turn, turning radius, turn around",
    "guard-patrol": "guard, watchman, surveillance, vision cone, sight cone",
    "room-evacuation": "evacuation, evacuate, emergency exit, exit, escape, room exit",
    "l-passage": "bend, l-bend, passage, corner, blind corner",
    "corridor-passing": "passage, corridor, hallway, aisle, flur, pasillo, 走廊",
    "doorway": "passage, narrow passage, door, gap, tür, puerta, 门",
    "warehouse": "lager, lagerhalle, almacén, 仓库",
    "car-park": "parking, parking lot, parking space, parking garage, parkplatz, aparcamiento, estacionamiento, 停车场",
    "crossing": "kreuzung, cruce, intersection, 十字路口, 路口",
}
"""Topic -> its everyday names, separated by commas; the names of the language itself are not repeated here."""


def named(query: str) -> list[str]:
    """Return the topics whose everyday names occur in a query; longer names come first.

    A name counts at any position: ``360 degree lidar`` names the lidars. It does not count inside a longer name that
    also occurs, such as ``drive`` in ``differential drive``. Words that tell nothing may stand between the words of a
    name: a ``crowd that does not freeze`` has the name ``crowd freezes``.
    """
    words = words_of(query.replace("*", " star"))
    telling = [k for k, word in enumerate(words) if word not in STOP_WORDS]
    matches: list[tuple[int, int, int, str]] = []  # (words, first word, last word, topic)
    for topic, names in EVERYDAY.items():
        spans = [
            (len(name), places[start], places[start + len(name) - 1], topic)
            for name in map(words_of, names.split(", "))
            for places in (range(len(words)), telling)
            for start in range(len(places) - len(name) + 1)
            if [words[k] for k in places[start : start + len(name)]] == name
        ]
        matches += sorted(spans, reverse=True)[:1]
    whole = [
        (count, topic)
        for count, start, end, topic in matches
        if not any(other[0] > count and other[1] <= start <= end <= other[2] for other in matches)
    ]
    return [topic for _, topic in sorted(whole, key=lambda span: -span[0])]
