"""The reader of every YAML file: events of the parser become plain data within limits; nothing is made from tags."""
