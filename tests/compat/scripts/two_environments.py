import irsim
from report import show

one = irsim.make("field.yaml", headless=True, seed=1)
two = irsim.make("collisions.yaml", headless=True, seed=2)
for _ in range(3):
    one.step()
two.step()
show("times", [one.time, two.time])
show("ids", [[o.id for o in one.objects], [o.id for o in two.objects]])
show("counts", [one.world_param.count, two.world_param.count])
one.end()
two.step()
show("goes on", two.time)
two.end()
