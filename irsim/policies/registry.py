"""Policies of plug-ins: registered by a program, or offered by an installed package."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from irsim.diagnostics.errors import InputError
from irsim.options.registry import BEHAVIORS
from irsim.policies.policy import Policy

__all__ = ["GROUP", "MIXED", "POLICIES", "RANDOM", "RL_RVO_AUTHORS", "PolicyRegistry", "register_policy"]

GROUP = "irsim.policies"
"""Entry-point group of policies: each entry is a subclass of ``Policy``, or a function that returns a policy."""
RANDOM = "random"
"""Name of the built-in policy of uniform controls."""
MIXED = "mixed"
"""Name of the built-in policy of several policies."""
RL_RVO_AUTHORS = "rl_rvo_authors"
"""Name of the policy with weights that the user brings."""
_OWN = {RL_RVO_AUTHORS: "irsim.policies.rl_rvo_authors:RlRvoAuthorsPolicy"}
"""Policies of irsim itself that are imported on first use."""

Maker = Callable[..., Policy]
Made = TypeVar("Made", bound=Callable[..., Any])


class PolicyRegistry:
    """Makers of policies by name: classes, or functions that return a policy; their options are keywords."""

    def __init__(self) -> None:
        self._makers: dict[str, Maker] = {}
        self._entries: dict[str, Any] | None = None

    def register(self, name: str, maker: Maker) -> None:
        """Add a maker.

        Raises:
            ValueError: The name belongs to a behavior, to a file, or to another maker.
        """
        if name in (RANDOM, MIXED) or name in BEHAVIORS.installed():
            raise InputError(f"{name!r} is built in", "give your policy another name")
        if not name or any(character in name for character in " :{}[],/\\") or name.endswith((".npz", ".onnx")):
            raise InputError(f"{name!r} cannot name a policy", "use letters, digits, - and _")
        if self._makers.get(name, maker) is not maker:
            raise InputError(f"the policy {name!r} is registered already")
        self._makers[name] = maker

    def names(self) -> list[str]:
        """All names, sorted."""
        return sorted({*self._makers, *self._installed()})

    def get(self, name: str) -> Maker | None:
        """The maker of that name, which is imported on first use; None without one."""
        if name not in self._makers and name in self._installed():
            self._makers[name] = self._installed()[name].load()
        return self._makers.get(name)

    def origin(self, name: str) -> str:
        """The module that a policy comes from."""
        entry = self._installed().get(name)
        return str(entry.module) if entry is not None else str(getattr(self._makers[name], "__module__", ""))

    def _installed(self) -> dict[str, Any]:
        if self._entries is None:
            from importlib.metadata import EntryPoint, entry_points

            self._entries = {name: EntryPoint(name, place, GROUP) for name, place in _OWN.items()}
            self._entries |= {entry.name: entry for entry in entry_points(group=GROUP)}
        return self._entries


POLICIES = PolicyRegistry()


def register_policy(name: str) -> Callable[[Made], Made]:
    """Make a subclass of :class:`irsim.policies.Policy`, or a function that returns a policy, the policy ``name``.

    It is called with the options of ``{name: NAME, option: value}`` as keywords.

    Raises:
        ValueError: The name is taken.
    """

    def add(maker: Made) -> Made:
        POLICIES.register(name, maker)
        return maker

    return add
