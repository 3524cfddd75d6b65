import irsim
from irsim.world.object_base import ObjectBase
from report import show

env = irsim.make("field.yaml", display=False)
calls = []


class Watched(ObjectBase):
    def pre_process(self):
        calls.append("pre")

    def mid_process(self, state):
        calls.append("mid")
        return super().mid_process(state)

    def post_process(self):
        calls.append("post")


robot = Watched(
    kinematics={"name": "diff"}, shape={"name": "circle", "radius": 0.2}, state=[2, 2, 0], role="robot", name="watched"
)
env.add_object(robot)
env.step([0.5, 0.0], robot.id)
show("calls", calls)
show("state", robot.state)
env.end(ending_time=0)
