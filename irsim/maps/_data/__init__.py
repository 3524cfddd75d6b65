"""The bundled maps, and how they were drawn: ``python -m irsim.maps._data`` writes them again."""
