// sfm: social forces. Moussaid, Helbing, Garnier, Johansson, Combe, Theraulaz: "Experimental
// study of the behavioural mechanisms underlying self-organization in human crowds" (2009); for groups Moussaid,
// Perozo, Garnier, Helbing, Theraulaz: "The walking behaviour of pedestrian social groups" (2010).
#pragma once

#include <optional>
#include <vector>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct SfmOptions {
  double vmax;                // speed cap [m/s]
  double neighbor_threshold;  // reach of social forces [m]
  double relaxation_time;     // [s]
  double force_factor_desired, force_factor_social, force_factor_obstacle;
  double sigma_obstacle;  // decay length of the force of walls [m]
  double lambda_importance, gamma, n_angular, n_velocity;
  double safety_radius;  // [m]
  // angle to the right of the wanted velocity while something moving is ahead [degrees]; none: only ties are broken
  std::optional<double> sidestep;
  std::optional<bool> keep_gap;  // whether a step takes only a share of a gap; unset: for robots
  // forces between members of a group behavior
  std::optional<std::vector<std::vector<int>>> social_groups;  // indices in Decision::members
  double force_factor_coherence, force_factor_group_repulsion;
  std::optional<double> group_repulsion_threshold;  // [m]; none: the sum of the padded radii
  double force_factor_gaze;
  double gaze_vision_angle;  // [degrees]

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using S = SfmOptions;
    return visit(field("vmax", &S::vmax), field("neighbor_threshold", &S::neighbor_threshold),
                 field("relaxation_time", &S::relaxation_time), field("force_factor_desired", &S::force_factor_desired),
                 field("force_factor_social", &S::force_factor_social),
                 field("force_factor_obstacle", &S::force_factor_obstacle), field("sigma_obstacle", &S::sigma_obstacle),
                 field("lambda_importance", &S::lambda_importance), field("gamma", &S::gamma),
                 field("n_angular", &S::n_angular), field("n_velocity", &S::n_velocity),
                 field("safety_radius", &S::safety_radius), field("sidestep", &S::sidestep),
                 field("keep_gap", &S::keep_gap), field("social_groups", &S::social_groups),
                 field("force_factor_coherence", &S::force_factor_coherence),
                 field("force_factor_group_repulsion", &S::force_factor_group_repulsion),
                 field("group_repulsion_threshold", &S::group_repulsion_threshold),
                 field("force_factor_gaze", &S::force_factor_gaze), field("gaze_vision_angle", &S::gaze_vision_angle));
  }
};

/// Write, for each object of the decision, the velocity to which one period of the forces leads.
void sfm(const SfmOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
