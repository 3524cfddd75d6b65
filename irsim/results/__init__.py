"""Typed results of every command: what the CLI prints and ``--json`` dumps."""
