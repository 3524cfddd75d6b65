"""Settings of a training, which a resumed one keeps."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Fraction, Integer, Number

__all__ = ["TrainingSettings"]

Count = Annotated[Integer, Field(ge=1)]


class TrainingSettings(Options):
    """What decides about a training, besides its task."""

    algo: Literal["ppo"] = "ppo"
    """Algorithm: proximal policy optimization (Schulman et al. 2017)."""
    steps: Annotated[Integer, Field(ge=1)] = 1_000_000
    """Decisions of all learners, at most."""
    seed: Annotated[Integer, Field(ge=0, lt=2**32)] = 0
    """Seed of the first weights, of exploration and of the order of samples."""
    slots: Count = 128
    """Number of learners at once, at least; worlds are whole."""
    rollout: Count = 64
    """Steps of each slot between two updates."""
    batch: Count = 1024
    """Samples of a minibatch."""
    epochs: Count = 6
    """Passes over the samples of an update."""
    rate: Annotated[Number, Field(gt=0)] = 7e-4
    """Learning rate at the start; it falls linearly to a tenth."""
    gamma: Fraction = 0.98
    """Discount per step."""
    gae_lambda: Fraction = 0.95
    """Decay of the generalized advantage estimation (Schulman et al. 2016)."""
    clip: Annotated[Number, Field(gt=0)] = 0.2
    """Largest change of the ratio of probabilities that counts."""
    entropy: Annotated[Number, Field(ge=0)] = 0.002
    """Weight of the entropy."""
    units: list[Count] = [128, 128]
    """Widths of the layers of the policy and of the value."""
    set_units: list[Count] = [64, 64]
    """Widths of the layers of the network that reads each member of a set."""
    round_updates: Count = 8
    """Updates of a round; after each round the success is measured and everything is saved."""
    stop_at: Fraction | None = None
    """Success on the validation seeds at which the training stops; null uses all steps."""
