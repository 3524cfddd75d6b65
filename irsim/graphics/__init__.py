"""Turns scene data into pixels and files; independent of the simulation."""
