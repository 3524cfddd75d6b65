"""Answers about suites: the bundled benchmarks, and the keys of a suite file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, get_args

from pydantic import BaseModel

from irsim.benchmarks.suite import SUITES, Seeds, Suite, SuiteScenario, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.lookup.answer import Answer, Key
from irsim.scenario.behavior_override import behavior_text
from irsim.scenario.perturbation import Perturbation

__all__ = ["model_keys", "suite_answer", "suite_key_answer", "suites_answer"]

_PARTS: dict[str, type[BaseModel]] = {"": Suite, "scenarios": SuiteScenario, "seeds": Seeds, "perturb": Perturbation}
"""Key of a suite file whose value has keys → these; the empty text stands for the file."""


def suites_answer() -> Answer:
    """List the bundled suites, and describe the keys of a suite file."""
    listed = [Key(name=name, text=load_suite(name)[0].title) for name in SUITES.names()]
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
        example=_EXAMPLE,
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


def suite_answer(name: str) -> Answer:
    """Describe a bundled suite."""
    suite, plan = load_suite(name)[0], suite_plan(name)
    full = f" ({suite.seeds.full} with --full)" if suite.seeds.full else ""
    return Answer(
        topic=name,
        kind="suite",
        title=f"suite {name}: {suite.title}",
        text=f"{suite.about} Seeds {plan.seeds[0]} to {plan.seeds[-1]}{full}, at most {suite.steps} steps; protocols: "
        f"{', '.join(suite.protocols)}. One scenario is named {name}/{plan.scenarios[0].name}, for irsim run and for "
        "the tools.",
        groups={
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


_EXAMPLE = """\
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
