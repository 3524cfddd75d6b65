import irsim
from report import show

env = irsim.make("shapes.yaml", display=False)
for o in env.obstacle_list:
    show("shape", o.shape)
    if o.shape not in ("circle", "compound"):
        show("vertices", o.vertices)
        show("original", o.original_vertices)
    show("sizes", [o.length, o.width, o.radius, o.radius_extend, o.wheelbase])
    show("centroid", o.centroid)
    show("original centroid", o.original_centroid)
    show("parts", None if o.part_vertices is None else [p.shape for p in o.part_vertices if p.shape[1] < 10])
    show("geometry", [o.geometry.geom_type, o.geometry.is_valid])
    show("original geometry", o.original_geometry.geom_type)
    show("convex", [o.cone_type, o.convex_flag])
    show("G", o.G)
    show("h", o.h)
    show("Gh", [x for x in o.get_Gh()[:2]])
    show("init Gh", [x for x in o.get_init_Gh()[:2]])
env.end(ending_time=0)
