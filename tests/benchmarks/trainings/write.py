"""Measures the trainings: ``python -m tests.benchmarks.trainings.write [NAME …]`` writes their page.

Each NAME is a key of ``RECIPES``, whose episodes are run. Without one, the page is written from the kept outcomes.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import fmean, stdev
from typing import NamedTuple

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite import Protocol
from irsim.benchmarks.suite_plan import suite_plan
from irsim.common.hashing import file_digest
from irsim.metrics.statistics import bootstrap, wilson
from irsim.policies.networks.opening import open_network
from irsim.results.benchmark import EpisodeRow
from tests.benchmarks.trainings.train import RECIPES, SEEDS, weights_of

__all__ = ["OUTCOMES", "PAGE", "Kept", "kept_outcomes", "lines_of", "page", "plan_of"]

PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-benchmark" / "results" / "trainings.md"
OUTCOMES = Path(__file__).with_name("outcomes.csv")
PROTOCOLS: dict[str, Protocol] = {"multi_robot": "yield", "multi_robot_freeze": "freeze", "sarl_multi_robot": "freeze"}
"""Name of a recipe -> the protocol that its task trains for, and that its policies are measured under."""
EPISODES = range(30_000, 30_100)
_SHIPPED = "shipped"
_HEAD = ("policy", "training", "robots", "outcomes")
TRAINED = PAGE.parents[3] / "irsim" / "policies" / "trained"
_LETTERS = {"success": "s", "collision": "c", "timeout": "t"}
_STUDENT = {2: 12.706, 3: 4.303, 4: 3.182, 5: 2.776}
"""Number of trainings -> the 97.5 % quantile of Student's t with one degree of freedom less."""
_ABOUT = """\
# How much of a result is the training

<!-- Written by `python -m tests.benchmarks.trainings.write`: do not edit. -->

The tables of policies that learn show one training of each. Here a recipe was trained several times, once for each seed
in the head of its table, as `python -m tests.benchmarks.trainings.train NAME SEED FOLDER` does. Each training keeps its
best round by the validation seeds of its task (900,000 and above). All are measured in `random_polygons_v1` under the
protocol that they were trained for, with the seeds 30,000 to 30,099. The authors say that no choice has used these, and
no file can show it. *Shipped* is the policy of that name that comes with irsim, from an earlier training with seed 0,
whose length differs. A training ends after the round in which it reaches its steps, so the kept round may lie behind
them.

Shares of successes in %. *Between trainings* is the standard deviation of these shares, and the interval of their mean
by Student's t. *Between episodes* is the interval of the same mean when the 100 scenes are resampled and the trainings
are kept. Both intervals are 95 %. Few trainings make the first one wide. Equal shares give it no width, and it is left
out. Where all scenes ended alike, the second one is Wilson's for the 100 scenes.
"""


class Kept(NamedTuple):
    """The episodes of one training with one number of robots.

    Attributes:
        policy: Name of the recipe.
        training: Seed of the training, or ``shipped``.
        robots: Number of robots.
        outcomes: A letter for each seed of ``EPISODES``: s, c or t.
    """

    policy: str
    training: str
    robots: int
    outcomes: str


def plan_of(name: str, seeds: Sequence[int] = EPISODES) -> Plan:
    """The episodes of the trainings of one recipe whose weights are there, and of the policy that is shipped."""
    policies = [name, *(str(weights_of(name, seed)) for seed in SEEDS if weights_of(name, seed).is_file())]
    return suite_plan("random_polygons_v1", policies=policies, protocols=[PROTOCOLS[name]], seeds=list(seeds))


def lines_of(name: str, plan: Plan, episodes: Sequence[EpisodeRow]) -> list[Kept]:
    """The outcomes of a plan's episodes, in the order of its policies and scenarios."""
    made = {(one.behavior, one.scenario, one.seed): _LETTERS[one.outcome] for one in episodes}
    lines = []
    for label, text in plan.policies.items():
        training = _SHIPPED if label == name else Path(label).stem.rpartition("-")[2]
        for scenario in plan.scenarios:
            robots = int(scenario.name.partition("/")[0].partition("-")[2])
            letters = "".join(made[text, scenario.name, seed] for seed in plan.seeds)
            lines.append(Kept(name, training, robots, letters))
    return lines


def kept_outcomes() -> list[Kept]:
    """The outcomes that are kept."""
    with OUTCOMES.open(encoding="utf-8") as file:
        return [
            Kept(row["policy"], row["training"], int(row["robots"]), row["outcomes"]) for row in csv.DictReader(file)
        ]


def page(lines: Sequence[Kept]) -> str:
    """The page of these outcomes."""
    text = [_ABOUT]
    for name in (name for name in RECIPES if any(one.policy == name for one in lines)):
        mine = [one for one in lines if one.policy == name]
        trainings = [one.training for one in mine if one.robots == mine[0].robots and one.training != _SHIPPED]
        text += [f"## `{name}`, {PROTOCOLS[name]}", "", f"`irsim train {name} --seed SEED {RECIPES[name]}`", ""]
        heads = ["robots", *(f"seed {seed}" for seed in trainings), "mean", "between trainings", "between episodes"]
        text += [f"| {' | '.join([*heads, 'collisions', 'shipped'])} |", "|---" * (len(heads) + 2) + "|"]
        text += [_row(robots, mine) for robots in dict.fromkeys(one.robots for one in mine)]
        digests = [f"seed {seed} `{file_digest(weights_of(name, int(seed)))[:12]}`" for seed in trainings]
        lengths = [f"seed {seed} {_decisions(weights_of(name, int(seed)))}" for seed in trainings]
        lengths.append(f"shipped {_decisions(TRAINED / f'{name}.npz')}")
        text += ["", f"Decisions until the round that was kept: {', '.join(lengths)}.", ""]
        text += [f"SHA-256 of the weights begin with {', '.join(digests)}.", ""]
    where = OUTCOMES.relative_to(PAGE.parents[3]).as_posix()
    text += [
        f"All outcomes: `{where}` of the repository, SHA-256 `{file_digest(OUTCOMES)}`. The weights lie beside it."
    ]
    return "\n".join(text) + "\n"


def _decisions(weights: Path) -> str:
    return f"{open_network(weights).head.card.steps:,}"


def _row(robots: int, lines: Sequence[Kept]) -> str:
    trained = [one.outcomes for one in lines if one.robots == robots and one.training != _SHIPPED]
    [shipped] = [one.outcomes for one in lines if one.robots == robots and one.training == _SHIPPED]
    shares = [_share(outcomes, "s") for outcomes in trained]
    mean, apart = fmean(shares), stdev(shares)
    reach = _STUDENT[len(shares)] * apart / math.sqrt(len(shares))
    scenes = [fmean(letter == "s" for letter in scene) for scene in zip(*trained, strict=True)]
    low, high = bootstrap(scenes) if len(set(scenes)) > 1 else wilson(round(sum(scenes)), len(scenes))
    between = f" [{max(0.0, mean - reach):.0f}, {min(100.0, mean + reach):.0f}]" if apart else ""
    return (
        f"| {robots} | {' | '.join(f'{share:.0f}' for share in shares)} | {mean:.1f} | {apart:.1f}{between} "
        f"| [{100 * low:.0f}, {100 * high:.0f}] "
        f"| {fmean(_share(outcomes, 'c') for outcomes in trained):.1f} | {_share(shipped, 's'):.0f} |"
    )


def _share(outcomes: str, letter: str) -> float:
    return 100 * outcomes.count(letter) / len(outcomes)


def main(names: Sequence[str]) -> None:
    """Run the episodes of these recipes, keep their outcomes, and write the page."""
    lines = [one for one in kept_outcomes() if one.policy not in names] if OUTCOMES.exists() else []
    for name in names:
        plan = plan_of(name)
        lines += lines_of(name, plan, measure_plan(plan).episodes)
    lines.sort(key=lambda one: list(RECIPES).index(one.policy))
    rows = [",".join(map(str, row)) for row in (_HEAD, *lines)]
    OUTCOMES.write_text("\n".join(rows) + "\n", encoding="utf-8")
    PAGE.write_text(page(lines), encoding="utf-8")
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main(sys.argv[1:])
