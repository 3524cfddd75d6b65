"""Files of PyTorch, read without PyTorch: the numbers alone, within limits."""
