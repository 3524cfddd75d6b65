"""Output of the scripts: one line per fact, the same on every simulator that has the interface."""

import numpy as np


def plain(value):
    """A value in words and rounded numbers."""
    if isinstance(value, np.ndarray):
        return f"{value.shape} {plain(value.ravel().tolist())}"
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value))
    if isinstance(value, (float, np.floating)):
        return f"{float(value) + 0.0:.6f}"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {plain(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(plain(item) for item in value) + "]"
    return str(value)


def show(name, value):
    """Print one fact."""
    print(">>", name, "=", plain(value), flush=True)


def error_of(call, *args, **kwargs):
    """The name of the exception that a call raises."""
    try:
        call(*args, **kwargs)
    except Exception as error:
        return next(kind.__name__ for kind in type(error).__mro__ if kind.__module__ == "builtins")
    return "none"
