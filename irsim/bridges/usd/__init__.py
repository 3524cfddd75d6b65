"""OpenUSD: stages of scenes and runs, and prims that follow states, as in Isaac Sim and Blender."""
