// prm: the shortest path in a graph of random free points.
#pragma once

#include "fields.hpp"
#include "planning/roadmap.hpp"

namespace irsim {

struct PrmOptions {
  int n_sample, n_knn;
  double max_edge_len;  // [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("n_sample", &PrmOptions::n_sample), field("n_knn", &PrmOptions::n_knn),
                 field("max_edge_len", &PrmOptions::max_edge_len));
  }
};

inline Plan prm(const PrmOptions& o, const Problem& problem) {
  return search_roadmap(problem, o.n_sample, o.n_knn, o.max_edge_len);
}

}  // namespace irsim
