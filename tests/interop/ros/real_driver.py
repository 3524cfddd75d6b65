"""A scenario that drives a real robot, to be crashed or killed: `real_driver.py SCENE STEPS [crash]`."""

from __future__ import annotations

import os
import sys
import time

import irsim

env = irsim.make(sys.argv[1], display=False, log_level="ERROR")
with irsim.connect(env) as connection:
    [bridge] = connection.bridges
    print("open", os.getpid(), bridge._guard.pid if bridge._guard else 0, flush=True)
    for step in range(int(sys.argv[2])):
        env.step()
        print("step", step, round(time.time(), 3), *(round(float(v), 3) for v in env.robot.state[:3, 0]), flush=True)
        if len(sys.argv) > 3 and sys.argv[3] == "crash" and step == 40:
            raise RuntimeError("crash")
        if len(sys.argv) > 3 and sys.argv[3] == "hang" and step == 40:
            time.sleep(60)
print("closed", flush=True)
