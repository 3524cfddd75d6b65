"""The value network in torch."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from irsim.common.extras import require
from irsim.learning.training.settings import SarlSettings
from irsim.policies.networks.sarl import ORDER

require("learn", "torch")
import torch
from torch import nn

__all__ = ["ValueNet"]


class ValueNet(nn.Module):  # type: ignore[misc] # types of an extra are not read
    """The value of joint states, as :mod:`irsim.policies.networks.sarl` describes it, with the same names of weights.

    Args:
        settings: The widths of its layers.
    """

    def __init__(self, settings: SarlSettings) -> None:
        super().__init__()
        _, own, both = ORDER
        embedded, crowd = settings.embed_units[-1], settings.feature_units[-1]
        self.global_state = settings.global_state
        self.mlp1 = _perceptron([both, *settings.embed_units], last=True)
        self.mlp2 = _perceptron([embedded, *settings.feature_units])
        self.attention = _perceptron([embedded * (2 if self.global_state else 1), *settings.score_units, 1])
        self.mlp3 = _perceptron([own + crowd, *settings.value_units, 1])

    def forward(self, states: torch.Tensor) -> torch.Tensor:
        """(B,) values of states (B, 6 + 7 K): the numbers of the robot, then of each person, or zeros."""
        _, size, both = ORDER
        own = states[:, :size]
        people = states[:, size:].reshape(len(states), -1, both - size)
        present = people[:, :, -1] > 0  # the sum of both radii
        joint = torch.cat([own[:, None].expand(-1, people.shape[1], -1), people], dim=2)
        embedded = self.mlp1(joint)
        scores = self._scores(embedded, present)
        counted = present & (scores != 0)
        weights = torch.softmax(scores.masked_fill(~counted, -torch.inf), dim=1)
        weights = torch.where(counted, weights, torch.zeros_like(weights))
        crowd = (weights[:, :, None] * self.mlp2(embedded)).sum(dim=1)
        value: torch.Tensor = self.mlp3(torch.cat([own, crowd], dim=1))[:, 0]
        return value

    def _scores(self, embedded: torch.Tensor, present: torch.Tensor) -> torch.Tensor:
        """(B, K) scores of embedded people (B, K, E)."""
        if not self.global_state:
            scores: torch.Tensor = self.attention(embedded)[:, :, 0]
            return scores
        count = present.sum(dim=1).clamp(min=1)
        mean = (embedded * present[:, :, None]).sum(dim=1) / count[:, None]
        first, *others = self.attention
        own, shared = first.weight.split(embedded.shape[2], dim=1)  # the share of the mean is computed once
        hidden = nn.functional.linear(embedded, own) + nn.functional.linear(mean, shared, first.bias)[:, None]
        for layer in others:
            hidden = layer(hidden)
        return hidden[:, :, 0]


def _perceptron(units: Sequence[int], last: bool = False) -> nn.Sequential:
    layers: list[nn.Module] = []
    for number, (inputs, outputs) in enumerate(pairwise(units)):
        layers.append(nn.Linear(inputs, outputs))
        if last or number + 2 < len(units):
            layers.append(nn.ReLU())
    return nn.Sequential(*layers)
