"""Answers about suites: the bundled benchmarks, and the keys of a suite file."""

from __future__ import annotations

from irsim.benchmarks.suite import Seeds, Suite, SuiteScenario
from irsim.benchmarks.suite_files import load_suite, suite_names
from irsim.benchmarks.suite_plan import suite_plan
from irsim.lookup.answer import Answer, Key

__all__ = ["suite_answer", "suite_names", "suites_answer"]


def suites_answer() -> Answer:
    """List the bundled suites, and describe the keys of a suite file."""
    listed = [Key(name=name, text=load_suite(name)[0].title) for name in suite_names()]
    return Answer(
        topic="suites",
        kind="index",
        title="Suites: benchmarks with fixed scenarios, seeds, horizon, protocols and policies",
        text="`irsim benchmark NAME` runs one. A file with these keys is a suite of your own: `irsim benchmark FILE`.",
        groups={
            "suites": listed,
            "keys of a suite file": _keys(Suite),
            "keys of each of its scenarios": _keys(SuiteScenario),
            "keys of seeds": _keys(Seeds),
        },
        example=_EXAMPLE,
        see=["metrics", "templates"],
    )


def suite_answer(name: str) -> Answer:
    """Describe a bundled suite."""
    suite, plan = load_suite(name)[0], suite_plan(name)
    full = f" ({suite.seeds.full} with --full)" if suite.seeds.full else ""
    return Answer(
        topic=name,
        kind="suite",
        title=f"suite {name}: {suite.title}",
        text=f"{suite.about} Seeds {plan.seeds[0]} to {plan.seeds[-1]}{full}, at most {suite.steps} steps; protocols: "
        f"{', '.join(suite.protocols)}.",
        groups={
            "scenarios": [Key(name=one.name) for one in plan.scenarios if one.protocol == suite.protocols[0]],
            "policies": [Key(name=label, text=text) for label, text in plan.policies.items()],
            "sources": [Key(name=source) for source in suite.sources],
        },
        example=f"irsim benchmark {name} --seeds 5",
        see=["suites"],
    )


def _keys(model: type[Suite | SuiteScenario | Seeds]) -> list[Key]:
    """The keys of a part of a suite file."""
    keys = []
    for name, field in model.model_fields.items():
        plain = None if field.is_required() or field.default is None else field.get_default(call_default_factory=True)
        default = None if plain is None or isinstance(plain, Seeds) else str(plain)
        keys.append(Key(name=name, required=field.is_required(), default=default, text=field.description or ""))
    return keys


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
