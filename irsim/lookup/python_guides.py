"""Short texts for those who write programs: exceptions, scans, animations, many episodes, notebooks."""

from __future__ import annotations

from irsim.lookup.guides import Guide

__all__ = ["PYTHON"]

PYTHON: dict[str, Guide] = {
    "exceptions": Guide(
        "irsim.IrsimError: code, fix, diagnostics",
        "irsim.IrsimError is the base of every error that irsim raises on purpose. irsim.ScenarioError (with its kinds "
        "PlacementError and NotSimulatedError) has diagnostics, a list of all problems of the file at once, warnings "
        "included: each has code, severity, path (keys and indices), line and column (from 1), message, given, allowed "
        "and fix; as_dict() is the same for JSON. Every error has code, message, fix, where (the wrong argument) "
        "and at least one entry of diagnostics. A wrong value or action is InputError, also a ValueError; "
        "ScenarioNotFoundError is also a FileNotFoundError. Codes are a closed list (`irsim describe codes`), and each "
        "is a topic. Python's own errors remain: TypeError for a misspelt keyword argument (it names the nearest "
        "one), IndexError for a robot that does not exist, AttributeError for what cannot be set.",
        "import irsim\n\ntry:\n    irsim.run('scenario.yaml', strict=True)\nexcept irsim.ScenarioError as error:\n"
        "    for one in error.diagnostics:\n        print(one.code, one.path, one.line, one.fix)\n"
        "except irsim.IrsimError as error:\n    print(error.code, error)",
        (
            *("irsimerror", "irsim.irsimerror", "scenarioerror", "irsim.scenarioerror", "exception", "error", "errors"),
            *("placementerror", "notsimulatederror", "scenarionotfounderror", "codederror", "inputerror"),
            *("diagnostics", "error code", "error.code", "error.diagnostics", "catch an error"),
        ),
    ),
    "done": Guide(
        "env.done(): every robot has arrived or stopped",
        "env.done() is true when every robot has arrived, or was stopped by a collision; env.outcome then says which: "
        "success, collision, or timeout. done('any') is true for the first robot already. It ignores world.time_limit, "
        "as in IR-SIM 2.12, and stays false for a robot that is stuck: a loop must count its steps. `irsim run`, "
        "irsim.run, irsim.episodes and benchmarks end at the time limit.",
        "import irsim\n\nenv = irsim.make('scenario.yaml', display=False, seed=1)\n"
        "horizon = round((env.scenario.world.time_limit or 60) / env.step_time)\nfor _ in range(horizon):\n"
        "    env.step()\n    if env.done():\n        break\nprint(env.outcome, env.time)\nenv.end(ending_time=0)",
        ("env.done", "env.done()", "done()", "when does an episode end", "loop that never ends"),
    ),
    "scan keys": Guide(
        "keys of env.get_lidar_scan()",
        "env.get_lidar_scan(id) is of robot `id`, by default the first one, and lidar.get_scan() of one sensor. Keys: "
        "ranges, array (beams,) in m from right (angle_min) to left (angle_max), with range_max where a beam hits "
        "nothing; valid, (beams,), whether it hit something; velocity, (2, beams), of what was hit, with has_velocity "
        "(radial_velocity, (beams,), of a lidar fmcw_lidar2d); angle_min, angle_max and angle_increment in rad; "
        "range_min and range_max in m; time_increment and scan_time in s; intensities is None. A lidar with rate or "
        "latency has stamp, too: when the scan was measured, in s (sensor.stamp of every sensor). Arrays are copies. "
        "env.get_lidar_offset(id) is where the sensor sits.",
        "import numpy as np\n\nscan = env.get_lidar_scan()\nangles = np.linspace(scan['angle_min'], scan['angle_max'], "
        "len(scan['ranges']))\nnearest = angles[scan['ranges'].argmin()]",
        ("get_lidar_scan", "env.get_lidar_scan", "get_scan", "keys of a scan", "scan['ranges']", "angle_increment"),
    ),
    "animations": Guide(
        "save_ani=True, env.render(), env.end(…)",
        "irsim.make(…, save_ani=True) keeps a frame at each env.render(), at most one per world.sample_time, and "
        "env.end() writes them: to animation/animation_<world>.gif beside the script, in a notebook in the working "
        "directory. Options of env.end, or of ani_kwargs for all: path (a whole path), or ani_name and suffix (.gif, "
        ".apng, .png, .mp4, .webm); fps (10), last_frame_duration (1 s), loop (0: without end); rm_fig_path=False "
        "also keeps every frame as PNG; others go to the encoder of a video. ending_time is how long a window stays: "
        "0 without one. Where behaviors drive, `irsim render scenario.yaml -o run.gif` needs no program.",
        "import irsim\n\nenv = irsim.make('scenario.yaml', display=False, save_ani=True)\nfor _ in range(100):\n"
        "    env.step()\n    env.render()\n    if env.done():\n        break\nenv.end(ending_time=0, path='run.gif', "
        "fps=20, last_frame_duration=2)",
        (
            *("save_ani", "ani_kwargs", "ani_name", "end", "env.end", "env.end()", "ending_time", "animation", "gif"),
            *("mp4", "video", "last_frame_duration", "rm_fig_path", "save a gif", "save an animation"),
        ),
    ),
    "episodes": Guide(
        "irsim.episodes(file, controller, seeds): all cores",
        "irsim.episodes(file, controller, seeds=100) runs an episode for each seed with a function controller(env) of "
        "yours, or an object that can be called, on all cores. It returns an action for env.step, or None to let "
        "behaviors drive. Seeds for parallel work are one number per episode, so the result is the same to the last "
        "bit with any workers: each episode starts with a fresh copy of the controller; draw from env.rng, and keep "
        "nothing in variables of a module. Where nothing is random, all episodes are equal, and result.same is true. "
        "The controller must be in a module that other processes import (or workers=1). Every step is recorded: "
        "result.to_pandas() has a row per step and object, "
        "result.to_pandas('robots') one per episode and robot, and result.episodes[0].replay() plays one.",
        "# controller.py: turn to the goal, then drive\nimport math\n\ndef act(env):\n"
        "    (x, y, heading), (to_x, to_y) = env.robot.state[:3, 0], env.robot.goal[:2, 0]\n"
        "    turn = math.remainder(math.atan2(to_y - y, to_x - x) - heading, math.tau)\n"
        "    return [0.0 if abs(turn) > 0.5 else 1.0, 2 * turn]\n\n"
        "# the program\nimport irsim\nfrom controller import act\n\n"
        "result = irsim.episodes('scenario.yaml', act, seeds=20)\nprint(result.summary)\n"
        "print(result.to_pandas('robots')[['seed', 'outcome', 'time_to_goal']])",
        (
            *("irsim.episodes", "many episodes", "parallel", "parallel seeds", "seeds for parallel work", "workers"),
            *("own controller", "my own controller", "controller", "multiprocessing", "all cores", "log per step"),
        ),
    ),
    "notebooks": Guide(
        "Jupyter: env, results and replays show themselves",
        "In a notebook the last value of a cell shows itself: environments, batches, vector environments, results and "
        "policies (irsim.open_policy('orca')). env.render(0.1) in a loop updates one picture below its cell and shows "
        "each for 0.1 s. env.replay() shows the present episode and irsim.run(…).replay() a run on the replay page, "
        "inside the cell; .save('replay.html') writes the page. "
        "irsim.run(…).to_pandas() is a table with a row per step and object, irsim.benchmark(…).to_pandas() one with a "
        "row per episode; pip install pandas. Files of save_ani and save_figure go to the working directory.",
        "import irsim\n\nenv = irsim.make('scenario.yaml', seed=1)\nfor _ in range(100):\n    env.step()\n"
        "    env.render(0.1)\nenv.replay()",
        (
            *("notebook", "jupyter", "colab", "ipython", "vs code", "marimo", "env.replay", "to_pandas", "pandas"),
            *("dataframe", "data frame", "_repr_html_"),
        ),
    ),
}
"""Name -> text, example, and the names that programs and users have for it."""
