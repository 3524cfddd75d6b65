"""The kept result of ``mixed_v2``: its episodes by role, and the page, which is made from these lines alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.summary import estimates
from irsim.results.benchmark import EpisodeRow, Estimate

__all__ = ["HEAD", "page", "values_by_role"]

_ROLES = ("probe", "crowd")
_KEYS = ("success", "collision", "timeout", "time_to_goal")
HEAD = ("scenario", "policy", "seed", "outcome", "steps", *(f"{role}_{key}" for role in _ROLES for key in _KEYS))
"""The head of the file of episodes."""
_SHARES = ("success", "collision", "timeout")
_TITLES = {"one": "One robot among nine", "half": "Five robots among five"}
_ABOUT = (
    "Each row is a policy, each column says what the others follow. `people` are round bodies of radius 0.25 m that "
    "move freely and follow `sfm` at up to 1 m/s; all others are the bodies of `random_polygons_v2`, with limited "
    "acceleration. A robot that touches another stops for good, and the episode goes on. Robots that have arrived make "
    "room. Shares are of the robots of a role, where each episode counts once; intervals are 95 %: Wilson's for one "
    "robot, else bootstrap over episodes. Where all robots of all episodes do the same, a bootstrap has no spread, and "
    "the interval is Wilson's for as many episodes."
)
_SHOWN = """\
- `orca` and `avocado`, alone in any of the seven crowds, arrive in all 210 episodes. `footprint_orca`, which touches
  nothing among its own, is in a contact in 3 of 210: among `orca`, `sarl_multi_robot` and `ppo`.
- The networks were trained without limits of acceleration and among robots of their own. As one robot `ppo` does worst
  among its own (77 %); as half of the robots it does worst among people (83 %). The same five robots of a crowd of
  `ppo` succeed in 79 % beside five of `ppo`, and in 87 to 89 % beside five of any other policy.
- Five robots with a planner (`orca`, `avocado`, `footprint_orca`) all succeed among five with another planner, and
  in 97 to 100 % among networks and people.
- Compare within a role: the two halves differ even where all follow one policy, as `sarl_multi_robot` (97 and 90 %).
- 30 episodes tell little about one robot: 30 of 30 is 89 to 100 %, and columns have the same seeds, so compare pairs
  of episodes (`scripts/verdict.py`) before you say that they differ. `irsim benchmark mixed_v2 --full` runs 300."""
_OF_PROBE = (
    "Of the policy in the row: success with its interval / collision / timeout in %, and the mean time of robots that "
    "arrived."
)
_OF_CROWD = "Of the others, beside it: success / collision / timeout in %."
_MEANS = (
    "success, one",
    "collision, one",
    "success, half",
    "collision, half",
    "others succeed beside one",
    "beside half",
)


def values_by_role(episode: EpisodeRow) -> list[float | None]:
    """The metrics of both roles, in the order of the head."""
    return [episode.roles.get(role, {}).get(key) for role in _ROLES for key in _KEYS]


class _Cells:
    """Estimates of the cells of the tables.

    Args:
        rows: The lines of the kept file.
    """

    def __init__(self, rows: Sequence[Mapping[str, str]]) -> None:
        self.policies = list(dict.fromkeys(row["policy"] for row in rows))
        self.crowds = list(dict.fromkeys(row["scenario"].partition("-")[2] for row in rows))
        self._values: dict[tuple[str, str], dict[str, list[float | None]]] = {}
        for row in rows:
            if row["outcome"] == "placement-crowded":
                continue
            cell = self._values.setdefault((row["scenario"], row["policy"]), {key: [] for key in HEAD[5:]})
            for key, values in cell.items():
                values.append(float(row[key]) if row[key] else None)

    def of(self, kind: str, crowd: str, policy: str, role: str) -> dict[str, Estimate]:
        """Estimates of a role by key."""
        columns = {key: self._values[f"{kind}-{crowd}", policy][f"{role}_{key}"] for key in _KEYS}
        alone = kind == "one" and role == "probe"
        shares = [key for key in _SHARES if alone or set(columns[key]) in ({0.0}, {1.0})]
        return estimates(columns, shares)

    def mean(self, kind: str, policy: str, role: str, key: str) -> float:
        """Mean over the crowds, in %."""
        means = [self.of(kind, crowd, policy, role)[key].mean or 0.0 for crowd in self.crowds]
        return 100 * math.fsum(means) / len(means)


def page(rows: Sequence[Mapping[str, str]], plan: Plan) -> str:
    """The page of the kept result.

    Args:
        rows: The lines of the kept file.
        plan: The plan that was run.
    """
    assert plan.suite is not None
    cells = _Cells(rows)
    hashes = f"suite hash {plan.suite_hash}, run hash {plan.hash}"
    size = f"{len(rows):,} episodes, {len(plan.seeds)} seeds from {plan.seeds[0]:,} on"
    again = f"`{plan.reproduce}` runs it, in less than 10 minutes on one core; the tests run a part of it again."
    lines = ["# mixed_v2: one policy among robots that follow another", ""]
    lines += [f"Suite version {plan.suite.version}, {hashes}; {size}. {again}"]
    lines += ["[Protocol](../references/protocol_mixed_v2.md).", "", _ABOUT]
    for kind, title in _TITLES.items():
        probes = _table(cells, lambda policy, crowd, kind=kind: _probe(cells.of(kind, crowd, policy, "probe")))
        crowds = _table(cells, lambda policy, crowd, kind=kind: _shares(cells.of(kind, crowd, policy, "crowd")))
        lines += ["", f"## {title}", "", _OF_PROBE, "", *probes, "", _OF_CROWD, "", *crowds]
    lines += ["", "## Means over the seven crowds", ""]
    lines += [f"| policy | {' | '.join(_MEANS)} |", "|---" * (len(_MEANS) + 1) + "|"]
    for policy in cells.policies:
        means = [cells.mean(kind, policy, "probe", key) for kind in _TITLES for key in ("success", "collision")]
        means += [cells.mean(kind, policy, "crowd", "success") for kind in _TITLES]
        lines.append(f"| `{policy}` | " + " | ".join(f"{mean:.1f} %" for mean in means) + " |")
    lines += ["", "## Findings", "", _SHOWN]
    return "\n".join(lines) + "\n"


def _table(cells: _Cells, cell: object) -> list[str]:
    assert callable(cell)
    lines = [
        f"| policy | {' | '.join(f'`{crowd}`' for crowd in cells.crowds)} |",
        "|---" * (len(cells.crowds) + 1) + "|",
    ]
    for policy in cells.policies:
        lines.append(f"| `{policy}` | " + " | ".join(cell(policy, crowd) for crowd in cells.crowds) + " |")
    return lines


def _shares(values: Mapping[str, Estimate]) -> str:
    return " / ".join(f"{100 * (values[key].mean or 0.0):.0f}" for key in _SHARES)


def _probe(values: Mapping[str, Estimate]) -> str:
    success, time = values["success"], values["time_to_goal"].mean
    first, others = _shares(values).split(" / ", 1)
    low, high = 100 * (success.low or 0.0), 100 * (success.high or 0.0)
    return f"{first} [{low:.0f}, {high:.0f}] / {others}" + ("" if time is None else f", {time:.1f} s")
