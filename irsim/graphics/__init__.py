"""From scene data to pixels and files; it knows no simulation."""
