// Fields of view: which objects are seen.
#pragma once

#include <vector>

#include "fields.hpp"

namespace irsim {

struct Sensing;
struct State;
struct Workspace;
struct World;

/// The field of view of an object, about its heading: `angle` is the full opening angle [rad], `reach` the range from
/// its origin [m].
struct View {
  int object;
  double angle, reach;
  bool occlusion;  // whether what is hidden behind objects that are not unobstructed is left out
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using V = View;
    return visit(field("object", &V::object), field("angle", &V::angle), field("reach", &V::reach),
                 field("occlusion", &V::occlusion));
  }
};

/// Whether `target` is partly or wholly in a view, where the moving objects were placed last.
bool sees(const World& world, const State& state, int w, const View& view, int target, Workspace& work);
/// Indices, ascending, of the objects of world w that are partly or wholly in a view at the present poses.
std::vector<int> in_view(const World& world, State& state, int w, const View& view, Workspace& work);
/// Share of the outline of an object that a sensor sees from `eye`: of the beams that would hit it alone.
double visible_share(const Sensing& sensing, Vec2 eye, int target);

}  // namespace irsim
