"""Helpers that know nothing of robots: logging, files, text, arguments, lazy names."""
