"""Codes of drives: what they can and cannot do, their limits and actuators."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["DRIVES"]

DRIVES: dict[str, Code] = {
    "turning-circle": Code(
        "goal inside the turning circle",
        "A car turns in circles whose radius is its wheelbase over the tangent of its largest steering angle. "
        "'dash' steers as far as it can towards a goal inside such a circle and circles it endlessly. Example: "
        "wheelbase 2.6, steering up to 1 rad and a goal 1.2 m to the left; start with the heading towards the goal,"
        " or write a larger goal_threshold. 'follow' lets the car back up first, but without reverse ('vel_min' starts "
        "at 0) it stands still: write vel_min: [-2, -1], or a goal farther ahead.",
    ),
    "drive-not-pushed": Code(
        "contacts with a drive that has speeds of its own",
        "In 'collision_mode: contact' bodies push each other. single_track and diff_dynamic have speeds of their own, "
        "which contacts cannot change: take 'acker' or 'diff' there, or another mode.",
    ),
    "drive-by-acceleration": Code(
        "behavior on a drive that takes accelerations",
        "Behaviors and paths give speeds. 'mode: acceleration' of single_track is for policies and programs that give "
        "accelerations: write 'mode: steer' or 'mode: angular', or leave the behavior out.",
    ),
    "static-behavior": Code(
        "static object with a behavior",
        "'static: true' keeps an object in place, whatever its kinematics and behavior. Remove one of the two.",
    ),
    "no-speed": Code(
        "limits that allow no motion",
        "The behavior needs to move, but 'vel_min', 'vel_max' or 'acce' allow only rest. For diff and acker the "
        "first number is the forward speed; for omni the first two are the velocity, and since omni never turns, it"
        " must be able to move in the direction of its goal. Example: vel_max: [0, 1] only turns on the spot; write"
        " vel_max: [1, 1].",
    ),
    "no-turning": Code(
        "limits that allow no turning",
        "The second number of 'vel_max' and 'vel_min' is the turning rate (diff) or the steering angle (acker). If "
        "both are 0, the object only drives straight ahead and reaches only a goal straight ahead. Example: "
        "vel_max: [1, 0]; write vel_max: [1, 1].",
    ),
    "target-roles-nobody": Code(
        "no object of the role to avoid",
        "'target_roles' says which objects a behavior avoids: all, robot or obstacle. The scenario has no other "
        "object of that role ('unobstructed' ones do not count), so the behavior avoids nothing. Example: "
        "target_roles: robot with one robot among obstacles; write target_roles: all.",
    ),
    "unobstructed-robot": Code(
        "robot that others pass through",
        "Other objects do not collide with an object with 'unobstructed: true', and lidars do not see it. It still "
        "collides with objects that are not 'unobstructed'. Example: a robot that must drive through a curtain; "
        "write unobstructed: true on the curtain, not on the robot.",
    ),
    "jumps-through": Code(
        "steps longer than the obstacles are thick",
        "By default contacts are judged after each step. An object that moves farther in one step than it and the wall "
        "are thick together can pass to the other side without a collision; the run then reports passed_through. "
        "Example: 20 m/s × 0.1 s = 2 m against a wall of 0.1 m; lower step_time, or the speed: limits are in m/s. With "
        "contacts: swept in 'world', contacts within a step are collisions, too.",
    ),
    "brakes-too-late": Code(
        "a horizon shorter than it takes to brake",
        "Behaviors look a time horizon ahead, and with `acce` a robot takes a while to stop: speed / acce. If that is "
        "longer than the horizon, it brakes as hard as it can as soon as it sees what is ahead, and stands close to it "
        "instead of going round. Example: 1.2 m/s at 1 m/s^2 takes 1.2 s and 0.72 m; timeHorizonObst: 0.5 is too "
        "short, timeHorizonObst: 1.8 leaves time to decide. `footprint_orca` stops in time with any; `follow` "
        "leads it round large things.",
    ),
    "actuation-unused": Code(
        "actuation without effect",
        "'actuation' is what happens to commands before the drive executes them. Objects without a drive, static ones, "
        "obstacles that replay a recording and worlds with 'step_mode: external' have no commands, and a "
        "'command_period' of at most 'step_time' holds nothing. Example: actuation on an object without kinematics; "
        "remove it.",
    ),
    "ground-unfelt": Code(
        "ground of a zone that drives do not feel",
        "Zones of 'world.zones' may say what their ground does to wheels: 'slip' reaches every drive of irsim, 'grip' "
        "those with forces (single_track, diff_dynamic), 'surface' only skid_steer, and drives in Python feel none of "
        "it. Example: grip: 0.2 under a robot with diff; write slip: 0.2, or kinematics: {name: diff_dynamic}.",
    ),
    "reacts-late": Code(
        "commands that take effect late",
        "'actuation' delays what a behavior decides, and behaviors decide as if their commands were executed at once. "
        "Of 15 scenes in which 8 omnidirectional robots cross a circle at 1 m/s (acce [2, 4]), with a 'delay' of 0.1 s "
        "all end without a contact under rvo, 14 under orca, 7 under footprint_orca and 0 under sfm; with a 'delay' "
        "and a 'lag' of 0.3 s each 15 under orca and 0 under the others. Example: behavior: {name: sfm} with delay: "
        "0.3; write behavior: {name: orca}.",
    ),
    "lag-twice": Code(
        "a lag that is given twice",
        "'lag' under 'actuation' and the older 'tau' of the kinematics, or 'world.drive_tau' ('collision_mode: "
        "contact'), are the same thing: a first-order lag of the drive. Keep one of them; 'tau: 0' in the kinematics "
        "takes an object out of 'world.drive_tau'.",
    ),
    "perceives-without-sensor": Code(
        "a robot that lacks the sensor it decides from",
        "'perceives: estimate' decides from the pose that 'localization', or else 'odometry', reports, 'perceives: "
        "tracks' from the tracks of a 'detector', and 'both' from the two. Example: perceives: estimate, with sensors: "
        "[{name: lidar2d}]; add {name: localization}.",
    ),
    "perceives-unused": Code(
        "perceives without effect",
        "'perceives' says from what behaviors and policies decide. Objects without a drive, static ones and obstacles "
        "that replay a recording decide nothing. Example: perceives: tracks on an object without kinematics; remove "
        "it.",
    ),
    "odometry-drifts": Code(
        "odometry that is lost before the goal",
        "'perceives: estimate' without 'localization' goes by wheel odometry, whose errors add up. The finding gives "
        "the root mean square of its error at the end of the straight way through all waypoints, to the first order: "
        "an error of the heading moves the end by the distance from there to the end. The slip of zones on the way "
        "counts at the largest speed. "
        "Example: heading_noise: 0.05 is off by 0.9 m after 10 m; add {name: localization}, or write a smaller one.",
    ),
    "coarse-steps": Code(
        "steps that are long for the size of a body",
        "A body that moves by more than half of its smallest extent in a step, or turns by more than 0.5 rad (its rim "
        "then moves by a quarter of its size), is seen, judged and decided for at few places of its way. Euler's law "
        "moves it straight within a step and turns it afterwards: on a circle its position is off by up to the length "
        "of one step. A smaller step_time cures both; integration: exact cures the turn alone, with arcs that do not "
        "depend on the step.",
    ),
}
