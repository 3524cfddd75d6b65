// rrt: a tree that grows by random extensions.
#pragma once

#include "fields.hpp"
#include "planning/tree.hpp"

namespace irsim {

struct RrtOptions {
  double expand_dis, path_resolution, goal_sample_rate;
  int max_iter;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("expand_dis", &RrtOptions::expand_dis), field("path_resolution", &RrtOptions::path_resolution),
                 field("goal_sample_rate", &RrtOptions::goal_sample_rate), field("max_iter", &RrtOptions::max_iter));
  }
};

inline Plan rrt(const RrtOptions& o, const Problem& problem) {
  return grow_tree(problem,
                   {o.expand_dis, o.path_resolution, o.goal_sample_rate, o.max_iter, false, 0.0, false, false});
}

}  // namespace irsim
