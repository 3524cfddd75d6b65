"""What differs between two scenarios: their data, their worlds, their texts."""
