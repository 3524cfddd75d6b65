"""Contacts within a step, which no end of a step shows: who touched, or passed through, what, when and where."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import metres, plural, seconds
from irsim.episodes.scene_summary import called
from irsim.simulation.events import BETWEEN_STEPS, Event, partner_of

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["BetweenSteps", "between_steps_message", "find_between_steps", "others_between_steps_message"]

_MAX_NAMES = 10
"""Number of objects that a result lists for each robot."""


@dataclass
class BetweenSteps:
    """Contacts between steps of an episode; objects that are ``unobstructed`` are passed through by intention.

    Attributes:
        of_robots: Contacts of robots, in order.
        of_others: Contacts in which no robot takes part, in order.
        counts: Number of contacts of each robot, by its name.
        passed: Names of the first objects that each robot passed through, or that passed through it.
    """

    of_robots: list[Event] = field(default_factory=list)
    of_others: list[Event] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    passed: dict[str, list[str]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.of_robots) + len(self.of_others)


def find_between_steps(events: Iterable[Event], robots: Collection[str], passable: Collection[str]) -> BetweenSteps:
    """Find the contacts between steps of an episode.

    Args:
        events: Events of the episode.
        robots: Names of the robots.
        passable: Names of the objects that others pass through.
    """
    contacts = BetweenSteps()
    for event in events:
        if event.kind not in BETWEEN_STEPS:  # cheapest test first: there may be a million events
            continue
        blocked = [name for name in (event.object, str(event.partner)) if partner_of(event, name) not in passable]
        mine = [name for name in blocked if name in robots]
        if mine:
            contacts.of_robots.append(event)
        elif blocked:
            contacts.of_others.append(event)
        for name in mine:
            contacts.counts[name] += 1
            through = contacts.passed.setdefault(name, [])
            other = str(partner_of(event, name))
            if event.kind == "passed_through" and other not in through and len(through) < _MAX_NAMES:
                through.append(other)
    return contacts


def between_steps_message(
    simulation: Simulation, contacts: BetweenSteps, hits: Sequence[Event], *, brief: bool = False
) -> str | None:
    """Which robot passed through, or touched, something between two steps, and what prevents that; None if none did.

    Passing through comes before touching, and what came first before what came later. Contacts that count as
    collisions (``world.contacts: swept``) are left to the message about collisions.

    Args:
        simulation: The simulation after the last step.
        contacts: From :func:`find_between_steps`.
        hits: Collisions of robots.
        brief: Leave out the step and the advice, which another message has.
    """
    scenario = simulation.scenario
    swept = scenario.world.contacts == "swept"
    judged = {(event.step, event.object, event.partner) for event in hits} if swept else set()
    mine = [event for event in contacts.of_robots if (event.step, event.object, event.partner) not in judged]
    if not mine:
        return None
    first = min(mine, key=lambda event: (event.kind != "passed_through", event.time))
    one, other = called(scenario, first.object), called(scenario, first.partner)
    when = f"between two steps at {seconds(first.time)}, contact near ({first.x:.2f}, {first.y:.2f})"
    through = first.kind == "passed_through"
    what = f"{one} passed through {other} {when}" if through else f"{one} and {other} touched {when}"
    if not through and first.depth:
        what += f", overlapping by {metres(first.depth)}"
    if len(mine) > 1:
        what += f", {'the first' if first is mine[0] else 'one'} of {len(mine)} contacts between steps"
    return what if brief else f"{what} ({_advice(simulation, first)})"


def others_between_steps_message(contacts: BetweenSteps) -> str | None:
    """How often objects besides robots touched each other between two steps; None if none did."""
    count = len(contacts.of_others)
    return f"{plural(count, 'contact')} between steps without a robot" if count else None


def _advice(simulation: Simulation, event: Event) -> str:
    """Say how to prevent a contact between steps, and how far the faster of the two moved in that step."""
    moved = {name: _step_length(simulation, name, event.step) for name in (event.object, event.partner)}
    name = max(moved, key=lambda name: moved[name])
    far = f"{called(simulation.scenario, name)} moved {metres(moved[name])} in that step; " if moved[name] else ""
    other = ", or set world.contacts: swept" if simulation.scenario.world.contacts == "step_end" else ""
    return f"{far}lower step_time{other}"


def _step_length(simulation: Simulation, name: str | None, step: int) -> float:
    """Distance that an object moved in a step [m]; 0 for the map and the walls, or if the step is not kept."""
    records = simulation.scenario.objects
    row = next((row for row, record in enumerate(records) if record.name == name), None)
    if row is None:
        return 0.0
    state = simulation.state
    track = np.vstack([state.initial_state(row)[None, :2], state.trajectory(row)[:, :2]])
    place = step - int(simulation.count[0]) - 1
    if -len(track) >= place:
        return 0.0
    moved = float(np.hypot(*(track[place] - track[place - 1])))
    return moved if np.isfinite(moved) else 0.0
