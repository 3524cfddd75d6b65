// How the ranges of real lidars differ from exact ones: one chain per beam, each link of it off unless it is asked for.
//
// Mixture of a beam's outcomes: Thrun, Burgard, Fox: Probabilistic Robotics (2005), 6.3. Detection follows the range
// equation of a diffuse target: the received power falls with the square of the range and grows with reflectivity and
// the cosine of the incidence.
#pragma once

#include "fields.hpp"
#include "sensing.hpp"
#include "sensing/raycast.hpp"

namespace irsim {

/// The reading of a beam whose cone meets surfaces at different ranges.
enum class Mixed { mean, nearest, farthest };

struct LidarErrors {
  double std_per_meter;                  // growth of the standard deviation with the range [1]
  double bias_std, scale_std;            // standard deviations of an offset [m] and a scale [1] per episode
  double resolution, resolution_growth;  // ranges are multiples of resolution + growth * range^2 [m], [1/m]
  double dropout;                        // share of beams that return nothing
  double short_share, short_rate;        // share of beams that something unseen returns; its rate along them [1/m]
  double random_share;                   // share of beams that read any range
  double range_dark;     // range of a surface of 10 % reflectivity [m]; infinite: no surface is too dark
  double fade;           // width of the range in which detection ceases [m]
  double incidence_max;  // largest angle between a beam and the normal of a surface that returns it [rad]
  std::vector<std::vector<double>> blind;  // first and last angles between which nothing is seen, sensor frame [rad]
  double divergence;                       // full angle of the cone of a beam [rad]
  int rays;                                // rays cast for the cone of a beam
  Mixed mixed;
  double beam_time;  // time from beam to beam [s]; 0: all beams at once, at the end of the step
  int segments;      // parts of the scan for each of which the sensor has one place
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using E = LidarErrors;
    return visit(
        field("std_per_meter", &E::std_per_meter), field("bias_std", &E::bias_std), field("scale_std", &E::scale_std),
        field("resolution", &E::resolution), field("resolution_growth", &E::resolution_growth),
        field("dropout", &E::dropout), field("short_share", &E::short_share), field("short_rate", &E::short_rate),
        field("random_share", &E::random_share), field("range_dark", &E::range_dark), field("fade", &E::fade),
        field("incidence_max", &E::incidence_max), field("blind", &E::blind), field("divergence", &E::divergence),
        field("rays", &E::rays), choice("mixed", &E::mixed, "mean", "nearest", "farthest"),
        field("beam_time", &E::beam_time), field("segments", &E::segments));
  }
};

inline bool operator==(const LidarErrors& a, const LidarErrors& b) { return same(a, b); }

/// How the depth of a depth camera errs, which is the range along its axis: the standard deviation is
/// std + growth (depth - from)^2. It is blind below `nearest`.
struct DepthErrors {
  double nearest, std, growth, from;  // [m], [m], [1/m], [m]

  double sigma(double depth) const { return std + growth * (depth - from) * (depth - from); }
};

/// The options of a lidar that errors build on.
struct RangeLimits {
  double nearest, farthest;            // [m]
  double std;                          // of its ranges, 0 without noise [m]
  const DepthErrors* depth = nullptr;  // of depth cameras
};

class Surface;

/// Let the light of a cast fan go its way: write the cosines of incidence, replace what is behind glass and in mirrors.
void follow_light(const Sensing& sensing, const Fan& fan, Surface& surface);

/// The errors of ranges that hold for an episode.
struct EpisodeErrors {
  double scale, bias;  // [1], [m]
};
EpisodeErrors episode_errors(const LidarErrors& errors, const Sensing& sensing);

/// Write ranges, hits and valid of a scan with its errors.
///
/// Args:
///   fan: The scan without errors, cast already.
///   first_draw: Draw of the range noise of beam 0, which has the word of the draw of a lidar without further errors,
///     but is another number.
void write_with_errors(const LidarErrors& errors, const RangeLimits& limits, const Sensing& sensing, const Fan& fan,
                       EpisodeErrors episode, std::uint64_t first_draw);

}  // namespace irsim
