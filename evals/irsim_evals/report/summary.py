"""Numbers of a report: pass rates with intervals, the funnel, tables by category and level, pass^k, cost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from irsim_evals.grader.outcome import STAGES
from irsim_evals.results import Trial
from irsim_evals.statistics import Interval, mean_pass_hat_k, wilson

__all__ = ["ArmSummary", "Cell", "CostSummary", "Table", "arms_of", "attempts", "quantities", "summarize", "table_by"]

MAX_COST = 1e15
"""Numbers of a cost from which on they are damaged, and are left out."""
_MAX_K = 10
"""Greatest number of attempts for which pass^k is shown."""


@dataclass(frozen=True)
class Cell:
    """Passed attempts of all attempts."""

    passed: int
    total: int

    @property
    def share(self) -> float:
        """Share of passes; NaN without attempts."""
        return self.passed / self.total if self.total else math.nan


Table = list[tuple[str, list[Cell]]]
"""Passes: name of a row, and its cell of each arm in the order of the arms."""


@dataclass(frozen=True)
class CostSummary:
    """Cost of an arm, as far as its trials say so.

    Attributes:
        known: Number of trials whose cost is known.
        totals: Name of a quantity → its sum over these trials.
        per_pass: Name of a quantity → its sum over these trials by the number of them that passed; None without a pass.
    """

    known: int
    totals: dict[str, float]
    per_pass: dict[str, float | None]


@dataclass(frozen=True)
class ArmSummary:
    """One arm in numbers.

    Attributes:
        arm: Its name.
        models: Names of the models that answered.
        cases: Number of cases; two instances of a case count as two.
        trials: Passed attempts of all attempts.
        strict: Mean share of attempts that pass, over cases, with Wilson's interval.
        rate: Mean share of the assertions that hold, over cases, with Wilson's interval.
        funnel: Stage → share of the attempts in which nothing failed up to it.
        pass_hat: k → mean chance that k attempts at one case all pass.
        cost: Its cost.
    """

    arm: str
    models: list[str]
    cases: int
    trials: Cell
    strict: Interval
    rate: Interval
    funnel: dict[str, Cell]
    pass_hat: dict[int, float] = field(default_factory=dict)
    cost: CostSummary = field(default_factory=lambda: CostSummary(0, {}, {}))


def arms_of(trials: Iterable[Trial]) -> list[str]:
    """Names of the arms in the order in which they occur."""
    return list(dict.fromkeys(trial.arm for trial in trials))


def attempts(trials: Iterable[Trial]) -> dict[tuple[str, str], list[Trial]]:
    """Case and instance → attempts at it."""
    by_key: dict[tuple[str, str], list[Trial]] = {}
    for trial in trials:
        by_key.setdefault(trial.key, []).append(trial)
    return by_key


def summarize(trials: Sequence[Trial], arm: str) -> ArmSummary:
    """One arm in numbers, from the trials of all arms.

    Wilson's interval is computed with the number of cases as the number of observations: several attempts at one case
    count as one observation, and a share between 0 and 1 varies less than a plain pass or failure would. So the
    intervals are rather too wide than too narrow.
    """
    own = [trial for trial in trials if trial.arm == arm]
    by_case = attempts(own)
    counts = [(sum(t.verdict.strict for t in group), len(group)) for group in by_case.values()]
    rates = [math.fsum(t.verdict.rate for t in group) / len(group) for group in by_case.values()]
    most = min(max((total for _, total in counts), default=0), _MAX_K)
    return ArmSummary(
        arm=arm, models=sorted({trial.model for trial in own if trial.model}), cases=len(by_case),
        trials=Cell(sum(passed for passed, _ in counts), len(own)), rate=_mean_interval(rates), funnel=_funnel(own),
        strict=_mean_interval([passed / total for passed, total in counts]), cost=_cost(own),
        pass_hat={k: mean_pass_hat_k(counts, k) for k in range(1, most + 1)},
    )  # fmt: skip


def table_by(trials: Sequence[Trial], arms: Sequence[str], names: Callable[[Trial], Iterable[str]]) -> Table:
    """Passes of each arm in rows; ``names`` gives the rows that a trial belongs to."""
    by_row: dict[str, dict[str, list[bool]]] = {}
    for trial in trials:
        for name in names(trial):
            by_row.setdefault(name, {}).setdefault(trial.arm, []).append(trial.verdict.strict)
    passes = [(name, [by_row[name].get(arm, []) for arm in arms]) for name in sorted(by_row)]
    return [(name, [Cell(sum(one), len(one)) for one in cells]) for name, cells in passes]


def _mean_interval(values: Sequence[float]) -> Interval:
    return wilson(min(math.fsum(values), float(len(values))), len(values))


def _funnel(trials: Sequence[Trial]) -> dict[str, Cell]:
    """How many attempts have no failure up to each stage."""
    reached = [len(STAGES) if t.verdict.strict else STAGES.index(t.verdict.reached) for t in trials]
    return {stage: Cell(sum(one > place for one in reached), len(trials)) for place, stage in enumerate(STAGES)}


def _cost(trials: Sequence[Trial]) -> CostSummary:
    known = [(trial, costs) for trial in trials if (costs := quantities(trial))]
    passed = sum(trial.verdict.strict for trial, _ in known)
    totals: dict[str, float] = {}
    for _, costs in known:
        for name, value in costs.items():
            totals[name] = totals.get(name, 0) + value
    return CostSummary(len(known), totals, {k: v / passed if passed else None for k, v in totals.items()})


def quantities(trial: Trial) -> dict[str, float]:
    """The numbers among the fields of a cost."""
    fields = trial.verdict.cost.model_dump()
    return {k: v for k, v in fields.items() if isinstance(v, (int, float)) and abs(v) < MAX_COST}
