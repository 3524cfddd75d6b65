"""Scenes and runs as worlds of Gazebo: SDF, and the meshes that it names."""
