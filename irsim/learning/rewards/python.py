"""``python``: a function of the user."""

from __future__ import annotations

import importlib
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.learning.step import Moment


class Python(RewardOptions):
    """The value that your function returns for all learners of all worlds at once.

    It gets an `irsim.learning.Moment` and returns an (n, A) array.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "python", "function": "my_rewards:speed"}]}

    name: Literal["python"] = "python"
    function: Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")]
    """Module and name of the function: `my_rewards:speed`. The module must be one that Python can import."""


@REWARDS.register(Python)
def python(moment: Moment, options: Python) -> Floats:
    """(n, A) what the function returns.

    Raises:
        ArgumentError: There is no such function, or it returns something else.
    """
    module, name = options.function.split(":")
    try:
        function = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        what = f"the reward function {options.function!r} cannot be imported: {error}"
        raise ArgumentError(what, "give MODULE:FUNCTION of a module that Python finds") from error
    rewards = np.asarray(function(moment), dtype=np.float64)
    if rewards.shape != moment.arrived.shape or not np.isfinite(rewards).all():
        given = f"shape {rewards.shape}" if rewards.shape != moment.arrived.shape else "numbers that are not finite"
        what = f"the reward function {options.function!r} returned {given}"
        raise ArgumentError(what, f"return finite numbers of shape {moment.arrived.shape}: worlds x learners")
    return rewards
