import irsim
from report import show

env = irsim.make("wander.yaml", display=False, seed=2)
for _ in range(60):
    env.step()
wanderer, shuttle = env.robot_list
show("wander", [wanderer.wander, wanderer.loop])
show("inside", bool(1 <= wanderer.goal[0, 0] <= 9 and 1 <= wanderer.goal[1, 0] <= 9))
show("range", [wanderer.rl, wanderer.rh])
show("shuttle", [shuttle.state, shuttle.goal, shuttle.loop])
env.end(ending_time=0)
