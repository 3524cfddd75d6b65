"""Decorators that check or convert arguments, with the names of IR-SIM 2.12."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any

import numpy as np

from irsim.compat.util.values import is_list_of_numbers, to_numpy
from irsim.simulation.active_env import use

__all__ = [
    "bind_env",
    "ensure_column_vector",
    "ensure_numpy",
    "normalize_actions",
    "plot_only",
    "validate_length",
    "validate_shape",
]

Function = Callable[..., Any]


def _arguments(function: Function, args: Any, kwargs: Any) -> inspect.BoundArguments:
    bound = inspect.signature(function).bind(*args, **kwargs)
    bound.apply_defaults()
    return bound


def _check_arguments(requirements: dict[str, Any], check: Callable[[str, Any, Any], None]) -> Any:
    """Return a decorator that calls ``check(name, value, wanted)`` for each of these arguments that is not None."""

    def decorate(function: Function) -> Function:
        @functools.wraps(function)
        def checked(*args: Any, **kwargs: Any) -> Any:
            given = _arguments(function, args, kwargs).arguments
            for name, wanted in requirements.items():
                if given.get(name) is not None:
                    check(name, given[name], wanted)
            return function(*args, **kwargs)

        return checked

    return decorate


def validate_shape(**shape_requirements: Any) -> Any:
    """Return a decorator that checks the shapes of array arguments: a minimum number of rows, or the whole shape.

    Arguments that are None are not checked.
    """

    def check(name: str, value: Any, wanted: Any) -> None:
        if not isinstance(value, np.ndarray):
            raise TypeError(f"Parameter {name!r} must be a numpy array, got {type(value).__name__}")
        fits = value.shape == wanted if isinstance(wanted, tuple) else value.shape[0] >= wanted
        if not fits:
            raise ValueError(f"Parameter {name!r} must have shape {wanted}, got {value.shape}")

    return _check_arguments(shape_requirements, check)


def validate_length(**length_requirements: int) -> Any:
    """Return a decorator that checks the minimum length of arguments; lengths that are None are not checked."""

    def check(name: str, value: Any, min_length: int) -> None:
        if not hasattr(value, "__len__"):
            raise TypeError(f"Parameter {name!r} must be a sequence, got {type(value).__name__}")
        if len(value) < min_length:
            raise ValueError(f"Parameter {name!r} must have length >= {min_length}, got {len(value)}")

    return _check_arguments(length_requirements, check)


def _convert_arguments(names: tuple[str, ...], convert: Callable[[Any], Any]) -> Callable[[Function], Function]:
    def decorate(function: Function) -> Function:
        @functools.wraps(function)
        def called(*args: Any, **kwargs: Any) -> Any:
            bound = _arguments(function, args, kwargs)
            for name in names:
                if bound.arguments.get(name) is not None:
                    bound.arguments[name] = convert(bound.arguments[name])
            return function(*bound.args, **bound.kwargs)

        return called

    return decorate


def ensure_numpy(*param_names: str) -> Callable[[Function], Function]:
    """Return a decorator that converts these arguments to arrays."""
    return _convert_arguments(param_names, np.asarray)


def ensure_column_vector(*param_names: str) -> Callable[[Function], Function]:
    """Return a decorator that converts these arguments to arrays, and flat ones to columns."""
    return _convert_arguments(param_names, to_numpy)


def normalize_actions(func: Function) -> Function:
    """Decorate ``step(self, actions)``, which gets an action or None per object, to accept ``(action, action_id)``."""

    @functools.wraps(func)
    def step(self: Any, action: Any = None, action_id: Any = 0) -> Any:
        slots: list[Any] = [None] * len(self.objects)
        if action is not None:
            many = isinstance(action, (list, tuple)) and not is_list_of_numbers(list(action))
            several_ids = isinstance(action_id, (list, tuple))
            ids = list(action_id) if several_ids else [action_id + k for k in range(len(action) if many else 1)]
            for number, one in zip(ids, action if many else [action] * len(ids), strict=False):
                slots[number] = one
        return func(self, slots)

    return step


def bind_env(method: Function) -> Function:
    """Decorate a method of an environment, so that a call makes the environment the one used last."""

    @functools.wraps(method)
    def bound(self: Any, *args: Any, **kwargs: Any) -> Any:
        use(self)
        return method(self, *args, **kwargs)

    return bound


def plot_only(method: Function) -> Function:
    """Decorate a method of an environment, so that it does nothing in headless mode."""

    @functools.wraps(method)
    def draw(self: Any, *args: Any, **kwargs: Any) -> Any:
        return None if self.headless else method(self, *args, **kwargs)

    return draw
