"""Models as agents: each arm gives one other means, inspect_ai runs them, recordings can be played again.

Only what is called imports inspect_ai, which the extra ``irsim-mcp[evals]`` installs.
"""
