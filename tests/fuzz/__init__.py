"""Scenarios nobody would write, thousands of them: whatever the text, the answer is findings or a run, soon."""
