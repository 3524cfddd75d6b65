"""Baselines: programs that answer cases without a model. They show what the score measures.

Each is a deterministic function of the request alone: prompt, later turns, and the files that the folder starts with.
"""
