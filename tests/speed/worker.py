"""Measures one scene inside the interpreter of the simulator that is measured; needs nothing but that simulator.

python worker.py JOB        JOB is a JSON file with mode, steps, worlds, file, seconds and result
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

ROUNDS = 3


def main(job: dict[str, Any]) -> dict[str, float]:
    """Seconds of processor time per step, the least of several rounds, and the megabytes that were needed."""
    import irsim

    sys.path[0] = os.getcwd()
    if job["mode"] == "gif":
        times = [_animation(irsim, job) for _ in range(2)]
    else:
        episode = {"act": _act, "plan": _plan, "render": _draw, "savefig": _draw, "batch": _batch}.get(
            job["mode"], _step
        )
        env = _open(irsim, job)
        times = [_repeat(episode, env, job) for _ in range(ROUNDS)]
    return {"step_s": min(times), "memory_mb": _memory()}


def _open(irsim: Any, job: dict[str, Any]) -> Any:
    if job["mode"] == "batch":
        return irsim.batch(job["file"], job["worlds"], threads=1)
    drawn = job["mode"] in ("render", "savefig")
    return irsim.make(job["file"], display=False, log_level="ERROR", disable_all_plot=not drawn)


def _repeat(episode: Any, env: Any, job: dict[str, Any]) -> float:
    """Seconds per step of whole episodes until the time is up; resets are not timed."""
    spent, steps = 0.0, 0
    while spent < job["seconds"]:
        env.reset()
        spent += episode(env, job)
        steps += job["steps"]
    return spent / steps


def _step(env: Any, job: dict[str, Any]) -> float:
    start = time.process_time()
    for _ in range(job["steps"]):
        env.step()
    return time.process_time() - start


def _act(env: Any, job: dict[str, Any]) -> float:
    """An action, and everything that a learner reads after it."""
    actions = [[0.6, 0.16 * (k * 7 % 11 - 5)] for k in range(job["steps"])]
    robot, seen = env.robot, 0.0
    start = time.process_time()
    for action in actions:
        env.step(action)
        seen += float(env.get_lidar_scan(0)["ranges"][0]) + float(robot.state[0, 0]) + robot.collision + robot.arrive
        env.done()
    return time.process_time() - start


def _plan(env: Any, job: dict[str, Any]) -> float:
    from irsim.lib.path_planners import AStarPlanner

    begin, end = env.get_robot_state(), env.get_robot_info().goal[:2, 0].tolist()
    start = time.process_time()
    AStarPlanner(env.get_map(resolution=0.2)).planning(begin, end, show_animation=False)
    return time.process_time() - start


def _draw(env: Any, job: dict[str, Any]) -> float:
    """Frames that are not shown, or that are written to a file; the steps between them are not timed."""
    spent = 0.0
    for _ in range(job["steps"]):
        env.step()
        start = time.process_time()
        env.render()
        if job["mode"] == "savefig":
            env.save_figure("frame.png")
        spent += time.process_time() - start
    return spent


def _batch(env: Any, job: dict[str, Any]) -> float:
    start = time.process_time()
    env.advance(job["steps"])
    return time.process_time() - start


def _animation(irsim: Any, job: dict[str, Any]) -> float:
    """Seconds per frame of an animation, including its end."""
    env = irsim.make(job["file"], display=False, log_level="ERROR", save_ani=True)
    start = time.process_time()
    for _ in range(job["steps"]):
        env.step()
        env.render()
    env.end(ending_time=0)
    return (time.process_time() - start) / job["steps"]


def _memory() -> float:
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as opened:
        given = json.load(opened)
    answer = main(given)
    with open(given["result"], "w", encoding="utf-8") as opened:
        json.dump(answer, opened)
