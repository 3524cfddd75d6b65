"""Charts of a benchmark as SVG: success against density, distributions of metrics, paired differences."""

from __future__ import annotations

import io
import re
import statistics
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from irsim.benchmarks.report.rows import families, policy_labels, protocols, series
from irsim.benchmarks.summary import is_summary
from irsim.common.text import clean, escape_marks
from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, EpisodeRow

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["charts"]

COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#F0E442", "#7F7F7F")
"""Colors of the policies (Okabe and Ito), which people with color vision deficiencies can tell apart."""
_DISTRIBUTIONS = (("time_to_goal", "time to goal [s]"), ("min_clearance", "smallest clearance [m]"))
_MAX_CATEGORIES = 24


def charts(result: BenchmarkResult) -> list[tuple[str, str]]:
    """Caption and SVG of each chart."""
    made = [
        (f"Success of {family} under the protocol {protocol}, with 95 % intervals",
         _drawn(lambda ax, scenes=scenes: _against(ax, result, scenes)))
        for family, protocol, scenes in families(result)
    ]  # fmt: skip
    for key, heading in _DISTRIBUTIONS:
        for protocol, names in protocols(result).items():
            chosen = [e for e in result.episodes if e.scenario in names and e.metrics.get(key) is not None]
            if chosen:
                which = f"under the protocol {protocol}: " if protocol else ""
                made.append(
                    (f"Episodes of all scenarios{' ' if which else ': '}{which}{heading}",
                     _drawn(lambda ax, key=key, heading=heading, chosen=chosen:
                            _distribution(ax, policy_labels(result), chosen, key, heading)))
                )  # fmt: skip
    if any(row.paired for row in result.rows):
        first = policy_labels(result)[result.behaviors[0]]
        made.append((f"Success minus success of {first} with the same seeds", _drawn(lambda ax: _paired(ax, result))))
    return made


def _drawn(draw: Any) -> str:
    """A chart as SVG without a date and with the same names of its parts every time.

    Parts whose name is made by :func:`_tip` have a title, which a pointer shows. Black parts have the colour of text.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    # names are text, never formulas between dollar signs
    settings: dict[Any, Any] = {
        "svg.hashsalt": "irsim",
        "svg.fonttype": "none",
        "font.size": 9,
        "text.parse_math": False,
    }
    with matplotlib.rc_context(settings):
        figure = Figure(figsize=(6.4, 3.4), layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure.add_subplot())
        target = io.StringIO()
        figure.savefig(target, format="svg", metadata={"Date": None, "Creator": None}, transparent=True)
    text = escape_marks(target.getvalue())
    text = re.sub(rf'<g id="{_TIP}([^"]*)">', r"<g><title>\1</title>", text).replace("#000000", "currentColor")
    return text[text.index("<svg") :]


_TIP = "tip: "
"""Beginning of the names of parts that have a title."""


def _tip(text: str) -> str:
    """The name of a part of a chart that has a title."""
    return _TIP + clean(text, 300).replace('"', "'")


def _percent(rate: float, low: float | None, high: float | None) -> str:
    """A share with its interval."""
    return f"{rate:.0%}" if low is None or high is None else f"{rate:.0%} ({low:.0%} to {high:.0%})"


def _against(ax: Axes, result: BenchmarkResult, scenes: Sequence[tuple[Any, str]]) -> None:
    """Success against the values that vary, one line for each policy."""
    ticks = [", ".join(str(value) for value in values.values()) for values, _ in scenes]
    for place, (behavior, label) in enumerate(policy_labels(result).items()):
        rows = series(result, [name for _, name in scenes], behavior)
        xs, color = range(len(rows)), COLORS[place % len(COLORS)]
        ax.plot(xs, [row.success.rate for row in rows], marker="o", markersize=4, label=label, color=color)
        for x, row in zip(xs, rows, strict=True):
            share = _percent(row.success.rate, row.success.low, row.success.high)
            tip = _tip(f"{row.scenario}, {label}: success {share}")
            ax.plot([x], [row.success.rate], marker="o", markersize=7, color=color, gid=tip)
        low = [row.success.rate if row.success.low is None else row.success.low for row in rows]
        high = [row.success.rate if row.success.high is None else row.success.high for row in rows]
        ax.fill_between(xs, low, high, alpha=0.15, color=color, linewidth=0)
    ax.set_xticks(range(len(ticks)), ticks, rotation=0 if len(ticks) < _MAX_CATEGORIES // 2 else 60)
    ax.set_xlabel(", ".join(scenes[0][0]))
    ax.set_ylabel("success")
    ax.set_ylim(-0.03, 1.03)
    _name_policies(ax)


def _distribution(ax: Axes, labels: dict[str, str], episodes: Sequence[EpisodeRow], key: str, heading: str) -> None:
    """Boxes of a metric, one for each policy."""
    values = [
        [v for e in episodes if e.behavior == behavior and (v := e.metrics.get(key)) is not None] for behavior in labels
    ]
    import matplotlib

    newer = matplotlib.__version_info__ >= (3, 10)
    sideways: dict[str, Any] = {"orientation": "horizontal"} if newer else {"vert": False}
    boxes = ax.boxplot(values, **sideways, widths=0.6, whis=(0, 100), patch_artist=True)
    for place, box in enumerate(boxes["boxes"]):
        box.set_facecolor(COLORS[place % len(COLORS)])
        label, own = list(labels.values())[place], values[place]
        middle = f"median {statistics.median(own):.2f}, {min(own):.2f} to {max(own):.2f}" if own else "no value"
        box.set_gid(_tip(f"{label}, {heading}: {middle} ({len(own)} episodes)"))
        box.set_alpha(0.6)
    for line in boxes["medians"]:
        line.set_color("black")
    ax.set_yticks(
        range(1, len(labels) + 1), [f"{name} ({len(v)})" for name, v in zip(labels.values(), values, strict=True)]
    )
    ax.invert_yaxis()
    ax.set_xlabel(heading)


def _paired(ax: Axes, result: BenchmarkResult) -> None:
    """Paired differences of success, with their intervals."""
    labels = policy_labels(result)
    rows = [row for row in result.rows if row.paired and not is_summary(row.scenario)][: 3 * _MAX_CATEGORIES]
    scenes = list(dict.fromkeys(row.scenario for row in rows))
    others = [behavior for behavior in labels if behavior != result.behaviors[0]]
    step = 0.7 / max(1, len(others))
    for place, behavior in enumerate(others):
        own = {row.scenario: row for row in rows if row.behavior == behavior}
        at = [k + (place - (len(others) - 1) / 2) * step for k, name in enumerate(scenes) if name in own]
        points = [_difference(own[name]) for name in scenes if name in own]
        color = COLORS[list(labels).index(behavior) % len(COLORS)]
        ax.errorbar(
            [mean for mean, _, _ in points], at, xerr=[[m - a for m, a, _ in points], [b - m for m, _, b in points]],
            fmt="o", markersize=4, color=color, label=labels[behavior], capsize=2, linewidth=1,
        )  # fmt: skip
        for y, name, (mean, low, high) in zip(at, [n for n in scenes if n in own], points, strict=True):
            tip = _tip(f"{name}, {labels[behavior]}: {mean:+.2f} ({low:+.2f} to {high:+.2f})")
            ax.plot([mean], [y], marker="o", markersize=7, color=color, gid=tip)
    ax.axvline(0, color="grey", linewidth=0.8)
    ax.set_yticks(range(len(scenes)), scenes, fontsize=7)
    ax.set_ylim(len(scenes) - 0.5, -0.5)  # the first one on top
    ax.set_xlabel("difference of success")
    _name_policies(ax)


def _name_policies(ax: Axes) -> None:
    """The names of the policies above the chart, where they hide nothing."""
    figure: Any = ax.figure
    figure.legend(loc="outside upper center", ncols=4, frameon=False)


def _difference(row: BenchmarkRow) -> tuple[float, float, float]:
    difference = row.paired["success"]
    mean = difference.mean or 0.0
    return (
        mean,
        mean if difference.low is None else difference.low,
        mean if difference.high is None else difference.high,
    )
