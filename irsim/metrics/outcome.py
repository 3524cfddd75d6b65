"""Metrics of the outcome: success, collisions, time-out; Francis et al. (arXiv 2306.16740), S, C, WC, AC, HC, TO, T."""

from __future__ import annotations

from irsim.metrics.trajectory import Track
from irsim.simulation.roles import HUMAN, ROBOT

__all__ = ["outcome_metrics"]


def outcome_metrics(track: Track) -> dict[str, float]:
    """Outcome of a robot: exactly one of success, collision (stopped by one, or arrived after one) and time-out.

    - ``success``: arrived within the horizon, and no contact began before or at that step; ``goal_reached`` ignores
      contacts.
    - ``collision_count``: contacts that began (at least one step without before), per unordered pair, until it arrived;
      ``wall_``, ``agent_``, ``human_collisions`` of them by partner. ``collision_steps``: steps in contact.
    - ``contacts_between_steps``: contacts, per unordered pair, with nothing touched at either end of the step, until it
      arrived; ``collision_count`` has them, too, only where ``world.contacts: swept`` makes them collisions.
    - ``timeout``: neither arrived nor stopped by a collision at the end; a contact after which the robot drives on
      (``world.collision_mode``) counts as a contact, not as the end.
    - ``time_to_goal`` [s]: time of the first arrival; NaN without one.
    """
    kinds = [kind for _, kind in track.collisions]
    agents, humans = kinds.count(ROBOT), kinds.count(HUMAN)
    return {
        "success": float(track.success),
        "goal_reached": float(track.arrival is not None),
        "collision_count": float(len(kinds)),
        "collision_steps": float(track.collided[1:].sum()),
        "wall_collisions": float(len(kinds) - agents - humans),
        "agent_collisions": float(agents),
        "human_collisions": float(humans),
        "contacts_between_steps": float(track.between_steps),
        "timeout": float(track.arrival is None and not (kinds and track.stopped)),
        "time_to_goal": float("nan") if track.arrival is None else track.arrival * track.step_time,
    }
