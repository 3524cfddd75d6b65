"""The part of a policy network that reads observations: vectors as they are, sets by a network for each member."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irsim.common.extras import require
from irsim.learning.observing import Eyes

require("learn", "torch", "stable_baselines3")
import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

__all__ = ["READERS", "GruExtractor", "PartColumns", "PartsExtractor", "columns_of"]


@dataclass(frozen=True)
class PartColumns:
    """Where a part is in an observation.

    Attributes:
        label: Its label.
        start, stop: Its columns.
        members: Number of members of a set; None for a vector.
        present: Column, within a member, of the feature that is 1 for members that are present; None without one.
        zero_row: Whether a set without members has one of zeros.
    """

    label: str
    start: int
    stop: int
    members: int | None
    present: int | None
    zero_row: bool = False

    @property
    def features(self) -> int:
        """Number of features, of each member if it is a set."""
        return (self.stop - self.start) // (self.members or 1)


def columns_of(eyes: Eyes, parts: Sequence[Any]) -> tuple[PartColumns, ...]:
    """The columns of the parts of a task, and of the draws that it observes.

    Args:
        eyes: The observations of its learners.
        parts: The options of its parts.
    """
    result = []
    for part in parts:
        columns, shape = eyes.parts[part.key]
        members = shape[0] if len(shape) == 2 else None
        features = list(getattr(part, "features", []))
        present = features.index("present") if members is not None and "present" in features else None
        zero_row = members is not None and bool(getattr(part, "zero_row", False))
        result.append(PartColumns(part.key, columns.start, columns.stop, members, present, zero_row))
    if eyes.drawn.start < eyes.drawn.stop:
        result.append(PartColumns("drawn", eyes.drawn.start, eyes.drawn.stop, None, None))
    return tuple(result)


class PartsExtractor(BaseFeaturesExtractor):  # type: ignore[misc] # types of an extra are not read
    """Vectors, then for each set the largest features that a small network gives to the members that are present.

    That network sees a member and all vectors, so that what a neighbor means can depend on the robot's own motion. The
    result does not depend on the order of the members (Zaheer et al.: Deep Sets, 2017).

    Args:
        observation_space: The box of observations.
        columns: Where the parts are.
        units: Widths of the layers of the network of each set.
    """

    def __init__(
        self, observation_space: Any, columns: tuple[PartColumns, ...], units: tuple[int, ...] = (64, 64)
    ) -> None:
        self.vectors = [part for part in columns if part.members is None]
        self.sets = [part for part in columns if part.members is not None]
        plain = sum(part.features for part in self.vectors)
        super().__init__(observation_space, plain + len(self.sets) * units[-1])
        self.members = nn.ModuleDict({part.label: _perceptron(part.features + plain, units) for part in self.sets})

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """(B, F) features of (B, D) observations."""
        vectors = torch.cat([observations[:, part.start : part.stop] for part in self.vectors], dim=1)
        pooled = [self._pool(part, observations, vectors) for part in self.sets]
        return torch.cat([vectors, *pooled], dim=1)

    def _pool(self, part: PartColumns, observations: torch.Tensor, vectors: torch.Tensor) -> torch.Tensor:
        members, present = _members(part, observations)
        each = torch.cat([members, vectors[:, None].expand(-1, members.shape[1], -1)], dim=2)
        hidden = self.members[part.label](each).masked_fill(~present[:, :, None], -torch.inf)
        largest = hidden.max(dim=1).values
        return torch.where(present.any(dim=1, keepdim=True), largest, torch.zeros_like(largest))


class GruExtractor(BaseFeaturesExtractor):  # type: ignore[misc] # types of an extra are not read
    """Vectors, then for each set the sum of the last states of a GRU that reads its members forward and backward.

    A part with ``zero_row`` has one member of zeros if it has no other. All features together are normalized (Ba,
    Kiros, Hinton: Layer Normalization, 2016), as Han et al. (2022) do for RL-RVO.

    Args:
        observation_space: The box of observations.
        columns: Where the parts are.
        units: Widths; the last one is the GRU's in each direction.
    """

    def __init__(
        self, observation_space: Any, columns: tuple[PartColumns, ...], units: tuple[int, ...] = (64, 64)
    ) -> None:
        self.vectors = [part for part in columns if part.members is None]
        self.sets = [part for part in columns if part.members is not None]
        size = sum(part.features for part in self.vectors) + len(self.sets) * units[-1]
        super().__init__(observation_space, size)
        readers = {part.label: nn.GRU(part.features, units[-1], bidirectional=True) for part in self.sets}
        self.readers = nn.ModuleDict(readers)
        self.norm = nn.LayerNorm(size)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """(B, F) features of (B, D) observations."""
        features = [observations[:, part.start : part.stop] for part in self.vectors]
        for part in self.sets:
            members, present = _members(part, observations)
            if part.zero_row:
                nobody = ~present.any(dim=1, keepdim=True)
                present = torch.cat([present[:, :-1], present[:, -1:] | nobody], dim=1)
            features.append(_last_states(self.readers[part.label], members, present))
        return self.norm(torch.cat(features, dim=1))


def _last_states(reader: nn.GRU, members: torch.Tensor, present: torch.Tensor) -> torch.Tensor:
    """(B, U) sum of the last states of both directions of a GRU that reads the members that are present, in order."""
    first = torch.argsort(~present, dim=1, stable=True)
    moved = torch.gather(members * present[:, :, None], 1, first[:, :, None].expand_as(members))
    lengths = present.sum(dim=1)
    packed = nn.utils.rnn.pack_padded_sequence(moved, lengths.clamp(min=1), batch_first=True, enforce_sorted=False)
    states = reader(packed)[1].sum(dim=0)
    return torch.where(lengths[:, None] > 0, states, torch.zeros_like(states))


def _members(part: PartColumns, observations: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """(B, K, F) members of a set, and (B, K) which are present."""
    members = observations[:, part.start : part.stop].reshape(len(observations), part.members, part.features)
    present = (members != 0).any(dim=2) if part.present is None else members[:, :, part.present] > 0.5
    return members, present


READERS = {"pool": PartsExtractor, "gru": GruExtractor}
"""How sets are read, by the setting ``set_reader``."""


def _perceptron(inputs: int, units: tuple[int, ...]) -> nn.Sequential:
    layers: list[nn.Module] = []
    for width in units:
        layers += [nn.Linear(inputs, width), nn.ReLU()]
        inputs = width
    return nn.Sequential(*layers)
