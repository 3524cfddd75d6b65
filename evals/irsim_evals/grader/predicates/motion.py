"""How bodies move in an episode: whether they arrive, how far, how fast and when they get where, what they explore."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from pydantic import model_validator

from irsim_evals.grader.matching import Kind, Match, Quantity, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, measured, register, summary
from irsim_evals.grader.predicates.encounters import edge_to_edge
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material

_MOTION: dict[str, Kind] = {
    "farthest": "length", "path": "length", "dx": "length", "dy": "length", "progress": "share", "fastest": "speed",
    "slowest": "speed", "turn": "rate", "standstill": "time",
}  # fmt: skip
"""Measures of how a body moves."""
_STATE: dict[str, Kind] = {
    "x": "length", "y": "length", "heading": "heading", "speed": "speed", "turn": "rate", "goal_distance": "length",
    "distance": "length",
}  # fmt: skip
"""Measures of where a body is."""
_STILL = 0.02
"""Speed [m/s] below which a body stands still."""


@register("arrive")
class Arrive(OfBodies, EpisodePredicate):
    """A share of the bodies of a selection arrives. An empty selection fails."""

    share: Match = Match(eq=1.0)
    """Accepted shares of bodies that arrive; 0 for a body that must not."""
    within: Quantity | None = None
    """Latest time [s]; default: the end of the episode."""
    or_near: Quantity | None = None
    """Ending at most this far from the goal [m] counts as well."""
    for_good: bool = False
    """Only who has no further goal counts: with a share of 0, bodies that go round or to random goals for ever."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at the arrivals."""
        bodies = self.bodies(material, episode.scene)
        end = episode.duration if self.within is None else self.within
        expected = f"share of {self.of} that arrive within {show(end)} s: {self.share.words()}"
        arrivals = []
        for body in bodies:
            time = episode.arrival(body.name)
            there = time is not None and time <= end + 1e-9
            if not there and self.or_near is not None and body.goal is not None:
                there = math.dist(episode.positions(body.index)[-1], body.goal[:2]) <= self.or_near
            there = there and not (self.for_good and (body.record.loop or body.record.wander))
            arrivals.append((body, there, "not" if time is None else f"after {time:.1f} s"))
        share = sum(there for _, there, _ in arrivals) / len(arrivals)
        wanted = self.share.eq != 0.0
        odd = [(body, text) for body, there, text in arrivals if there != wanted]
        seen = summary(odd or [(body, text) for body, _, text in arrivals])
        where = f"{(odd[0][0] if odd else bodies[0]).entry}.goal"
        return Observation(matches(self.share, share, "share"), expected, f"{share:.0%}; {seen}", where)


@register("moves")
class Moves(OfBodies, EpisodePredicate):
    """How every body of a selection moves in an episode, or in a part of it. An empty selection fails."""

    since: Quantity = 0.0
    """Begin of the part [s]; a negative time counts back from the end of the episode."""
    farthest: Match | None = None
    """Accepted values of the greatest distance from where it was at the begin [m]; 0 for a body that stays."""
    path: Match | None = None
    """Accepted lengths of the path driven [m]."""
    dx: Match | None = None
    """Accepted differences of x from begin to end [m]."""
    dy: Match | None = None
    """Accepted differences of y from begin to end [m]."""
    progress: Match | None = None
    """Accepted shares of the straight way from start to last goal at which it ends: 0 is the start, 1 the goal."""
    fastest: Match | None = None
    """Accepted values of the greatest speed along the heading [m/s]; of omnidirectional drives, in any direction."""
    slowest: Match | None = None
    """Accepted values of the smallest signed speed along the heading [m/s]; negative in reverse."""
    turn: Match | None = None
    """Accepted values of the greatest turn rate, to either side [rad/s]."""
    standstill: Match | None = None
    """Accepted values of the longest time for which it stands still, at less than 2 cm/s, turning or not [s]. The time
    before it comes into the world does not count, nor does that after it has arrived and has no further goal."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Measure the paths."""
        first = int(np.searchsorted(episode.trace.time, episode.moment(self.since) - 1e-9))
        bodies = material.bodies(episode.scene, self.of)
        return measured(self, self.of, bodies, _MOTION, partial(_motion, episode, first), "behavior")


def _motion(episode: GradedEpisode, first: int, body: GradedBody) -> dict[str, float | None]:
    """Measures of the motion of a body from a row of the trace on, while it is in the world."""
    way, along, everywhere, turn = (
        values[first:][~np.isnan(values[first:]).reshape(len(values[first:]), -1).any(axis=1)]
        for values in (episode.positions(body.index), *episode.velocities(body))
    )
    if not len(way):
        return dict.fromkeys(_MOTION)
    return {
        "farthest": float(np.hypot(*(way - way[0]).T).max()),
        "path": float(np.hypot(*np.diff(way, axis=0).T).sum()),
        "dx": float(way[-1, 0] - way[0, 0]),
        "dy": float(way[-1, 1] - way[0, 1]),
        "progress": _progress(body, way[-1]),
        "fastest": float(everywhere.max()) if along.size else 0.0,
        "slowest": float(along.min()) if along.size else 0.0,
        "turn": float(np.abs(turn).max(initial=0.0)),
        "standstill": _standstill(episode, first, body),
    }


def _standstill(episode: GradedEpisode, first: int, body: GradedBody) -> float:
    """The longest time for which a body stands still from a row of the trace on, before it has arrived for good [s]."""
    arrival = None if body.record.loop or body.record.wander else episode.arrival(body.name)
    end = len(episode.trace) if arrival is None else int(np.searchsorted(episode.trace.time, arrival + 1e-9))
    step = np.hypot(*np.diff(episode.positions(body.index)[first:end], axis=0).T)
    runs = "".join("#" if still else " " for still in step < _STILL * episode.trace.step_time).split()
    return max(map(len, runs), default=0) * episode.trace.step_time


def _progress(body: GradedBody, place: np.ndarray) -> float | None:
    """The share of the straight way to its last goal that a body has come; None without such a way."""
    if body.goal is None or math.dist(body.pose[:2], body.goal[:2]) == 0:
        return None
    start = np.array(body.pose[:2])
    way = np.array(body.goal[:2]) - start
    return float((place - start) @ way / (way @ way))


@register("state_at")
class StateAt(OfBodies, EpisodePredicate):
    """Where every body of a selection is at a time of an episode without noise, how it moves then, and how far others
    are from it. An empty selection fails."""

    exact = True

    at: Quantity
    """The time [s]; the next earlier step counts. A negative time counts back from the end of the episode."""
    x: Match | None = None
    """Accepted values of its x [m]."""
    y: Match | None = None
    """Accepted values of its y [m]."""
    heading: Match | None = None
    """Accepted headings [rad]."""
    speed: Match | None = None
    """Accepted speeds along its heading, negative in reverse, and of omnidirectional drives in any direction, measured
    over the step that ends then [m/s]. At the time 0 there is no speed."""
    turn: Match | None = None
    """Accepted turn rates, positive to the left, measured over the step that ends then [rad/s]."""
    goal_distance: Match | None = None
    """Accepted distances from its last goal [m]."""
    to: Selection | None = None
    """Name of the selection for `distance`."""
    distance: Match | None = None
    """Accepted distances to the nearest other body of the selection `to` in the world then, edge to edge [m]."""

    @model_validator(mode="after")
    def _both(self) -> StateAt:
        if (self.to is None) != (self.distance is None):
            raise ValueError("give both `to` and `distance`, or neither")
        return self

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at the row of the trace."""
        time = episode.moment(self.at)
        if not -1e-9 <= time <= episode.duration + 1e-9:
            return Observation(False, f"{self.of} at {time:g} s", f"the episode lasts {episode.duration:g} s")
        row = int(np.searchsorted(episode.trace.time, time + 1e-9, side="right")) - 1
        bodies = material.bodies(episode.scene, self.of)
        others = material.bodies(episode.scene, self.to) if self.to is not None else []
        of = f"{self.of} at {time:g} s" + (f" to {self.to}" if self.to is not None else "")
        return measured(self, of, bodies, _STATE, partial(_state, episode, row, others), "behavior")


def _state(episode: GradedEpisode, row: int, others: list[GradedBody], body: GradedBody) -> dict[str, float | None]:
    """Where a body is at a row of the trace, how it moves, and how far the nearest other one is."""
    poses = episode.trace.pose[row]
    x, y, heading = poses[body.index].tolist()
    there = [
        (other, poses[other.index]) for other in others if other is not body and not np.isnan(poses[other.index, 0])
    ]
    if math.isnan(x):  # not yet in the world
        return dict.fromkeys(_STATE)
    _, speed, turn = episode.velocities(body)
    return {
        "x": x,
        "y": y,
        "heading": heading,
        "speed": float(speed[row - 1]) if row and speed[row - 1] == speed[row - 1] else None,
        "turn": float(turn[row - 1]) if row and turn[row - 1] == turn[row - 1] else None,
        "goal_distance": None if body.goal is None else math.dist((x, y), body.goal[:2]),
        "distance": min((edge_to_edge((body, poses[body.index]), other) for other in there), default=None),
    }


@register("roams")
class Roams(OfBodies, EpisodePredicate):
    """In the second half of the episode, or since a time, each quadrant of the world has a share of their ways."""

    share: Quantity
    """Least share of the positions in each quadrant, of those in which a body moves."""
    since: Quantity | None = None
    """Begin of the part [s]; a negative time counts back from the end of the episode. Default: its middle."""
    endless: bool = True
    """None of them may come to rest for the last fifth of the episode."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Count positions."""
        bodies = self.bodies(material, episode.scene)
        expected = f"each quadrant holds {self.share:.0%} of the positions of {self.of}"
        x0, y0, x1, y1 = episode.scene.bounds
        middle = episode.duration / 2 if self.since is None else episode.moment(self.since)
        first = int(np.searchsorted(episode.trace.time, middle - 1e-9))
        places = episode.trace.pose[first:, [body.index for body in bodies], :2]
        points = places[np.abs(np.diff(places, axis=0, append=places[-1:])).max(axis=2) > 0]
        if not len(points):
            return Observation(False, expected, f"{bodies[0].name} has not come by then", bodies[0].entry)
        right, up = points[:, 0] > (x0 + x1) / 2, points[:, 1] > (y0 + y1) / 2
        shares = [float(np.mean((right == a) & (up == b))) for a in (False, True) for b in (False, True)]
        tail = episode.trace.pose[-max(2, len(episode.trace) // 5) :]
        rest = [b.name for b in bodies if np.ptp(tail[:, b.index, :2], axis=0).max() < 0.05]
        observed = ", ".join(f"{share:.0%}" for share in shares)
        if rest and self.endless:
            observed += f"; {rest[0]} has stopped"
        passed = min(shares) >= self.share and not (rest and self.endless)
        return Observation(passed, expected, observed, f"{bodies[0].entry}.behavior")


@register("explores")
class Explores(EpisodePredicate):
    """The explored share of the fog map at some time, compared with that after the first step."""

    at: Quantity
    """Time [s]."""
    growth: Match
    """Accepted factors."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Compare the shares."""
        expected = f"explored share after {self.at:g} s: {self.growth.words()} times the share after the first step"
        if not episode.explored:
            return Observation(False, expected, "there is no fog map", "world.fog_map")
        first = episode.explored[0][1]
        later = max((item for item in episode.explored if item[0] <= self.at + 1e-6), key=lambda item: item[0])
        factor = later[1] / first if first > 0 else 0.0
        observed = f"{first:.1%} after the first step, {later[1]:.1%} after {later[0]:.1f} s: {show(factor)} times"
        return Observation(matches(self.growth, factor, "share"), expected, observed, "world.fog_map")
