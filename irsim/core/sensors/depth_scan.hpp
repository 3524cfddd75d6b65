// Depth camera as a planar scan: a lidar whose errors grow with the square of the depth.
#pragma once

#include "sensors/lidar2d.hpp"

namespace irsim {

struct DepthScanOptions : Lidar2dOptions {
  double depth_min;                // smallest depth that is measured [m]
  double depth_std, depth_growth;  // standard deviation of a depth: depth_std + depth_growth * (depth - depth_from)^2
  double depth_from;               // [m], [1/m], [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using D = DepthScanOptions;
    return Lidar2dOptions::fields([&](const auto&... lidar) {
      return visit(lidar..., field("depth_min", &D::depth_min), field("depth_std", &D::depth_std),
                   field("depth_growth", &D::depth_growth), field("depth_from", &D::depth_from));
    });
  }
};

inline int velocity_rows(const DepthScanOptions& options) {
  return velocity_rows(static_cast<const Lidar2dOptions&>(options));
}

inline int sweep_parts(const DepthScanOptions& options) {
  return sweep_parts(static_cast<const Lidar2dOptions&>(options));
}

/// `realism` is always there.
inline void depth_scan(const DepthScanOptions& options, const Sensing& s) {
  const DepthErrors depth{options.depth_min, options.depth_std, options.depth_growth, options.depth_from};
  scan_with_errors(options, s, &depth);
}

}  // namespace irsim
