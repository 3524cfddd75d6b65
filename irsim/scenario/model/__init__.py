"""The pydantic model of a scenario file."""
