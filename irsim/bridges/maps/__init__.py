"""Maps from other worlds: meshes, navigation meshes, USD stages, roads and maps of ROS become scenarios."""
