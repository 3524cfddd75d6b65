import collections

import irsim

EPISODES = $(episodes)
STEPS = $(steps)

for density in ("sparse", "medium", "dense"):
    for method in ("orca", "rvo"):
        outcomes = collections.Counter()
        for seed in range(EPISODES):
            env = irsim.make(f"{density}-{method}.yaml", seed=seed, headless=True, log_level="WARNING")
            arrived = collided = False
            for _ in range(STEPS):
                env.step()
                collided = any(robot.collision for robot in env.robot_list)
                arrived = all(robot.arrive for robot in env.robot_list)
                if collided or arrived:
                    break
            outcomes["collision" if collided else "success" if arrived else "timeout"] += 1
            env.end()
        rates = ", ".join(f"{name} {outcomes[name] / EPISODES:.0%}" for name in ("success", "collision", "timeout"))
        print(f"{density} {method}: {rates}", flush=True)
