"""Models as agents: each arm gives one other means, inspect_ai runs them, recordings can be played again.

Only what is called imports inspect_ai, which the extra ``irsim-mcp[evals]`` installs.
"""

from __future__ import annotations

__all__ = ["MODEL_ARMS"]

MODEL_ARMS: tuple[str, ...] = ("no-skill", "skill", "skill+mcp", "skill+mcp+distractors")
"""Arms in which a model answers: with files only, with the skills, with the MCP tools, with tools that do not help."""
