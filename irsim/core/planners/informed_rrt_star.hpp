// informed_rrt_star: rrt_star that samples only where shorter paths are possible.
#pragma once

#include "fields.hpp"
#include "planning/tree.hpp"

namespace irsim {

struct InformedRrtStarOptions {
  double expand_dis, path_resolution, goal_sample_rate;
  int max_iter;
  double connect_circle_dist;
  bool search_until_max_iter;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = InformedRrtStarOptions;
    return visit(field("expand_dis", &O::expand_dis), field("path_resolution", &O::path_resolution),
                 field("goal_sample_rate", &O::goal_sample_rate), field("max_iter", &O::max_iter),
                 field("connect_circle_dist", &O::connect_circle_dist),
                 field("search_until_max_iter", &O::search_until_max_iter));
  }
};

inline Plan informed_rrt_star(const InformedRrtStarOptions& o, const Problem& problem) {
  return grow_tree(problem, {o.expand_dis, o.path_resolution, o.goal_sample_rate, o.max_iter, true,
                             o.connect_circle_dist, o.search_until_max_iter, true});
}

}  // namespace irsim
