"""Answers about policies: what drives robots and is no part of their scenario."""

from __future__ import annotations

from irsim.lookup.answer import Answer, Key
from irsim.policies.converters.features import CONVERTERS
from irsim.policies.description import list_policies

__all__ = ["policies_answer"]


def policies_answer() -> Answer:
    """List the policies, and say how one of your own is written."""
    kinds = ", ".join(CONVERTERS.names())
    listed = [Key(name=one.name, text=f"{one.kind}: {one.about}") for one in list_policies()]
    return Answer(
        topic="policies",
        kind="index",
        title="Policies: what drives robots and is no part of their scenario",
        text="A policy sees observations of all robots that decide now and returns controls, or velocities in the "
        "world frame. The same policy drives one run, a batch, a benchmark and a loop of your own; changing it never "
        "changes the scenario, its obstacles or its noise. Behaviors are policies, too.",
        groups={
            "policies": listed,
            "files": [
                Key(name="model.npz", text="a network of irsim; irsim policies model.npz describes it"),
                Key(name="model.onnx", text="a network for onnxruntime"),
                Key(name="{name: process, command: [python3, mine.py]}", text="a program; irsim describe process"),
                Key(name="irsim convert KIND FILE -o model.npz", text=f"weights of PyTorch; kinds: {kinds}"),
            ],
            "where": [
                Key(name="irsim run FILE --policy NAME", text="one run; also irsim.run(file, policy=…)"),
                Key(name="irsim benchmark FILE --policies A,B", text="a comparison; also irsim.benchmark"),
                Key(name="irsim.make(file, policy=…)", text="a loop; env.set_policy changes it while it runs"),
                Key(name="irsim.batch(file, n, policy=…)", text="many worlds at once"),
            ],
        },
        example=_EXAMPLE,
        see=["behaviors", "suites", "metrics"],
    )


_EXAMPLE = """\
class ToGoal(irsim.Policy):
    name, output = "to-goal", "velocity"        # m/s in the world frame: any drive follows it

    def act(self, seen):                        # arrays with one row for each robot
        return 0.5 * (seen.goal - seen.pose)[:, :2]

irsim.benchmark("scenario.yaml", ["orca", ToGoal()])
"""
