"""``mixed``: several policies in one world, each for robots of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irsim.common.arguments import as_given
from irsim.common.arrays import Floats
from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError, PolicyError
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs, Policy
from irsim.policies.registry import MIXED
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["MixedPolicy"]

_FIX = f"write {{name: {MIXED}, policies: {{crowd: orca, others: dash}}}}"


class MixedPolicy(Policy):
    """Several policies share the robots: each drives those with a name or tag, and benchmarks have metrics by role.

    The first selection that has a robot's name or one of its tags counts; `others` is every robot that no selection
    has. Without `others` such robots keep the behavior of the scenario.

    Args:
        policies: Name or tag of robots -> policy: a name, a file, or a name with options, as in ``{crowd: orca, others:
            rl_rvo}``. The first that fits counts; `others` are the rest, who otherwise keep their own behavior.

    Raises:
        ArgumentError: There is no selection, or a policy is itself one of several.
    """

    output = "velocity"
    stochastic = False

    def __init__(self, policies: Any) -> None:
        if not isinstance(policies, Mapping) or not policies:
            what = f"policies must be a mapping from robots to the policies that drive them, got {as_given(policies)}"
            raise ArgumentError(what, _FIX)
        for key, one in policies.items():
            if not isinstance(key, str) or not isinstance(one, Policy):
                raise ArgumentError(f"{as_given(one)} is not a policy for {as_given(key)}", _FIX)
            if one.parts:
                raise ArgumentError(f"the policy for {clean(key)!r} is itself one of several", "name its parts here")
        parts = list(policies.values())
        self.name, self.parts = MIXED, dict(policies)
        self.needs = Needs(scan=any(one.needs.scan for one in parts))
        self.stochastic = any(one.stochastic for one in parts)
        self.batch_invariant = all(one.batch_invariant or isinstance(one, BehaviorPolicy) for one in parts)
        self.may_be_lost = any(one.may_be_lost for one in parts)
        if any(one.digest is not None for one in parts):
            self.digest = digest("\n".join(f"{key}: {one.digest}" for key, one in policies.items()))
        self.text = _text({key: one.text for key, one in policies.items()})
        self.source = _text({key: one.source for key, one in policies.items()})

    def knowledge(self) -> str | None:
        """The class of the information of each part."""
        return "; ".join(f"{key}: {one.knowledge() or 'not known'}" for key, one in self.parts.items())

    def act(self, observations: Observations) -> Floats:
        """Refuse, because each part decides for its own robots.

        Raises:
            PolicyError: Always.
        """
        what = f"the policy {self.name!r} is driven part by part and takes no observations itself"
        raise PolicyError(
            "policy-failed", what, "give it to irsim.make, irsim.batch, env.set_policy or irsim.benchmark"
        )


def _text(parts: Mapping[str, str | None]) -> str | None:
    """The text that opens the policy; None if only this program has one of its parts."""
    if any(text is None for text in parts.values()):
        return None
    return yaml_flow({"name": MIXED, "policies": dict(parts)})
