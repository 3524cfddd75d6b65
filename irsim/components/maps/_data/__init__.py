"""The bundled maps; ``python -m irsim.components.maps._data`` draws them again."""
