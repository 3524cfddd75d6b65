"""``rl_rvo_authors``: RL-RVO with the weights of its authors, a file that the user brings; irsim has no copy of it."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.arguments import as_given, is_number
from irsim.common.arrays import Floats
from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError, PolicyError
from irsim.policies.converters.convert import converted
from irsim.policies.networks.errors import LIMITS
from irsim.policies.networks.files import file_bytes
from irsim.policies.networks.network import Network, check_network
from irsim.policies.networks.network_policy import LayerPolicy, Slots
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs, Output
from irsim.policies.registry import RL_RVO_AUTHORS

__all__ = ["SHA256", "VARIABLE", "RlRvoAuthorsPolicy"]

VARIABLE = "RL_RVO_WEIGHTS"
"""Environment variable that names the file of weights."""
SHA256 = "ccb02cea17b3b7900897cf1792225c3fe5677d3c05e022c86d1913dc686382c3"
"""SHA-256 of the authors' file."""
_PUBLISHED = "rl_rvo_nav/pre_trained_model/pre_trained/pre_train.pt of https://github.com/hanruihua/rl_rvo_nav"
_RECIPE = (
    f"get {_PUBLISHED} (MIT, 2,714,879 bytes) and name it: {VARIABLE}=pre_train.pt, or "
    f"{{name: {RL_RVO_AUTHORS}, weights: pre_train.pt}}"
)
_MIN_SPEED = 0.02
"""Slower velocities are a stop [m/s]."""
_TOLERANCE = 0.1
"""Smaller heading errors are not corrected [rad]."""
_TURN_S = 0.2
"""Time in which a heading error is to be removed [s]."""
_FASTEST_TURN = math.pi / _TURN_S
"""Turn rate for the largest heading error [rad/s]."""


class RlRvoAuthorsPolicy(LayerPolicy):
    """RL-RVO (Han et al. 2022) with the weights of its authors, a file that you bring; `rl_rvo` is trained anew.

    The file is named by ``weights`` or by the environment variable ``RL_RVO_WEIGHTS``. It must be the published one,
    so that a row of a table says whose weights it shows: ``irsim convert rl_rvo`` makes policies of other weights.

    Args:
        weights: The file ``pre_train.pt`` of the authors; default: the value of ``RL_RVO_WEIGHTS``.
        margin: Added to the robot's own radius [m].
        unlimited_right_turns: Limit the turn rate from above only, so that a robot turns to the right as fast as it
            wants. The authors' simulator did so, by an oversight. For diff robots whose ``vel_min`` allows a turn rate
            of -15.71 rad/s; the limit to the left is their ``vel_max``.

    Raises:
        PolicyError: The file is missing, or it is another one.
        ArgumentError: An option is not of its kind.
    """

    needs = Needs(neighbors=32, neighbor_range=4.0)
    output: Output = "velocity"

    def __init__(self, weights: str | None = None, margin: float = 0.1, unlimited_right_turns: bool = False) -> None:
        if weights is not None and not isinstance(weights, str):
            raise ArgumentError(f"weights must be the path of a file, got {as_given(weights)}", _RECIPE)
        if not (is_number(margin) and 0 <= margin < math.inf):
            raise ArgumentError(f"margin must be a distance [m] of at least 0, got {as_given(margin)}", "write 0.1")
        if not isinstance(unlimited_right_turns, bool):
            what = f"unlimited_right_turns must be true or false, got {as_given(unlimited_right_turns)}"
            raise ArgumentError(what, "write true")
        path = _file(weights)
        network = _network(path, float(margin))
        plan = check_network(network, clean(str(path)), LIMITS)
        super().__init__(RL_RVO_AUTHORS, network, plan, {"file": str(path), "sha256": SHA256})
        self._commanded: Slots | None = None
        if unlimited_right_turns:
            self.output, self.drives = "control", frozenset({"diff"})
            self._commanded = Slots({"velocity": 2}, np.dtype(np.float64))

    def memory(self) -> dict[str, Any] | None:
        """The velocities commanded last, where the policy turns them into controls itself."""
        return None if self._commanded is None else {"_commanded": self._commanded}

    def act(self, observations: Observations) -> Floats:
        """Decide for B robots.

        Raises:
            PolicyError: A robot cannot turn to the right as fast as ``unlimited_right_turns`` wants.
        """
        if self._commanded is None:
            return super().act(observations)
        if (observations.low[:, 1] > -_FASTEST_TURN).any():
            what = f"policy {self.name!r} turns to the right at up to {_FASTEST_TURN:.2f} rad/s, and a robot may not"
            fix = "give the robots vel_min: [-1.5, -16], or leave out unlimited_right_turns"
            raise PolicyError("policy-mismatch", what, fix, where="policy")
        rows, last = self._commanded.recall(observations)
        velocities = super().act(replace(observations, commanded=last["velocity"]))
        self._commanded.store(rows, {"velocity": velocities})
        return _controls(velocities, observations)


def _controls(velocities: Floats, o: Observations) -> Floats:
    """(B, 2) speed [m/s] and turn rate [rad/s] toward wanted velocities; no turn to the right is limited."""
    speed = np.hypot(velocities[:, 0], velocities[:, 1])
    error = np.arctan2(velocities[:, 1], velocities[:, 0]) - o.pose[:, 2]
    error = np.arctan2(np.sin(error), np.cos(error))
    forward = np.maximum(0.0, np.minimum(speed, o.high[:, 0]) * np.cos(error))
    turn = np.where(np.abs(error) < _TOLERANCE, 0.0, np.minimum(error / _TURN_S, o.high[:, 1]))
    return np.where((speed <= _MIN_SPEED)[:, None], 0.0, np.stack([forward, turn], axis=1))


def _file(weights: str | None) -> Path:
    """The file of weights.

    Raises:
        PolicyError: None is named, or it is missing.
    """
    named = os.environ.get(VARIABLE) if weights is None else weights
    if not named:
        what = f"policy {RL_RVO_AUTHORS!r} needs the weights of its authors, which irsim does not ship"
        raise PolicyError("policy-file", what, _RECIPE)
    if not Path(named).is_file():
        owner = VARIABLE if weights is None else "weights"
        raise PolicyError("policy-file", f"{owner} names {clean(named)!r}, which is not a file", _RECIPE)
    return Path(named)


def _network(path: Path, margin: float) -> Network:
    """The network of the authors' weights.

    Raises:
        PolicyError: The file is another one.
    """
    given = digest(file_bytes(path, LIMITS.file_bytes, "the file of weights"))
    if given != SHA256:
        what = f"{clean(str(path))!r} is not the file of the authors: its SHA-256 is {given}, theirs {SHA256}"
        fix = f"{_RECIPE}; other weights: irsim convert rl_rvo FILE -o mine.npz, then name mine.npz as the policy"
        raise PolicyError("policy-file", what, fix)
    return converted("rl_rvo", path, {"margin": margin, "license": "MIT", "source": _PUBLISHED})
