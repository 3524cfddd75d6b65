"""Settings of a training of a value network."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Bool, Fraction, Integer, Number, Seconds

__all__ = ["SarlSettings"]

Count = Annotated[Integer, Field(ge=1)]
Rate = Annotated[Number, Field(gt=0)]


class SarlSettings(Options):
    """What decides about a training of a value network, besides its task.

    The behaviors of the learners in the scenario of the task drive them in the first round, of whose returns the
    network learns values. In the other rounds the network drives them by lookahead.
    """

    algo: Literal["sarl"] = "sarl"
    """Algorithm: socially attentive reinforcement learning (Chen et al. 2019)."""
    steps: Count = 450_000
    """Decisions of all learners after the demonstrations, at most."""
    seed: Annotated[Integer, Field(ge=0, lt=2**32)] = 0
    """Seed of the first weights, of exploration and of the order of samples."""
    demonstrations: Count = 2000
    """Episodes that the behaviors drive."""
    demonstration_epochs: Count = 20
    """Passes over the decisions of these episodes."""
    slots: Count = 100
    """Number of learners at once, at least; worlds are whole."""
    batch: Count = 500
    """Samples of a minibatch."""
    updates: Count = 100
    """Minibatches after each episode of all worlds."""
    round_episodes: Count = 10
    """Episodes of each world in a round; after each round the success is measured and everything is saved."""
    memory: Count = 100_000
    """Decisions that are remembered."""
    rate: Rate = 1e-3
    """Learning rate at the start; it falls linearly to a tenth."""
    decay: Annotated[Number, Field(ge=0)] = 1e-5
    """Decay of the weights, relative to the learning rate."""
    gamma: Fraction = 0.9
    """Discount for each metre at the largest speed."""
    explore: Fraction = 0.5
    """Share of random moves at the start."""
    explore_end: Fraction = 0.1
    """Share of random moves after `explore_until`."""
    explore_until: Fraction = 0.4
    """Share of the steps after which the share of random moves stays as it is."""
    target_updates: Count = 200
    """Minibatches after which the network that values what follows is replaced by the present one."""
    global_state: Bool = True
    """Whether attention also sees the mean over all people."""
    embed_units: list[Count] = [150, 100]
    """Widths of the layers that read a joint state."""
    feature_units: list[Count] = [100, 50]
    """Widths of the layers that make the features of a person."""
    score_units: list[Count] = [100, 100]
    """Widths of the layers of the attention before its last one, which has one unit."""
    value_units: list[Count] = [150, 100, 100]
    """Widths of the layers of the value before its last one, which has one unit."""
    speeds: Count = 5
    """Speeds that are compared."""
    headings: Count = 16
    """Headings that are compared, from the direction of the goal on; or changes of the heading, where the action of the
    task returns controls."""
    dt: Annotated[Seconds, Field(gt=0)] = 0.25
    """Time between two decisions, and how far it looks ahead."""
    gap: Literal["end", "smallest"] = "end"
    """Which gap the predicted reward looks at: at the end of a move, or the smallest one during it."""
    stop_at: Fraction | None = None
    """Success on the validation seeds at which the training stops; null uses all steps."""
