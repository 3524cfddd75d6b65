import irsim
from report import show

env = irsim.make("field.yaml", display=False)
show("by name", env.get_object_by_name("rock").id)
show("no name", env.get_object_by_name("missing"))
show("by id", env.get_object_by_id(1).name)
show("no id", env.get_object_by_id(77))
show("group", [o.name for o in env.get_group_by_name("staff")])
show("equal", env.robot == env.get_object_by_id(0))
env.end(ending_time=0)
