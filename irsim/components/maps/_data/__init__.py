"""The bundled maps, and how they were drawn: ``python -m irsim.components.maps._data`` writes them again."""
