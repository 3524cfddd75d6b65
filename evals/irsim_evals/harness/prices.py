"""Prices of models, for the money that an answer cost and for limits of it."""

from __future__ import annotations

from typing import Any

from irsim.diagnostics.errors import ArgumentError

__all__ = ["Price", "known_price", "set_price"]

Price = tuple[float, float]
"""US dollars for a million tokens that are read, and for a million that are written."""

_PRICES: dict[str, Price] = {
    **dict.fromkeys(("claude-fable-5-1", "claude-fable-5"), (10, 50)),
    "claude-opus-5-5": (4, 20),
    **dict.fromkeys((f"claude-opus-{version}" for version in ("5", "4-8", "4-7", "4-6", "4-5")), (5, 25)),
    **dict.fromkeys(("claude-opus-4-1", "claude-opus-4"), (15, 75)),
    **dict.fromkeys(("claude-sonnet-5-5", "claude-sonnet-5"), (2, 10)),
    **dict.fromkeys((f"claude-sonnet-{version}" for version in ("4-6", "4-5", "4")), (3, 15)),
    "claude-haiku-4-5": (1, 5),
}
"""List prices of Anthropic, as of autumn 2026. A model that is not here has no price until one is given."""
_CACHE_WRITE, _CACHE_READ = 1.25, 0.1
"""Price of a token written to the cache for five minutes, and of one read from it, in prices of an ordinary one. Some
models read their cache for less, so that the money of an attempt is at most what is said."""


def known_price(model: str) -> Price | None:
    """The price of a model, such as ``anthropic/claude-sonnet-4-5-20250929``; None if it is not known."""
    provider, _, name = model.partition("/")
    if provider != "anthropic":
        return None
    head, _, last = name.rpartition("-")
    dated = len(last) == 8 and last.isdigit()
    return _PRICES.get(head if dated else name)


def set_price(model: str, price: Price | None, *, needed: bool) -> None:
    """Tell inspect_ai the price of a model, such as ``anthropic/claude-opus-5``; default: the one that is known.

    Raises:
        ArgumentError: The price is ``needed`` for a limit of the cost, and it is not known.
    """
    from inspect_ai.model import ModelCost, ModelInfo, get_model_info, set_model_info

    price = price or known_price(model)
    if price is None and needed:
        why = f"the price of {model} is not known, so its cost cannot be limited"
        raise ArgumentError(why, "limit the tokens instead, or give its price")
    if price is None:
        return
    read, written = price
    cached = {"input_cache_write": read * _CACHE_WRITE, "input_cache_read": read * _CACHE_READ}
    cost = ModelCost(input=read, output=written, **cached)
    info: Any = get_model_info(model) or ModelInfo()
    set_model_info(model, info.model_copy(update={"cost": cost}))
