"""Helpers without any knowledge of robots: logging, files, text, arguments, lazy names."""
