"""Ways to publish and to subscribe, one module each; each knows one library and nothing of scenes."""
