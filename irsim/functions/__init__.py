"""The laws of the engine as functions of NumPy arrays."""
