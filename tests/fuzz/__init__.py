"""Thousands of absurd scenarios: whatever the text, the answer is findings or a run, soon."""
