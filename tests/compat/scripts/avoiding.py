import irsim
from report import show

for name in ("rvo", "sfm", "orca"):
    env = irsim.make(f"avoiding_{name}.yaml", display=False)
    for _ in range(400):
        env.step()
        if env.done():
            break
    show(name, [env.done(), [r.arrive for r in env.robot_list], [r.collision for r in env.robot_list]])
    env.end(ending_time=0)
