"""What a program may do that only runs scenarios: decided from its syntax, before anything of it is executed."""

from __future__ import annotations

import ast

__all__ = ["ALLOWED_MODULES", "problems_of"]

ALLOWED_MODULES = frozenset(
    {
        "__future__", "argparse", "collections", "csv", "dataclasses", "functools", "irsim", "itertools", "json",
        "math", "numpy", "pathlib", "random", "statistics", "sys", "time", "typing", "yaml",
    }
)  # fmt: skip
"""Modules that it may import; what lies below them, too."""
_FORBIDDEN_NAMES = frozenset(
    {
        "__import__", "breakpoint", "compile", "delattr", "eval", "exec", "getattr", "globals", "input", "locals",
        "setattr", "vars",
    }
)  # fmt: skip
"""Built-in functions with which a program could get round these rules."""
_FORBIDDEN_ATTRIBUTES = {
    **dict.fromkeys(
        ("register_behavior", "register_group_behavior", "register_behavior_class", "register_kinematics", "register"),
        "a runner registers no code of its own: behaviors and drives belong in the YAML",
    ),
    **dict.fromkeys(
        ("set_state", "set_goal", "create_object", "create_robot", "create_obstacle", "add_object", "add_objects"),
        "a runner does not place objects: poses and goals belong in the YAML",
    ),
    **dict.fromkeys(
        (
            "os",
            "subprocess",
            "socket",
            "shutil",
            "ctypes",
            "ctypeslib",
            "importlib",
            "builtins",
            "signal",
            "multiprocessing",
            "threading",
            "modules",
            "unsafe_load",
            "UnsafeLoader",
            "Loader",
            "CLoader",
        ),
        "a runner needs no other modules",
    ),
    **dict.fromkeys(
        (
            "unlink",
            "rmdir",
            "rename",
            "symlink_to",
            "hardlink_to",
            "chmod",
            "ctypeslib",
            "loads_pickle",
            "load_library",
        ),
        "a runner does not change files other than its results",
    ),
}


def problems_of(text: str) -> list[str]:
    """What a program does that a runner of scenarios may not do, each with its line; empty if it is one."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        return [f"it is no Python: {error}"]
    found: list[str] = []
    for node in ast.walk(tree):
        why = _problem(node)
        if why:
            found.append(f"line {getattr(node, 'lineno', 1)}: {why}")
    return found


def _problem(node: ast.AST) -> str:
    if isinstance(node, ast.Import):
        return _imports([alias.name for alias in node.names])
    if isinstance(node, ast.ImportFrom):
        if node.level:
            return "it imports a module beside it"
        return _imports([node.module or ""]) or next(
            (_FORBIDDEN_ATTRIBUTES[alias.name] for alias in node.names if alias.name in _FORBIDDEN_ATTRIBUTES), ""
        )
    if isinstance(node, ast.Name) and node.id in _FORBIDDEN_NAMES:
        return f"it uses {node.id}"
    if isinstance(node, ast.Attribute):
        if node.attr.startswith("__"):
            return f"it uses {node.attr}"
        return _FORBIDDEN_ATTRIBUTES.get(node.attr, "")
    return ""


def _imports(names: list[str]) -> str:
    odd = [name for name in names if name.partition(".")[0] not in ALLOWED_MODULES]
    return f"it imports {', '.join(odd)}" if odd else ""
