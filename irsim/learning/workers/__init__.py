"""Worlds that are shared out to worker processes.

Each process holds a part of the worlds. Actions, observations, rewards and flags lie in memory that all processes
share, so that a step sends nothing but a short command to each worker and reads one byte of each. The process of the
environment steps the first part itself.
"""
