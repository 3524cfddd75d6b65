"""Errors as data: codes, findings, exceptions and their text."""
