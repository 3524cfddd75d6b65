"""Settings of a training, which a resumed one keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.common.yaml.plain import read_value
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.base import Options
from irsim.options.units import Bool, Fraction, Integer, LongInteger, Number, Seconds
from irsim.scenario.messages.translate import option_message, option_problems

__all__ = ["AnySettings", "SarlSettings", "TrainingSettings", "read_settings", "settings_class"]


Count = Annotated[Integer, Field(ge=1)]
Rate = Annotated[Number, Field(gt=0)]


class SarlSettings(Options):
    """Everything that decides about a training of a value network, besides its task.

    The behaviors of the learners in the scenario of the task drive them in the first round, of whose returns the
    network learns values. In the other rounds the network drives them by lookahead.
    """

    algo: Literal["sarl"] = "sarl"
    """Algorithm: socially attentive reinforcement learning (Chen et al. 2019)."""
    steps: Count = 450_000
    """Decisions of all learners after the demonstrations, at most."""
    seed: Annotated[LongInteger, Field(ge=0, lt=2**32)] = 0
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


class TrainingSettings(Options):
    """Everything that decides about a training, besides its task."""

    algo: Literal["ppo"] = "ppo"
    """Algorithm: proximal policy optimization (Schulman et al. 2017)."""
    steps: Annotated[LongInteger, Field(ge=1)] = 1_000_000
    """Decisions of all learners, at most."""
    seed: Annotated[LongInteger, Field(ge=0, lt=2**32)] = 0
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
    set_reader: Literal["pool", "gru"] = "pool"
    """How sets are read: `pool` keeps the largest features of the members; `gru` reads them in their order, forward and
    backward, by a gated recurrent unit as wide as the last of `set_units`, adds both last states, and normalizes all
    features together (after Han et al. 2022)."""
    log_std: Annotated[Number, Field(ge=-5, le=2)] = -0.5
    """Natural logarithm of the standard deviation of exploration at the start, for actions from -1 to 1. With less of
    it a training meets the places where a policy without exploration stops for good."""
    round_updates: Count = 8
    """Updates of a round; after each round the success is measured and everything is saved."""
    stop_at: Fraction | None = None
    """Success on the validation seeds at which the training stops; null uses all steps."""


AnySettings = TrainingSettings | SarlSettings
"""Settings of a training with any algorithm."""
_CLASSES: dict[str, type[AnySettings]] = {"ppo": TrainingSettings, "sarl": SarlSettings}


def settings_class(algo: str) -> type[AnySettings]:
    """The settings of an algorithm.

    Raises:
        ArgumentError: There is no such algorithm.
    """
    if algo not in _CLASSES:
        known = ", ".join(_CLASSES)
        raise ArgumentError(
            f"there is no algorithm {clean(algo)!r}", suggestion(algo, list(_CLASSES), f"choose from {known}")
        )
    return _CLASSES[algo]


def read_settings(given: Mapping[str, Any], texts: Sequence[str]) -> AnySettings:
    """Settings of a command.

    Args:
        given: Settings by name; None leaves the default.
        texts: More of them as ``KEY=VALUE``, with values in YAML.

    Raises:
        ArgumentError: A text is not KEY=VALUE, or a value is not allowed.
    """
    values = {key: value for key, value in given.items() if value is not None}
    model = settings_class(str(values.get("algo", "ppo")))
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise ArgumentError(f"{as_given(text)} is not a setting", "write KEY=VALUE, such as rate=3e-4")
        if key not in model.model_fields:
            known = list(model.model_fields)
            raise ArgumentError(
                f"there is no setting {clean(key)!r}", suggestion(key, known, f"choose from {', '.join(known)}")
            )
        read = read_value(value)
        values[key] = number_of(read) if isinstance(read, str) else read
    try:
        return model.model_validate(values)
    except ValidationError as error:
        message, fix = option_message(option_problems(error, values, model))
        raise ArgumentError(message, fix or "give an allowed value") from None


def number_of(text: str) -> Any:
    """The number of a text such as ``3e-4``, which YAML takes for text; else the text."""
    try:
        return float(text)
    except ValueError:
        return text
