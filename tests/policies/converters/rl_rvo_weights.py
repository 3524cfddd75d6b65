"""Made-up weights of the structure of RL-RVO."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Weights = dict[str, NDArray[np.float32]]


def rl_rvo_weights(units: int = 6, hidden: int = 5, *, backward: bool = True, seed: int = 0) -> Weights:
    """A state dictionary with the names of the authors' module, in which policy and value share a reader."""
    rng = np.random.default_rng(seed)

    def some(*shape: int) -> NDArray[np.float32]:
        return rng.uniform(-0.5, 0.5, shape).astype(np.float32)

    reader: Weights = {}
    for suffix in ("", "_reverse") if backward else ("",):
        reader[f"rnn_net.weight_ih_l0{suffix}"] = some(3 * units, 8)
        reader[f"rnn_net.weight_hh_l0{suffix}"] = some(3 * units, units)
        reader[f"rnn_net.bias_ih_l0{suffix}"] = some(3 * units)
        reader[f"rnn_net.bias_hh_l0{suffix}"] = some(3 * units)
    reader |= {"ln.weight": some(6 + units) + 1, "ln.bias": some(6 + units)}
    policy = {
        "pi.log_std": some(2),
        "pi.net_out.0.weight": some(hidden, 6 + units), "pi.net_out.0.bias": some(hidden),
        "pi.net_out.2.weight": some(hidden, hidden), "pi.net_out.2.bias": some(hidden),
        "pi.net_out.4.weight": some(2, hidden), "pi.net_out.4.bias": some(2),
        "v.v_net.0.weight": some(hidden, 6 + units), "v.v_net.0.bias": some(hidden),
        "v.v_net.2.weight": some(1, hidden), "v.v_net.2.bias": some(1),
    }  # fmt: skip
    shared = {f"{owner}.rnn_reader.{name}": array for owner in ("pi", "v") for name, array in reader.items()}
    return {**policy, **shared}
