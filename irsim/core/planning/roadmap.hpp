// Probabilistic road maps. Kavraki, Svestka, Latombe, Overmars (1996).
#pragma once

#include "planning/problem.hpp"

namespace irsim {

/// The shortest path in a graph of `samples` free points, each joined to up to `neighbours` others nearer than
/// `longest` [m].
Plan search_roadmap(const Problem& problem, int samples, int neighbours, double longest);

}  // namespace irsim
