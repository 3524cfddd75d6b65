"""Two sets of trials, paired by case and instance: what changed, and whether the difference means anything."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from irsim_evals.grader.outcome import name_of
from irsim_evals.report.summary import MAX_COST, attempts
from irsim_evals.results import Trial
from irsim_evals.statistics import Interval, mcnemar, paired_bootstrap, sign_flip

__all__ = ["Change", "Comparison", "CostDifference", "compare", "smallest_difference"]

_LEVEL = 0.05
"""A p value below this counts as a difference."""
_Z_TEST, _Z_POWER = 1.959963984540054, 0.8416212335729143
"""Quantiles of the normal distribution for a two-sided test at 5 % and for a chance of 80 % to notice a difference."""
_UNITS = ("calls", "tokens")
"""Costs that are compared."""
_USUAL_SHARE = 0.1
"""Share of cases that is expected to change at least, where fewer did."""


@dataclass(frozen=True)
class Change:
    """A case with another result.

    Attributes:
        case, instance: The case.
        title: Its subject.
        before, after: Share of the attempts that passed.
        reason: First assertion that does not hold in the set in which the case fails.
    """

    case: str
    instance: str
    title: str
    before: float
    after: float
    reason: str

    @property
    def name(self) -> str:
        """Case and instance as one name."""
        return name_of(self.case, self.instance)


@dataclass(frozen=True)
class CostDifference:
    """How much more or less the second set needs.

    Attributes:
        unit: Unit of the cost: calls or tokens.
        pairs: Number of cases whose cost both know.
        before, after: Mean of a case in the first and in the second set.
        difference: Mean difference with its 95 % interval, drawn by family.
        p: p value of a permutation test, by family.
    """

    unit: str
    pairs: int
    before: float
    after: float
    difference: Interval
    p: float

    @property
    def means_something(self) -> bool:
        """Whether the difference is hardly chance."""
        return _hardly_chance(self.p, self.difference)

    def sentence(self, name: str) -> str:
        """The result in words for a name of the second set: ``B needs 1.2 calls fewer a case (95 %: 0.4 to 2.1)``."""
        by, low, high = self.difference
        means = f"{_short(self.before)} before, {_short(self.after)} now, {self.pairs} cases"
        if not self.means_something:
            words = f"No difference in {self.unit} that chance would not explain"
            return f"{words} (95 %: {_signed(low)} to {_signed(high)} a case; {means})."
        low, high = sorted((abs(low), abs(high)))
        word = f"{self.unit} {'more' if by > 0 else 'fewer'}"
        return f"{name} needs {_short(abs(by))} {word} a case (95 %: {_short(low)} to {_short(high)}; {means})."


@dataclass(frozen=True)
class Comparison:
    """Two sets of trials.

    Attributes:
        first, second: Their names.
        pairs: Number of cases that both have.
        passed: How many of these each passes; a case passes if more than half of the attempts at it do.
        fixed, broken: Cases that only the second passes, and that only the first passes.
        missing, new: Cases that only the first has, and that only the second has.
        p: Exact p value of McNemar's test.
        difference: Mean difference of the shares of passes with its 95 % interval, drawn by family.
        smallest_difference: The one that this number of cases shows with a chance of 80 %; None if they show none.
        costs: Differences in calls and tokens, as far as both sets know them.
        repeated: Whether there are several attempts at a case.
    """

    first: str
    second: str
    pairs: int
    passed: tuple[int, int]
    fixed: list[Change]
    broken: list[Change]
    missing: list[str]
    new: list[str]
    p: float
    difference: Interval
    smallest_difference: float | None
    costs: list[CostDifference]
    repeated: bool = False

    @property
    def means_something(self) -> bool:
        """Whether the difference is hardly chance: a small p value, and an interval without 0."""
        return _hardly_chance(self.p, self.difference)

    @property
    def sentences(self) -> list[str]:
        """The result in words: passes, and then what answers cost."""
        return [self.sentence, *(cost.sentence(self.second) for cost in self.costs)]

    @property
    def sentence(self) -> str:
        """The result, in words."""
        if not self.pairs:
            return f"{self.first} and {self.second} have no case in common, so nothing can be compared."
        a, b = self.passed
        points, low, high = (f"{100 * value:+.0f}" for value in self.difference)
        unit = "points of the attempts" if self.repeated else "points"
        counts = (
            f"{self.second} passes {b} of {self.pairs} cases and {self.first} {a} "
            f"({points} {unit}, 95 % interval {low} to {high}, p = {self.p:.2g})"
        )
        if self.means_something:
            verdict = "the difference is hardly chance"
        elif not self.fixed and not self.broken:
            verdict = "no case changed"
        else:
            verdict = "no difference that chance would not explain"
        apart = len(self.missing) + len(self.new)
        if apart:
            verdict += f"; {apart} {'case is' if apart == 1 else 'cases are'} left out, which only one of them has"
        smallest = self.smallest_difference
        if smallest is None:
            return f"{counts}: {verdict}. {self.pairs} cases are too few to show any difference."
        return f"{counts}: {verdict}. {self.pairs} cases would show a difference of {100 * smallest:.0f} points."


def compare(before: Sequence[Trial], after: Sequence[Trial], first: str, second: str) -> Comparison:
    """Compare two sets of trials, each of one arm, which are called ``first`` and ``second``."""
    one, two = attempts(before), attempts(after)
    common = sorted(set(one) & set(two))
    fixed: list[Change] = []
    broken: list[Change] = []
    shares = [(_share(one[key]), _share(two[key])) for key in common]
    differences: dict[str, list[float]] = {}
    for key, (a, b) in zip(common, shares, strict=True):
        differences.setdefault(one[key][0].family, []).append(b - a)
        if (a > 0.5) != (b > 0.5):
            change = Change(*key, one[key][0].title, a, b, _reason(two[key] if a > 0.5 else one[key]))
            (broken if a > 0.5 else fixed).append(change)
    changed = len(fixed) + len(broken)
    return Comparison(
        first=first, second=second, pairs=len(common), fixed=fixed, broken=broken, p=mcnemar(len(broken), len(fixed)),
        passed=(sum(a > 0.5 for a, _ in shares), sum(b > 0.5 for _, b in shares)),
        missing=sorted(name_of(*key) for key in set(one) - set(two)),
        new=sorted(name_of(*key) for key in set(two) - set(one)),
        difference=paired_bootstrap(differences),
        smallest_difference=smallest_difference(len(common), changed / len(common) if common else 0.0),
        costs=[cost for unit in _UNITS if (cost := _cost(unit, [(one[key], two[key]) for key in common])) is not None],
        repeated=any(len(side[key]) > 1 for side in (one, two) for key in common),
    )  # fmt: skip


def _cost(unit: str, pairs: Sequence[tuple[Sequence[Trial], Sequence[Trial]]]) -> CostDifference | None:
    """The difference in calls or tokens; None if no case has them in both sets, or all are 0."""
    means = [(_mean_cost(unit, a), _mean_cost(unit, b), a[0].family) for a, b in pairs]
    known = [(a, b, family) for a, b, family in means if a is not None and b is not None]
    differences: dict[str, list[float]] = {}
    for a, b, family in known:
        differences.setdefault(family, []).append(b - a)
    before, after = [a for a, _, _ in known], [b for _, b, _ in known]
    if not any(before + after):
        return None
    return CostDifference(
        unit, len(known), math.fsum(before) / len(known), math.fsum(after) / len(known),
        paired_bootstrap(differences), sign_flip(differences),
    )  # fmt: skip


def _mean_cost(unit: str, trials: Sequence[Trial]) -> float | None:
    values = [getattr(trial.verdict.cost, unit) for trial in trials]
    known = [value for value in values if value is not None and value < MAX_COST]
    return math.fsum(known) / len(known) if known else None


def _hardly_chance(p: float, difference: Interval) -> bool:
    return p < _LEVEL and (difference.low > 0 or difference.high < 0)


def _short(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.1f}"


def _signed(value: float) -> str:
    return f"{'+' if value > 0 else ''}{_short(value)}"


def smallest_difference(pairs: int, changing: float) -> float | None:
    """Smallest difference of two pass rates that McNemar's test at 5 % notices with a chance of 80 %.

    Args:
        pairs: Number of cases that both answered; the answer is None if they are too few for any difference.
        changing: Share of the cases of which only one of both passes; a tenth where it is smaller.

    References:
        Connor: Sample size for testing differences in proportions for the paired-sample design (1987).
    """
    fewest = math.ceil(math.log2(2 / _LEVEL))  # with fewer changes, all in one direction, p is above the level
    if pairs < fewest:
        return None
    for step in range(1, 1001):
        difference = step / 1000
        share = max(changing, _USUAL_SHARE, difference)
        spread = _Z_TEST * math.sqrt(share) + _Z_POWER * math.sqrt(share - difference**2)
        if pairs * difference**2 >= spread**2 and pairs * share >= fewest:
            return difference
    return None


def _share(trials: Sequence[Trial]) -> float:
    return sum(trial.verdict.strict for trial in trials) / len(trials)


def _reason(trials: Sequence[Trial]) -> str:
    failed = next((one for trial in trials for one in trial.verdict.failed()), None)
    return "" if failed is None else f"{failed.assertion}: expected {failed.expected}; observed {failed.observed}"
