"""A scene as data: bodies, labels, colours, styles."""
