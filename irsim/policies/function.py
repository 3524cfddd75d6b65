"""A function as a policy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from irsim.policies.observations import Observations
from irsim.policies.policy import Needs, Output, Policy

__all__ = ["FunctionPolicy"]

_COPIED = ("output", "needs", "drives", "decision_dt", "stochastic")


class FunctionPolicy(Policy):
    """Calls a function of the observations; it remembers nothing.

    Attributes of the function with the names of the arguments below count as these arguments.

    Args:
        function: ``f(observations)``, which returns what :meth:`irsim.policies.Policy.act` does.
        name: Name in tables; default: that of the function.
        output, needs, drives, decision_dt, stochastic: As for :class:`irsim.policies.Policy`.
    """

    def __init__(
        self,
        function: Callable[[Observations], Any],
        *,
        name: str | None = None,
        output: Output | None = None,
        needs: Needs | None = None,
        drives: frozenset[str] | None = None,
        decision_dt: float | None = None,
        stochastic: bool | None = None,
    ) -> None:
        self.function = function
        self.name = name or str(getattr(function, "name", None) or getattr(function, "__name__", "function"))
        given = {"output": output, "needs": needs, "drives": drives, "decision_dt": decision_dt}
        given["stochastic"] = stochastic
        for key in _COPIED:
            value = given[key] if given[key] is not None else getattr(function, key, None)
            if value is not None:
                setattr(self, key, value)

    def act(self, observations: Observations) -> Any:
        """Call the function."""
        return self.function(observations)
