"""Topics about policies, and about the suites that compare them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, get_args

from pydantic import BaseModel

from irsim.benchmarks.suite import SUITES, WRITTEN_SUITES, Seeds, Suite, SuiteScenario, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.lookup.answer import Answer, Key
from irsim.policies.converters.convert import CONVERTERS
from irsim.policies.description import PolicyInfo, describe_policy, list_policies
from irsim.policies.registry import MIXED, POLICIES
from irsim.policies.scene_cards import SCENE_CARDS
from irsim.policies.trained import trained_policies
from irsim.scenario.behavior_override import behavior_text
from irsim.scenario.perturbation import Perturbation
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = [
    "advice_among_people",
    "convert_answer",
    "policies_answer",
    "policy_answer",
    "suite_answer",
    "suite_key_answer",
    "suites_answer",
]


def policy_answer(topic: str) -> Answer | None:
    """Describe a policy that ships with irsim or comes from a plug-in, by its name there or in a suite; None: no such.

    Args:
        topic: The word in question: ``sarl``, ``RL-RVO``, or ``ppo``, as a suite calls another one.
    """
    name = topic.strip().lower().replace("-", "_").replace(" ", "_")
    known = {*trained_policies(), MIXED, *POLICIES.names()}
    if name in known:
        return _policy(name, [])
    for suite in (load_suite(each)[0] for each in SUITES.names()):
        text = suite.known_policies.get(name)
        if isinstance(text, str) and text in known:
            return _policy(text, [f"The suite {suite.suite} calls it {name}."])
    return None


def advice_among_people(law: str) -> str:
    """The options that a law needs among people who do not give way, as a sentence; empty without such options."""
    card = SCENE_CARDS.get(law)
    setting = ", ".join(f"{key}: {yaml_flow(value)}" for key, value in (card.remedy if card else {}).items())
    return f"A robot among people who do not give way needs `{setting}`." if setting else ""


def _policy(name: str, notes: list[str]) -> Answer:
    """The answer about a trained policy, or one of a plug-in."""
    info = describe_policy(name)
    card = info.facts.get("card", {})
    period = "in every step" if info.decision_dt is None else f"every {info.decision_dt:g} s"
    facts = {
        "class": info.knows,
        "knows": info.facts_known,
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


_PARTS: dict[str, type[BaseModel]] = {"": Suite, "scenarios": SuiteScenario, "seeds": Seeds, "perturb": Perturbation}
"""Key of a suite file whose value has keys → these; the empty text stands for the file."""


def suites_answer() -> Answer:
    """List the bundled suites, and describe the keys of a suite file."""
    listed = [Key(name=name, text=load_suite(name)[0].title) for name in SUITES.names()]
    listed += [Key(name=name, text=f"of recordings that you have; {how}") for name, how in WRITTEN_SUITES.items()]
    return Answer(
        topic="suites",
        kind="index",
        title="Suites: benchmarks with fixed scenarios, seeds, horizon, protocols and policies",
        text="`irsim benchmark NAME` runs one. A file with these keys is a suite of your own: `irsim benchmark FILE`.",
        groups={
            "suites": listed,
            "keys of a suite file": model_keys(Suite),
            "keys of each of its scenarios": model_keys(SuiteScenario),
            "keys of seeds": model_keys(Seeds),
            "keys of each of perturb": model_keys(Perturbation),
        },
        example=_SUITE_EXAMPLE,
        see=["metrics", "templates", "suites.vary"],
    )


def suite_key_answer(words: Sequence[str]) -> Answer | None:
    """Describe a key of a suite file; None if there is no such key.

    Args:
        words: Its path below ``suites``, such as ``seeds`` or ``scenarios vary``; of the keys of a scenario and of
            seeds the last word is enough.
    """
    places = [("", *words)] if len(words) == 1 else [tuple(words)]
    places += [(part, *words) for part in _PARTS if part and len(words) == 1]
    for place in places:
        if len(place) == 2 and place[0] in _PARTS and place[1] in _PARTS[place[0]].model_fields:
            part, name = place
            about = next(key for key in model_keys(_PARTS[part]) if key.name == name)
            below = {f"keys of {name}": model_keys(_PARTS[name])} if not part and name in _PARTS else {}
            topic = ".".join(["suites", *([part] if part else []), name])
            return Answer(
                topic=topic,
                kind="key",
                title=f"{topic}: a key of a suite file" if not part else f"{topic}: a key of {part} in a suite file",
                text=about.text,
                about=about.model_copy(update={"text": ""}) if _has_facts(about) else None,
                groups=below,
                example=_EXAMPLES.get(name),
                see=["suites"],
            )
    return None


def _horizon(suite: Suite) -> str:
    return f"at most {suite.steps} steps" if suite.seconds is None else f"at most {suite.seconds:g} s"


def _written_suite(name: str) -> Answer:
    """The answer about a suite that a command writes."""
    return Answer(
        topic=name,
        kind="suite",
        title=f"suite {name}: made of recordings that you have",
        text=f"irsim does not ship the recordings. `{WRITTEN_SUITES[name]}` writes the suite as {name}.yaml, and says "
        f"whether the published results were made with the same files; `irsim benchmark {name}.yaml` runs it. The same "
        f"files give the same suite. One scenario is named {name}.yaml/SCENARIO, for irsim run.",
        see=["suites", "imports"],
    )


def suite_answer(name: str) -> Answer:
    """Describe a published suite."""
    if name in WRITTEN_SUITES:
        return _written_suite(name)
    suite, plan = load_suite(name)[0], suite_plan(name)
    full = f" ({suite.seeds.full} with --full)" if suite.seeds.full else ""
    return Answer(
        topic=name,
        kind="suite",
        title=f"suite {name}: {suite.title}",
        text=f"{suite.about} One scenario is named {name}/{plan.scenarios[0].name}, for irsim run and for the tools.",
        groups={
            "fixed": [
                Key(name="seeds", text=f"{plan.seeds[0]} to {plan.seeds[-1]}{full}"),
                Key(name="time", text=_horizon(suite)),
                Key(name="protocols", text=", ".join(suite.protocols)),
            ],
            "scenarios": [Key(name=one.name) for one in plan.scenarios if one.protocol == suite.protocols[0]],
            "policies": [Key(name=label, text=text) for label, text in plan.policies.items()],
            "policies that run only where --policies names them": [
                Key(name=label, text=behavior_text(policy)) for label, policy in suite.others.items()
            ],
            "sources": [Key(name=source) for source in suite.sources],
        },
        example=f"irsim benchmark {name} --seeds 5",
        see=["suites", *(["which-policy"] if suite.others else [])],
    )


def model_keys(model: type[BaseModel]) -> list[Key]:
    """The keys of a model of options, such as a part of a suite file."""
    keys, described = [], model.model_json_schema()["properties"]
    for name, field in model.model_fields.items():
        plain = None if field.is_required() or field.default is None else field.get_default(call_default_factory=True)
        default = None if plain in (None, "") or isinstance(plain, BaseModel) else str(plain)
        text, words = " ".join(described[name].get("description", "").split()), _choices(field.annotation)
        allowed = ", ".join(words) or None
        keys.append(Key(name=name, required=field.is_required(), default=default, allowed=allowed, text=text))
    return keys


def _has_facts(about: Key) -> bool:
    return about.required or about.default is not None or about.allowed is not None


def _choices(annotation: Any) -> list[str]:
    """The words that a type allows."""
    if getattr(annotation, "__origin__", None) is Literal:
        return [str(word) for word in get_args(annotation)]
    return [word for part in get_args(annotation) for word in _choices(part)]


_SUITE_EXAMPLE = """\
suite: my_field
version: 1
title: Robots among posts
scenarios:
  - name: field
    vary: {"robot[0].number": [2, 4], "obstacle[0].number": [5, 10]}
    scenario:
      world: {width: 10, height: 10}
      robot: [{number: 2, kinematics: {name: diff}, distribution: {name: random}}]
      obstacle: [{number: 5, shape: {name: circle, radius: 0.4}, distribution: {name: random}}]
  - name: mixed
    vary: [{"robot[0].number": 1, "obstacle[0].number": 2}, {"robot[0].number": 2, "obstacle[0].number": 4}]
    scenario:
      world: {width: 10, height: 10}
      robot: [{number: 1, kinematics: {name: diff}, distribution: {name: random}}]
      obstacle: [{number: 2, shape: {name: circle, radius: 0.4}, distribution: {name: random}}]
seeds: {first: 0, count: 20}
steps: 400
protocols: [freeze]
policies: {orca: {name: orca, timeHorizon: 2}, dash: dash}
"""
_EXAMPLES = {
    "seeds": "seeds: {first: 0, count: 100, full: 1000}",
    "vary": 'vary: {"robot[0].number": [2, 4], world.width: [5, 10]}   # 4 scenarios\n'
    'vary: [{"robot[0].number": 2, world.width: 5}, {"robot[0].number": 4, world.width: 10}]   # 2 scenarios',
    "density": 'density: "robot[0].number"',
    "protocols": "protocols: [freeze, yield]",
    "until": "until: first_collision",
    "perturb": "perturb: [{position: 0.1, heading: 10deg}, {delay: 2, objects: [robot]}]",
    "policies": "policies: {orca: {name: orca, timeHorizon: 2}, dash: dash}",
    "steps": "steps: 500   # 50 s with a step_time of 0.1 s",
}
"""Key of a suite file → how it is written."""
