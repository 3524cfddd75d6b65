"""The scene, a picture as plain data: bodies, labels, colours, styles."""
