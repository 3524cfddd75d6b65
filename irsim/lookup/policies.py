"""Answers about policies, which drive robots and are not part of a scenario."""

from __future__ import annotations

from irsim.benchmarks.suite import SUITES, load_suite
from irsim.lookup.answer import Answer, Key
from irsim.lookup.suites import model_keys
from irsim.policies.converters.weights import CONVERTERS
from irsim.policies.description import PolicyInfo, describe_policy, list_policies
from irsim.policies.registry import POLICIES
from irsim.policies.trained import trained_policies

__all__ = ["convert_answer", "policies_answer", "policy_answer"]


def policy_answer(topic: str) -> Answer | None:
    """Describe a policy that ships with irsim or comes from a plug-in, by its name there or in a suite; None: no such.

    Args:
        topic: The word in question: ``sarl``, ``RL-RVO``, or ``ppo``, as a suite calls another one.
    """
    name = topic.strip().lower().replace("-", "_").replace(" ", "_")
    known = {*trained_policies(), *POLICIES.names()}
    if name in known:
        return _policy(name, [])
    for suite in (load_suite(each)[0] for each in SUITES.names()):
        text = suite.known_policies.get(name)
        if isinstance(text, str) and text in known:
            return _policy(text, [f"The suite {suite.suite} calls it {name}."])
    return None


def _policy(name: str, notes: list[str]) -> Answer:
    """The answer about a trained policy, or one of a plug-in."""
    info = describe_policy(name)
    card = info.facts.get("card", {})
    period = "in every step" if info.decision_dt is None else f"every {info.decision_dt:g} s"
    facts = {
        "needs": ", ".join(info.needs) or "only the robot and its goal",
        "drives": ", ".join(info.drives),
        "returns": info.output,
        "does not see": info.unseen,
        "decides": period,
        "trained on": card.get("task", "").partition(",")[0],
        "protocol": card.get("protocol", ""),
        "scenes of the training": f"seeds from {card['seeds'][-1]}" if card.get("seeds") else "",
        "decisions of the training": f"{card['steps']:,}" if card.get("steps") else "",
        "license": card.get("license", ""),
        "not installed": info.install or "",
    }
    groups = {"facts": [Key(name=key, text=text) for key, text in facts.items() if text]}
    if info.options:
        groups["options"] = [
            Key(name=key, text=_option(text, info.meanings.get(key, ""))) for key, text in info.options.items()
        ]
    return Answer(
        topic=name,
        kind="policy",
        title=f"{info.kind} policy {name}",
        text=" ".join([f"{info.about.rstrip('.')}.", *notes]),
        groups=groups,
        example=f"irsim benchmark scenario.yaml --policies {_in_list(info)}",
        see=["policies", "which-policy"],
    )


def convert_answer(kind: str = "") -> Answer | None:
    """Describe ``irsim convert``, or one kind of weights that it takes; None: there is no such kind."""
    features = {feature.name: feature for feature in CONVERTERS.features()}
    if kind and kind not in features:
        return None
    chosen = [features[kind]] if kind else list(features.values())
    about = [f"{one.name}: {' '.join((one.options.__doc__ or '').split())}" for one in chosen]
    return Answer(
        topic=f"convert {kind}".strip(),
        kind="index",
        title="irsim convert: policy files of weights that others trained with PyTorch",
        text="The file is what torch.save wrote: a state dictionary, or a whole module; nothing in it is run. Tensors "
        f"are found by their names and shapes. {' '.join(about)}",
        groups={
            f"options of {one.name} (--set KEY=VALUE)": [key for key in model_keys(one.options) if key.name != "name"]
            for one in chosen
        },
        example=f"irsim convert {chosen[0].name} weights.pth -o model.npz --set license=MIT",
        see=["policies"],
    )


def _option(default: str, meaning: str) -> str:
    said = default if default == "required" else f"default {default}"
    return f"{said}. {meaning}" if meaning else said


def _in_list(info: PolicyInfo) -> str:
    """The policy beside `orca`, as it is written in a command."""
    required = [key for key, default in info.options.items() if default == "required"]
    if not required:
        return f"orca,{info.name}"
    return f"'orca,{{name: {info.name}, {', '.join(f'{key}: …' for key in required)}}}'"


def policies_answer() -> Answer:
    """List the policies, and say how one of your own is written."""
    kinds = ", ".join(CONVERTERS.names())
    listed = [Key(name=one.name, text=f"{one.kind}: {one.about}") for one in list_policies()]
    return Answer(
        topic="policies",
        kind="index",
        title="Policies: they drive robots and are not part of the scenario",
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
                Key(
                    name="run_episode, benchmark", text="the MCP tools, with policy and policies; they run no plug-ins"
                ),
            ],
        },
        example=_EXAMPLE,
        see=["which-policy", "convert", "behaviors", "suites", "metrics"],
    )


_EXAMPLE = """\
class ToGoal(irsim.Policy):
    name, output = "to-goal", "velocity"        # m/s in the world frame: any drive follows it

    def act(self, seen):                        # arrays with one row for each robot
        return 0.5 * (seen.goal - seen.pose)[:, :2]

irsim.benchmark("scenario.yaml", ["orca", ToGoal()])
"""
