import numpy as np

from irsim.util.util import (
    WrapTo2Pi,
    WrapToPi,
    WrapToRegion,
    cross_product,
    diff_to_omni,
    dist_hypot,
    distance,
    gen_inequal_from_vertex,
    get_transform,
    is_2d_list,
    is_convex_and_ordered,
    omni_to_diff,
    random_point_range,
    relative_position,
    transform_point_with_state,
    vertices_transform,
)
from report import show

show("wrap", [WrapToPi(4.0), WrapToPi(-4.0), WrapToPi(np.pi), WrapToPi(-4.0, True), WrapToPi(float("inf"))])
show("wrap 2pi", [WrapTo2Pi(-1.0), WrapTo2Pi(7.0)])
show("region", WrapToRegion(5.0, [-np.pi, np.pi]))
p, q = np.array([[1.0], [2.0]]), np.array([[4.0], [6.0]])
show("relative", relative_position(p, q))
show("distance", [distance(p, q), dist_hypot(1, 2, 4, 6)])
show("diff", omni_to_diff(0.3, np.array([[0.5], [0.5]])))
show("slow", omni_to_diff(0.3, np.array([[0.01], [0.01]])))
show("omni", diff_to_omni(0.3, np.array([[0.5], [0.2]])))
show("point", transform_point_with_state(np.array([[1.0], [0.0], [0.1]]), np.array([[1.0], [2.0], [0.5]])))
square = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
show("vertices", vertices_transform(square, np.array([[1.0], [2.0], [0.5]])))
show("transform", list(get_transform(np.array([[1.0], [2.0], [0.5]]))))
show("convex", is_convex_and_ordered(square))
show("clockwise", is_convex_and_ordered(square[:, ::-1]))
show("inequality", list(gen_inequal_from_vertex(square)))
show("cross", cross_product([0, 0], [1, 0], [0, 1]))
show("random", random_point_range([0, 0, 0], [1, 1, 1]).shape)
show("2d", [is_2d_list([[1, 2]]), is_2d_list([1, 2])])
