import numpy as np

from irsim.lib import GeometryFactory, generate_polygon, random_generate_polygon
from report import show

circle = GeometryFactory.create_geometry("circle", radius=0.5)
circle.step(np.array([[1.0], [2.0], [0.0]]))
show("circle", [circle.radius, circle.geometry.centroid.x, circle.geometry.centroid.y])
show("circle G", [circle.get_init_Gh()[0], circle.get_init_Gh()[1], circle.get_init_Gh()[2], circle.get_init_Gh()[3]])
box = GeometryFactory.create_geometry("rectangle", length=2.0, width=1.0)
box.step(np.array([[1.0], [2.0], [0.3]]))
show("box", [box.length, box.width, box.radius])
show("vertices", box.vertices)
show("original", box.original_vertices)
show("centroid", box.original_centroid)
show("G", box.get_init_Gh()[0])
show("h", box.get_init_Gh()[1])
polygon = GeometryFactory.create_geometry("polygon", vertices=[[0, 0], [2, 0], [1, 1.5]])
show("polygon", [polygon.radius, polygon.length, polygon.width])
show("made", np.asarray(generate_polygon((0, 0), 1.0, 0.2, 0.1, 6)).shape)
show("random", random_generate_polygon(1, num_vertices_range=[5, 6]).shape)
