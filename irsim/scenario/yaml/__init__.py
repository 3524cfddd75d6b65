"""YAML text: reading it with positions, and editing it without losing comments."""
