"""How bodies move in an episode: whether they arrive, how far and how fast they get, what they explore."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, judged, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material


@register("arrive")
class Arrive(OfBodies, EpisodePredicate):
    """A share of the bodies of a selection arrives. An empty selection fails."""

    share: Match = Match(eq=1.0)
    """Accepted shares of bodies that arrive; 0 for a body that must not."""
    within: Quantity | None = None
    """Latest time [s]; default: the end of the episode."""
    or_near: Quantity | None = None
    """Ending at most this far from the goal [m] counts as well."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at the arrivals."""
        bodies = material.bodies(episode.scene, self.of)
        end = episode.duration if self.within is None else self.within
        expected = f"share of {self.of} that arrive within {show(end)} s: {self.share.words()}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        arrivals = []
        for body in bodies:
            time = episode.arrival(body.name)
            there = time is not None and time <= end + 1e-9
            if not there and self.or_near is not None and body.goal is not None:
                there = math.dist(episode.positions(body.index)[-1], body.goal[:2]) <= self.or_near
            arrivals.append((body, there, "not" if time is None else f"after {time:.1f} s"))
        share = sum(there for _, there, _ in arrivals) / len(arrivals)
        wanted = self.share.eq != 0.0
        odd = [(body, text) for body, there, text in arrivals if there != wanted]
        return Observation(
            matches(self.share, share, "share"),
            expected,
            f"{share:.0%}; " + summary(odd or [(body, text) for body, _, text in arrivals]),
            f"{(odd[0][0] if odd else bodies[0]).entry}.goal",
        )


@register("ends_at")
class EndsAt(OfBodies, EpisodePredicate):
    """Every body of a selection ends at a share of the straight way from its start to its last goal: 0 is the start, 1
    the goal. An empty selection fails."""

    share: Match
    """Accepted shares."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at the last positions."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} ends at {self.share.words()} of its way"
        missing = [body for body in bodies if body.goal is None]
        if missing:
            return Observation(False, expected, f"{missing[0].name}: no goal")
        shares = []
        for body in bodies:
            (x, y), goal = body.pose[:2], body.goal or [0.0, 0.0]
            way = math.dist((x, y), goal[:2]) or math.inf
            end_x, end_y = episode.positions(body.index)[-1].tolist()
            along = ((end_x - x) * (goal[0] - x) + (end_y - y) * (goal[1] - y)) / way
            shares.append((body, along / way))
        wrong = [(body, value) for body, value in shares if not matches(self.share, value, "share")]
        marks = [Mark(points=[episode.positions(body.index)[-1].tolist()], text=body.name) for body, _ in wrong]
        return judged(expected, shares, wrong, "behavior", marks=marks)


@register("travel")
class Travel(OfBodies, EpisodePredicate):
    """How far every body of a selection gets. An empty selection fails."""

    farthest: Match | None = None
    """Accepted values of the greatest distance from the start [m]; 0 for a body that stays."""
    path: Match | None = None
    """Accepted lengths of the path driven [m]."""
    dx: Match | None = None
    """Accepted differences of x from start to end [m]."""
    dy: Match | None = None
    """Accepted differences of y from start to end [m]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Measure the paths."""
        bodies = material.bodies(episode.scene, self.of)
        wanted = {"farthest": self.farthest, "path": self.path, "dx": self.dx, "dy": self.dy}
        words = ", ".join(f"{name} {match.words()} m" for name, match in wanted.items() if match is not None)
        expected = f"{self.of}: {words}"
        measures, wrong = [], []
        for body in bodies:
            way = episode.positions(body.index)
            seen = {
                "farthest": float(np.hypot(*(way - way[0]).T).max()),
                "path": float(np.hypot(*np.diff(way, axis=0).T).sum()),
                "dx": float(way[-1, 0] - way[0, 0]),
                "dy": float(way[-1, 1] - way[0, 1]),
            }
            text = ", ".join(f"{key} {show(seen[key])}" for key, match in wanted.items() if match is not None)
            measures.append((body, text))
            if any(match is not None and not matches(match, seen[key], "length") for key, match in wanted.items()):
                wrong.append((body, text))
        return judged(expected, measures, wrong, "behavior")


@register("speed")
class Speed(OfBodies, EpisodePredicate):
    """Measured speeds of every body of a selection. An empty selection fails."""

    highest: Match | None = None
    """Accepted values of the greatest speed along the heading [m/s]; of omnidirectional drives, in any direction."""
    lowest: Match | None = None
    """Accepted values of the smallest signed speed along the heading [m/s]; negative in reverse."""
    turn: Match | None = None
    """Accepted values of the greatest turn rate [rad/s]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Measure from step to step."""
        bodies = material.bodies(episode.scene, self.of)
        wanted = {"highest": self.highest, "lowest": self.lowest, "turn": self.turn}
        expected = ", ".join(f"{name} {match.words()}" for name, match in wanted.items() if match is not None)
        measures, wrong = [], []
        for body in bodies:
            along = episode.speeds(body.index)
            pose = episode.trace.pose[:, body.index]
            moved = np.hypot(*np.diff(pose[:, :2], axis=0).T) / episode.trace.step_time
            turned = np.abs(np.diff(np.unwrap(pose[:, 2]))) / episode.trace.step_time
            everywhere = "leftward" in body.ranges
            seen = {
                "highest": float((moved if everywhere else along).max()),
                "lowest": float(along.min()),
                "turn": float(turned.max()),
            }
            text = ", ".join(f"{key} {show(seen[key])}" for key, match in wanted.items() if match is not None)
            measures.append((body, text))
            if any(match is not None and not matches(match, seen[key], "speed") for key, match in wanted.items()):
                wrong.append((body, text))
        return judged(f"{self.of}: {expected}", measures, wrong, "vel_max")


@register("roams")
class Roams(OfBodies, EpisodePredicate):
    """In the second half of the episode each quadrant of the world holds a share of the positions."""

    share: Quantity
    """Least share of the positions in each quadrant."""
    endless: bool = True
    """None of them may come to rest for the last fifth of the episode."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Count positions."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"each quadrant holds {self.share:.0%} of the positions of {self.of}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        x0, y0, x1, y1 = episode.scene.bounds
        half = len(episode.trace) // 2
        points = episode.trace.pose[half:, [body.index for body in bodies], :2].reshape(-1, 2)
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
