"""Robots and obstacles as scripts see them: rows of the simulation's arrays with names."""
