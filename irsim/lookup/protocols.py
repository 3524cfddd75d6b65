"""Protocol pages of the bundled suites: what a reader needs to judge their numbers, made from the suites themselves."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from irsim.benchmarks.assumptions import assumptions_of
from irsim.benchmarks.report.markdown import INTERVALS
from irsim.benchmarks.suite import SUITES, Suite, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.common.data_files import skills_directory
from irsim.common.text import listed, plural
from irsim.lookup.answer import plain_table
from irsim.policies.catalog import open_policy
from irsim.scenario.behavior_override import AS_WRITTEN, behavior_text
from irsim.scenario.open import read_scenario
from irsim.scenario.perturbation import perturbation_text
from irsim.scenario.resolve.resolved import ResolvedScenario, random_parts

__all__ = ["protocol_pages"]

_ENDS = {
    "done": "An episode ends when every robot has arrived or stopped, or at the horizon.",
    "first_collision": "An episode ends with the first collision of a robot, when all have arrived, or at the horizon.",
}
_OUTCOMES = (
    "Success: every robot reached its goal before the horizon, and touched nothing before. Collision: a robot was "
    "stopped by a contact, or arrived after one. Time-out: neither. A seed without room for an object is "
    "`placement-crowded` and counts in no rate. [Metrics](metrics.md) are defined elsewhere; the deciding one is "
    "`success`."
)
_ROLES = (
    "Here several policies share a scene, so read `success` by role: the share of the robots of a role that arrived "
    "without a contact, where each episode counts once."
)
_STATISTICS = f"{INTERVALS} Differences are of the same scenario and seed; ranks and all pairs: [result](result.md)."


def protocol_pages() -> dict[str, str]:
    """Name of a suite → its page without the title, for each bundled suite."""
    return {name: "\n\n".join(_parts(name)) for name in SUITES.names()}


def _parts(name: str) -> Iterator[str]:
    suite, plan = load_suite(name)[0], suite_plan(name)
    scenes = {
        one.family: read_scenario(one.document(), strict=True)[0]
        for one in reversed(plan.scenarios)
        if one.protocol == suite.protocols[0]
    }
    scenes = {family.name: scenes[family.name] for family in suite.scenarios}
    yield f"Suite `{name}`, version {suite.version}, suite hash `{plan.suite_hash}`."
    yield f"## Question\n\n{suite.title}. {suite.about}".rstrip()
    yield "## Scenes\n\n" + plain_table(("scenario", "varies", "world", "objects", "chance"), _rows(suite, scenes))
    yield " ".join(_rules(suite, len(plan.scenarios)))
    rows = [*_policies(suite.policies), *_policies(suite.others)]
    yield "## Policies, and what they know\n\n" + plain_table(("policy", "as written", "knows"), rows)
    roles = f" {_ROLES}" if any(family.policies for family in suite.scenarios) else ""
    yield f"## Outcomes and metrics\n\n{_ENDS[suite.until]} {_OUTCOMES}{roles}"
    yield f"## Statistics\n\n{_STATISTICS}"
    yield "## Assumptions and threats\n\n" + "\n".join(f"- {threat}" for threat in _threats(suite, scenes))
    if suite.sources:
        yield "## Sources\n\n" + "\n".join(f"- {source}" for source in suite.sources)
    first = next((policy for policy in suite.policies if policy != AS_WRITTEN), None)
    driven = f" --policy {first}" if first else ""
    one = f"irsim run {name}/{plan.scenarios[0].name} --seed {plan.seeds[0]}{driven}"
    listed = ", ".join(f"`{policy}`" for policy in suite.policies)
    runs = f"`irsim benchmark {name}` runs {listed}" if listed else f"`irsim benchmark {name}`"
    own = f"{runs}; one episode: `{one}`."
    yield "\n".join(["## Run it", "", own, *_commands(name)])


def _commands(name: str) -> list[str]:
    """The command of each kept result of a suite, as its page has it."""
    pages = sorted((skills_directory() / "irsim-benchmark" / "results").glob("*.md"))
    command = re.compile(rf"^Reproduce: `(irsim benchmark {name}(?: [^`]*)?)`", re.MULTILINE)
    matches = {page: command.search(page.read_text(encoding="utf-8")) for page in pages}
    lines = [f"- [{page.stem}](../results/{page.name}): `{line[1]}`" for page, line in matches.items() if line]
    return ["", "Kept results, and the command of each:", "", *lines] if lines else []


def _rows(suite: Suite, scenes: Mapping[str, ResolvedScenario]) -> Iterator[tuple[str, ...]]:
    """A row of each family of scenarios."""
    for family in suite.scenarios:
        scene = scenes[family.name]
        x0, y0, x1, y1 = scene.world.bounds
        varied = {key: [str(each[key]) for each in family.variants() if key in each] for key in family.varied()}
        words = [f"`{key}`: {listed([*dict.fromkeys(varied[key])], 6)}" for key in sorted(varied)]
        words += [f"{key}: `{behavior_text(one)}`" for key, one in family.policies.items()]
        robots = len(scene.robots())
        yield (
            f"`{family.name}`",
            "; ".join(words),
            f"{x1 - x0:g} x {y1 - y0:g} m, {scene.world.step_time:g} s",
            f"{plural(robots, 'robot')}, {len(scene.objects) - robots} others",
            ", ".join(random_parts(scene)) or "none",
        )


def _rules(suite: Suite, count: int) -> Iterator[str]:
    horizon = f"{suite.seconds:g} s" if suite.seconds is not None else f"{suite.steps} steps"
    yield f"{plural(count, 'scenario')} with their protocols ({', '.join(suite.protocols)}); the horizon is {horizon}."
    full = f", {suite.seeds.full} with `--full`" if suite.seeds.full else ""
    yield f"Seeds from {suite.seeds.first:,} on: {suite.seeds.count}{full}."
    if suite.perturb:
        yield f"Each seed changes the scenes: {'; '.join(perturbation_text(item) for item in suite.perturb)}."


def _policies(policies: Mapping[str, str | dict[str, Any]]) -> Iterator[tuple[str, str, str]]:
    for name, given in policies.items():
        text = behavior_text(given)
        yield f"`{name}`", f"`{text}`", open_policy(text).knowledge() or "what the scenarios say"


def _threats(suite: Suite, scenes: Mapping[str, ResolvedScenario]) -> Iterator[str]:
    """Assumptions behind the numbers, and their limits."""
    for sentence in assumptions_of(scenes):
        yield f"{sentence[:1].upper()}{sentence[1:]}."
    if len({scene.world.step_time for scene in scenes.values()}) == 1 and "step" not in scenes:
        yield "There is one period only: a policy may rely on it."
    if suite.seeds.first < 30_000:
        yield "Options of policies were chosen beside these scenes, and some of their seeds were looked at."
    yield "Scenes are synthetic: how real people move is not part of it."
    yield "Policies of different classes of information compete with unequal means."
