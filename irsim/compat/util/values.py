"""Helpers for lists, arrays, argument checks, files and logs, with the function names of IR-SIM 2.12."""

from __future__ import annotations

import difflib
import functools
import math
import os
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.log import Logger
from irsim.simulation.active_env import last_used

__all__ = [
    "check_choice",
    "check_number",
    "check_unknown_kwargs",
    "convert_list_length",
    "convert_list_length_dict",
    "file_check",
    "find_duplicates",
    "find_file",
    "find_object_by_identity",
    "fit_length",
    "is_2d_list",
    "is_list_not_list_of_lists",
    "is_list_of_dicts",
    "is_list_of_lists",
    "is_list_of_numbers",
    "log_error",
    "log_warning",
    "log_warning_once",
    "points_to_xy_list",
    "time_it",
    "time_it2",
    "to_numpy",
    "traj_to_xy_list",
]

Function = Callable[..., Any]


# lists ---------------------------------------------------------------------------------------------------------------
def is_list_of_dicts(lst: Any) -> bool:
    """Whether a value is a list of dictionaries; an empty list counts as one."""
    return isinstance(lst, list) and all(isinstance(item, dict) for item in lst)


def is_list_of_numbers(lst: Any) -> bool:
    """Whether a value is a list of numbers; an empty list counts as one."""
    return isinstance(lst, list) and all(isinstance(item, (int, float, np.number)) for item in lst)


def is_list_of_lists(lst: Any) -> bool:
    """Whether a value is a list that contains at least one list."""
    return isinstance(lst, list) and any(isinstance(item, list) for item in lst)


def is_list_not_list_of_lists(lst: Any) -> bool:
    """Whether a value is a list that contains no list."""
    return isinstance(lst, list) and not is_list_of_lists(lst)


def is_2d_list(data: Any) -> bool:
    """Whether the first item of a sequence is a list or tuple; False for arrays, which are not lists, and for None."""
    if data is None or isinstance(data, np.ndarray):
        return False
    return len(data) > 0 and isinstance(data[0], (list, tuple))


def convert_list_length(input_data: Any, number: int = 0, per_object: bool = False) -> list[Any]:
    """Return a list with one value for each of ``number`` objects.

    Args:
        input_data: One value for all objects, or a list with a value for each, whose last value is repeated if needed.
            A list of numbers counts as one value, unless ``per_object`` is set.
        number: Number of objects.
        per_object: Treat every list as a list with a value for each object.
    """
    if number <= 0:
        return []
    has_items = isinstance(input_data, list) and bool(input_data)
    if not has_items or (is_list_of_numbers(input_data) and not per_object):
        return [input_data] * number
    if len(input_data) == 1 and is_list_of_lists(input_data):
        return [input_data[0]] * number
    return fit_length(input_data, number, input_data[-1])


def convert_list_length_dict(input_data: Any, number: int = 0) -> list[Any]:
    """Return a list with one dictionary, or list of dictionaries, for each of ``number`` objects."""
    if number <= 0:
        return []
    if is_list_of_lists(input_data):
        return fit_length(input_data, number, input_data[-1])
    return [input_data] * number


def fit_length(values: Iterable[Any], length: int, fill: Any = 0) -> list[Any]:
    """Return ``values`` as a list of the given length, cut off or padded with ``fill``."""
    listed = list(values)[:length]
    return listed + [fill] * (length - len(listed))


def find_duplicates(values: Iterable[Any]) -> list[Any]:
    """Return the values that occur more than once, in the order of their first occurrence."""
    listed = list(values)
    return [value for value in dict.fromkeys(listed) if listed.count(value) > 1]


def find_object_by_identity(objects: Iterable[Any], name: str | None = None, object_id: int | None = None) -> Any:
    """Return the object with this name; if no object has the name, the object with this id; otherwise None."""
    listed = list(objects)
    by_name = (o for o in listed if name is not None and o.name == name)
    by_id = (o for o in listed if object_id is not None and o.id == object_id)
    return next(by_name, next(by_id, None))


# arrays --------------------------------------------------------------------------------------------------------------
def to_numpy(
    data: Any, default: NDArray[Any] | None = None, expected_shape: tuple[int, ...] | None = None
) -> NDArray[Any] | None:
    """Convert a list to a column (or to ``expected_shape``); None becomes ``default``, in that shape.

    Raises:
        ValueError: The number of values does not match ``expected_shape``.
    """
    if data is None:
        return default if default is None or expected_shape is None else np.asarray(default).reshape(expected_shape)
    array = np.asarray(data)
    if expected_shape is not None:
        return array.reshape(expected_shape)
    return array.reshape(-1, 1) if array.ndim == 1 else array


def traj_to_xy_list(traj: Any, three_d: bool = False) -> Any:
    """Return lists x, y and, with ``three_d``, z of a path, given as a list of columns or an array (2 or more, N)."""
    columns = np.asarray(traj) if isinstance(traj, np.ndarray) else np.hstack([np.reshape(p, (-1, 1)) for p in traj])
    return tuple(list(columns[row]) for row in range(3 if three_d else 2))


def points_to_xy_list(points: Any, three_d: bool = False) -> Any:
    """Return lists x, y and, with ``three_d``, z of points, given as a list of points or an array (2 or more, N).

    None stands for no points.
    """
    if points is None:
        return ([],) * (3 if three_d else 2)
    if isinstance(points, np.ndarray):
        return traj_to_xy_list(points, three_d)
    return tuple([point[row] for point in points] for row in range(3 if three_d else 2))


# checks --------------------------------------------------------------------------------------------------------------
def check_number(
    value: Any,
    name: str,
    low: float | None = None,
    high: float | None = None,
    *,
    strict_low: bool = False,
    allow_inf: bool = False,
    context: str | None = None,
    default: Any = None,
) -> float:
    """Return ``value`` as a number, after checking its bounds; None becomes ``default``.

    Raises:
        ValueError: The value is not a number, or it is out of bounds.
    """
    what = name if context is None else f"{context}: {name}"
    if value is None and default is not None:
        value = default
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be a number, got {value!r}") from None
    if math.isnan(number) or (math.isinf(number) and not allow_inf):
        raise ValueError(f"{what} must be a finite number, got {value!r}")
    if low is not None and (number <= low if strict_low else number < low):
        raise ValueError(f"{what} must be {'greater than' if strict_low else 'at least'} {low}, got {value!r}")
    if high is not None and number > high:
        raise ValueError(f"{what} must be at most {high}, got {value!r}")
    return number


def check_choice(value: Any, name: str, choices: Iterable[str], *, context: str | None = None) -> str:
    """Return ``value`` in lower case, after checking that it is one of ``choices``.

    Raises:
        ValueError: The value is not one of the choices.
    """
    known = list(choices)
    word = str(value).strip().lower()
    if word in known:
        return word
    what = name if context is None else f"{context}: {name}"
    raise ValueError(f"{what} must be one of {', '.join(map(repr, known))}, got {value!r}")


def check_unknown_kwargs(
    kwargs: Mapping[str, Any], valid_keys: set[str], context: str = "", logger: Any = None
) -> list[str]:
    """Log a warning for each key that is not valid, with the nearest valid key, and return the warnings."""
    messages = []
    for key in kwargs:
        if key not in valid_keys:
            near = difflib.get_close_matches(key, sorted(valid_keys), 1)
            hint = f" Did you mean: {near[0]}?" if near else ""
            messages.append(f"Unknown parameter {key!r}{context}.{hint}")
    for message in messages:
        (logger or _logger()).warning(message)
    return messages


# files, time, log ----------------------------------------------------------------------------------------------------
def file_check(file_name: str | None, root_path: str | None = None) -> str | None:
    """Return the absolute path of a file, found as named, in ``root_path`` or in a folder below it; otherwise None."""
    if file_name is None:
        return None
    if os.path.isfile(file_name):
        return os.path.abspath(file_name)
    if root_path is not None and os.path.isfile(os.path.join(root_path, file_name)):
        return os.path.abspath(os.path.join(root_path, file_name))
    return find_file(root_path, file_name)


def find_file(root_path: str | None, target_filename: str) -> str | None:
    """Return the absolute path of the first file with this name below a folder; None if no file has this name."""
    if root_path is None:
        return None
    for folder, folders, files in os.walk(root_path):
        folders.sort()
        if target_filename in files:
            return os.path.abspath(os.path.join(folder, target_filename))
    return None


def time_it(name: str = "Function") -> Callable[[Function], Function]:
    """Return a decorator that prints the duration of each call."""

    def decorate(function: Function) -> Function:
        @functools.wraps(function)
        def timed(*args: Any, **kwargs: Any) -> Any:
            begin = time.perf_counter()
            result = function(*args, **kwargs)
            print(f"{name} execute time {time.perf_counter() - begin:.6f} seconds")
            return result

        return timed

    return decorate


def time_it2(name: str = "Function") -> Callable[[Function], Function]:
    """Return a decorator like :func:`time_it` for methods; it prints only if ``self.time_print`` is true."""

    def decorate(function: Function) -> Function:
        printing = time_it(name)(function)

        @functools.wraps(function)
        def timed(self: Any, *args: Any, **kwargs: Any) -> Any:
            return (printing if getattr(self, "time_print", False) else function)(self, *args, **kwargs)

        return timed

    return decorate


def _logger() -> Logger:
    env = last_used()
    return Logger() if env is None else env.logger


def log_warning(msg: str) -> None:
    """Log a warning, with the logger of the environment used last."""
    _logger().warning(msg)


def log_warning_once(msg: str) -> None:
    """Log a warning the first time that it occurs."""
    _logger().warning_once(msg)


def log_error(msg: str) -> None:
    """Log an error, with the logger of the environment used last."""
    _logger().error(msg)
