"""The documentation of a model's fields: the strings below them in its source."""

from __future__ import annotations

import ast
import inspect
import itertools
import textwrap
from functools import cache

from pydantic import BaseModel

__all__ = ["field_docs"]


@cache
def field_docs(model: type[BaseModel]) -> dict[str, str]:
    """The documentation of the fields of ``model``, own and inherited; undocumented fields are left out."""
    docs: dict[str, str] = {}
    for cls in reversed(model.__mro__):
        if not (issubclass(cls, BaseModel) and inspect.get_annotations(cls)):
            continue
        for name, text in _own_docs(cls).items():
            if name in model.model_fields:
                docs[name] = text
    for name, info in model.model_fields.items():
        if info.description:
            docs[name] = info.description
    return docs


def _own_docs(cls: type) -> dict[str, str]:
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(cls)))
    except (OSError, TypeError, SyntaxError):  # made at run time or shipped without source
        return {}
    body = getattr(tree.body[0], "body", [])
    docs: dict[str, str] = {}
    for statement, following in itertools.pairwise(body):
        if (
            isinstance(statement, ast.AnnAssign)
            and isinstance(statement.target, ast.Name)
            and isinstance(following, ast.Expr)
            and isinstance(following.value, ast.Constant)
            and isinstance(following.value.value, str)
        ):
            docs[statement.target.id] = inspect.cleandoc(following.value.value)
    return docs
