"""The JSON Schema of task files, for editors, and for answers about the keys of a task."""

from __future__ import annotations

import json
from typing import Any

from irsim.learning.tasks.task import Task

__all__ = ["task_schema", "task_schema_text"]


def task_schema() -> dict[str, Any]:
    """The schema as data."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Task.model_json_schema()}


def task_schema_text() -> str:
    """The schema as the file has it."""
    return json.dumps(task_schema(), indent=1, ensure_ascii=False) + "\n"
