"""How an episode ended, for each robot and for the team (success only without a collision before arrival)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from irsim.simulation.events import Event, first_collisions, first_events, read_events

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Outcome", "outcome_of", "robot_outcomes"]

Outcome = Literal["running", "success", "collision", "timeout"]


def robot_outcomes(simulation: Simulation, world: int = 0, events: list[Event] | None = None) -> dict[str, Outcome]:
    """Outcome of every robot so far.

    ``success``: it arrived and had touched nothing before; ``collision``: it arrived after it had, or it stands because
    it did; otherwise ``running``, also after a contact that did not stop it.

    Args:
        simulation: Where to look.
        world: Index of the world.
        events: Its events, if they have been read already.
    """
    events = read_events(simulation, world) if events is None else events
    arrivals, collisions = first_events(events, "arrival"), first_collisions(simulation, events)
    outcomes: dict[str, Outcome] = {}
    for row, record in enumerate(simulation.scenario.objects, world * simulation.objects):
        if record.role != "robot":
            continue
        arrival, collision = arrivals.get(record.name), collisions.get(record.name)
        if arrival is None:
            stopped = collision is not None and bool(simulation.stopped[row])
            outcomes[record.name] = "collision" if stopped else "running"
        else:
            before = collision is not None and collision.step <= arrival.step
            outcomes[record.name] = "collision" if before else "success"
    return outcomes


def outcome_of(simulation: Simulation, world: int = 0, *, time_limit: float | None = None) -> Outcome:
    """Outcome of the team.

    Args:
        simulation: Where to look.
        world: Index of the world.
        time_limit: Horizon [s]; default ``world.time_limit``. Robots still under way then have timed out.

    Returns:
        ``running`` until every robot has arrived or stopped or the horizon is reached; then ``success`` if all robots
        have it, ``collision`` if any robot has that, else ``timeout``.
    """
    limit = simulation.scenario.world.time_limit if time_limit is None else time_limit
    over = limit is not None and simulation.time >= limit - 1e-9
    if not (over or bool(simulation.done()[world])):
        return "running"
    outcomes = robot_outcomes(simulation, world).values()
    if outcomes and all(outcome == "success" for outcome in outcomes):
        return "success"
    return "collision" if "collision" in outcomes else "timeout"
