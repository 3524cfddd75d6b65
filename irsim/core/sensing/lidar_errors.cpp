#include "sensing/lidar_errors.hpp"

#include "sensing/beams.hpp"
#include "sensing/quick_power.hpp"
#include "sensing/surface.hpp"
#include "sensing/ziggurat.hpp"

namespace irsim {
namespace {

constexpr double kPulse = 0.05;           // ranges within a cone that differ by less are one echo [m]
constexpr double kGlassIncidence = 0.17;  // largest incidence at which glass returns light [rad]

bool is_matt(const World& world, int object) { return world.material[object] == Material::matt; }

bool is_blind(const LidarErrors& errors, double angle) {
  return std::any_of(errors.blind.begin(), errors.blind.end(), [&](const std::vector<double>& sector) {
    return sector.size() == 2 && angle >= sector[0] && angle <= sector[1];
  });
}

/// A fan with the beams of another one, all turned by the angle whose cosine and sine are `turn`; nothing is cast yet.
Fan turned(const Sensing& s, const Fan& fan, Vec2 turn) {
  Fan out(s.spare, fan.origin(), rotate(fan.heading(), turn), s.mount, fan.reach());
  out.widen(fan);
  for (int i = 0; i < s.mount.count; ++i) out.aim(i, rotate(fan.beam(i), turn));
  return out;
}

/// Let light pass through glass that it does not meet from ahead: what is behind is seen instead.
void pass_glass(const Sensing& s, const Fan& fan, Surface& surface) {
  BeamBuffers& beams = s.buffers;
  const auto passes = [&](int i) {
    const int hit = beams.hit[i];
    return hit >= 0 && s.world.material[hit] == Material::glass && beams.cosine[i] < std::cos(kGlassIncidence);
  };
  const int n = s.mount.count;
  int first = 0;
  while (first < n && !passes(first)) ++first;
  if (first == n) return;
  Fan behind = turned(s, fan, {1.0, 0.0});
  cast_at(behind, s,
          [&](int object) { return object != s.mount.object && s.world.material[object] != Material::glass; });
  for (int i = first; i < n; ++i) {
    if (!passes(i)) continue;
    beams.range[i] = behind.range(i), beams.hit[i] = behind.hit(i);
    if (behind.hit(i) >= 0) beams.cosine[i] = surface.cosine(fan, i);
  }
}

/// Follow light from mirrors to the next surface: the beam reads the length of the whole way.
void follow_mirrors(const Sensing& s, const Fan& fan, Surface& surface) {
  BeamBuffers& beams = s.buffers;
  const Mount one{s.mount.object, 0, 0, 1, 0, 0, 0, 0, 0, 0, {}, {0.0}, {1.0}, {0.0}};
  for (int i = 0; i < s.mount.count; ++i) {
    const int hit = beams.hit[i];
    if (hit < 0 || s.world.material[hit] != Material::mirror) continue;
    const Vec2 normal = surface.normal(fan, i), beam = fan.beam(i), at = fan.end(i);
    const Vec2 on = beam - normal * (2.0 * dot(beam, normal));
    Fan next(s.spare, at, on, one, fan.reach() - beams.range[i]);
    next.aim(0, on);
    cast_at(next, s, [&](int object) { return object != hit; });
    beams.hit[i] = next.hit(0), beams.range[i] += next.range(0);
    if (next.hit(0) >= 0) beams.cosine[i] = std::fabs(dot(surface.normal(next, 0), on));
  }
}

/// Correct the ranges of a part of a sweep for the motion of sensor and target between its middle and each beam, as if
/// surfaces were planes.
void follow_motion(const Sensing& s, const Fan& fan, Surface& surface) {
  constexpr double kGrazing = 0.05;  // cosine below which a range is left as it is
  BeamBuffers& beams = s.buffers;
  for (int i = 0; i < s.mount.count; ++i) {
    const int hit = beams.hit[i];
    if (hit < 0) continue;
    const Vec3& twist = s.state.twist[s.w * s.world.objects + hit];
    const Vec2 apart = s.drift - Vec2{twist[0], twist[1]} * s.beam_time;
    if (apart.x == 0.0 && apart.y == 0.0) continue;
    const Vec2 normal = surface.normal(fan, i);
    const double facing = dot(fan.beam(i), normal), after = i - 0.5 * (s.mount.count - 1);
    if (std::fabs(facing) < kGrazing) continue;
    beams.range[i] = std::max(0.0, beams.range[i] - dot(apart, normal) * after / facing);
  }
}

/// Replace each range by what the rays of the beam's cone return together.
void widen_beams(const LidarErrors& errors, const Sensing& s, const Fan& fan) {
  BeamBuffers& beams = s.buffers;
  const int n = s.mount.count, rays = errors.rays;
  beams.cone.resize(static_cast<std::size_t>(n) * rays);
  for (int k = 0; k < rays; ++k) {
    double* const ranges = &beams.cone[static_cast<std::size_t>(k) * n];
    const double aside = ((k + 0.5) / rays - 0.5) * errors.divergence;
    if (aside == 0.0) {
      for (int i = 0; i < n; ++i) ranges[i] = fan.hit(i) < 0 ? kInfinity : fan.range(i);
      continue;
    }
    Fan ray = turned(s, fan, unit(aside));
    cast_at(ray, s, [&](int object) { return object != s.mount.object; });
    for (int i = 0; i < n; ++i) {
      ranges[i] = ray.hit(i) < 0 ? kInfinity : ray.range(i);
      if (beams.hit[i] < 0 && ray.hit(i) >= 0) beams.hit[i] = ray.hit(i);
    }
  }
  for (int i = 0; i < n; ++i) {
    if (beams.hit[i] < 0 || !is_matt(s.world, beams.hit[i])) continue;
    double nearest = kInfinity, farthest = 0.0, sum = 0.0, weights = 0.0;
    int returned = 0;
    for (int k = 0; k < rays; ++k) {
      const double range = beams.cone[static_cast<std::size_t>(k) * n + i];
      if (range == kInfinity) continue;
      const double weight = 1.0 / std::max(range * range, 1e-12);  // the light that comes back from there
      nearest = std::min(nearest, range), farthest = std::max(farthest, range);
      sum += weight * range, weights += weight;
      ++returned;
    }
    beams.power[i] = static_cast<double>(returned) / rays;
    const bool one_echo = errors.mixed == Mixed::mean || farthest - nearest <= kPulse;
    beams.range[i] = one_echo ? sum / weights : errors.mixed == Mixed::nearest ? nearest : farthest;
  }
}

/// Which surfaces return beams.
class Detection {
 public:
  Detection(const LidarErrors& errors, const RangeLimits& limits)
      : dark_(errors.range_dark),
        fade_(errors.fade),
        per_fade_(1.0 / fade_),
        growth_(dark_ < limits.farthest ? std::log(limits.farthest / dark_) / std::log(kWhite / kDark) : 0.0) {}

  /// Whether a surface that throws back a share of the light returns a beam.
  ///
  /// Args:
  ///   draw: Uniform; it is compared with a logistic curve of the range.
  bool operator()(double range, double share, double draw) const {
    if (share >= kDark && surely(dark_ - range, draw)) return true;
    // The range at which half of the beams return grows with a power of the share.
    const double ahead = dark_ * quick_power(share * (1.0 / kDark), growth_) - range;
    if (ahead >= 0.0 ? surely(ahead, draw) : surely(-ahead, 1.0 - draw)) return ahead >= 0.0;
    return ahead >= kWidths * fade_ || (ahead > -kWidths * fade_ && draw < 1.0 / (1.0 + std::exp(-ahead * per_fade_)));
  }

 private:
  static constexpr double kDark = 0.1, kWhite = 0.9;  // reflectivities for which ranges are told
  static constexpr double kWidths = 30.0;             // of the logistic curve, beyond which it is 0 or 1

  /// Whether a draw lies below the logistic curve at `ahead` even if the exponential function is replaced by the first
  /// terms of its series, which are smaller.
  bool surely(double ahead, double draw) const {
    if (!(ahead > 0.0)) return false;
    const double t = ahead * per_fade_;
    return (1.0 - draw) * (2.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0)))) > 1.0;
  }

  double dark_, fade_, per_fade_, growth_;
};

/// A range that something unseen returns instead of the surface: exponential, and shorter than the way there [m].
double cut_short(double rate, double range, double draw) {
  return rate > 0.0 ? -std::log(1.0 - draw * (1.0 - std::exp(-rate * range))) / rate : draw * range;
}

/// `count` uniform draws from `first` on. Block after block is much faster than one now and then between other things.
const double* draw_in_a_row(const Draws& draws, std::uint64_t first, int count, std::vector<double>& out) {
  const std::uint64_t begin = first / 4, blocks = (first + static_cast<std::uint64_t>(count) + 3) / 4 - begin;
  out.resize(std::max(out.size(), static_cast<std::size_t>(4 * blocks)));
  for (std::uint64_t k = 0; k < blocks; ++k) {
    const auto four = draws.uniforms(begin + k);
    std::copy(four.begin(), four.end(), &out[4 * k]);
  }
  return out.data() + first % 4;
}

/// The multiple of the resolution at a range that is nearest to it.
double rounded(const LidarErrors& errors, double range) {
  constexpr double kWhole = 0x1.8p52;  // a double of this size has no digits after the point
  const double step = errors.resolution + errors.resolution_growth * range * range;
  return step > 0.0 ? step * (range / step + kWhole - kWhole) : range;
}

}  // namespace

void follow_light(const Sensing& s, const Fan& fan, Surface& surface) {
  BeamBuffers& beams = s.buffers;
  beams.cosine.assign(fan.count(), 1.0);
  for (int i = 0; i < fan.count(); ++i) {
    if (fan.hit(i) >= 0) beams.cosine[i] = surface.cosine(fan, i);
  }
  if (!s.world.optics) return;
  pass_glass(s, fan, surface);
  follow_mirrors(s, fan, surface);
}

EpisodeErrors episode_errors(const LidarErrors& errors, const Sensing& s) {
  if (errors.scale_std == 0.0 && errors.bias_std == 0.0) return {1.0, 0.0};
  const auto draw = s.draws(3).normals(0);
  return {1.0 + s.noise() * errors.scale_std * draw[0], s.noise() * errors.bias_std * draw[1]};
}

void write_with_errors(const LidarErrors& errors, const RangeLimits& limits, const Sensing& s, const Fan& fan,
                       EpisodeErrors episode, std::uint64_t first_draw) {
  const int n = s.mount.count;
  BeamBuffers& beams = s.buffers;
  const bool steep = errors.incidence_max < 0.5 * kPi, dim = errors.range_dark < limits.farthest;
  const bool looks = steep || dim || s.world.optics;
  beams.power.assign(n, 1.0);
  Surface surface(s);
  if (looks) follow_light(s, fan, surface);
  if (s.earlier) follow_motion(s, fan, surface);
  if (errors.divergence > 0.0 && errors.rays > 1) widen_beams(errors, s, fan);

  ZigguratDraws normal(s.draws());
  const Draws details = s.draws(2);
  const double noise = s.noise(), scale = episode.scale, bias = episode.bias;
  const double least_cosine = steep ? std::cos(errors.incidence_max) : 0.0;
  const double shorts = errors.dropout + errors.short_share, randoms = shorts + errors.random_share;
  const double per_plain = 1.0 / (1.0 - randoms);
  const bool chance = dim || randoms > 0.0, blind = !errors.blind.empty();
  const Detection detected(errors, limits);
  const std::uint64_t first = s.scan_number() * static_cast<std::uint64_t>(s.all_beams) + s.first_beam;
  const double* const outcomes = chance ? draw_in_a_row(s.draws(1), first, n, beams.luck) : nullptr;
  // Copies, because for all that the compiler knows, writing a byte of `valid` could change what these point to.
  const double nearest = limits.nearest, farthest = limits.farthest, variance = limits.std * limits.std;
  const double growth = errors.std_per_meter, dropout = errors.dropout;
  const double *const exacts = beams.range.data(), *const cosines = beams.cosine.data();
  const double *const powers = beams.power.data(), *const reflectivity = s.world.reflectivity.data();
  const std::int32_t* const seen = beams.hit.data();
  double* const ranges = s.ranges;
  std::int32_t* const hits = s.hits;
  std::uint8_t* const valid = s.valid;
  for (int i = 0; i < n; ++i) {
    int hit = seen[i];
    const double exact = exacts[i];
    bool returned = hit >= 0 && !(steep && cosines[i] < least_cosine);
    const double ahead = limits.depth == nullptr ? 1.0 : s.mount.cosine[i];  // share of the range along the axis
    if (limits.depth != nullptr) returned = returned && exact * ahead >= limits.depth->nearest;
    const double outcome = chance ? outcomes[i] : 1.0;
    if (returned && dim) {
      const double share = reflectivity[hit] * cosines[i] * powers[i];
      const bool plain = outcome >= randoms;  // then the rest of the draw serves as well as another one
      const double draw = plain ? (outcome - randoms) * per_plain : details.uniform(4 * (first + i));
      returned = detected(exact, share, draw);
    }
    double range = farthest;
    if (returned) {
      const double grown = growth * exact;
      const double along = limits.depth == nullptr ? 0.0 : limits.depth->sigma(exact * ahead) / ahead;
      const double sigma = std::sqrt(variance + grown * grown + along * along);
      range = std::max(0.0, scale * exact + bias);
      if (sigma > 0.0) range = std::max(0.0, range + noise * sigma * normal(first_draw + i));
    }
    if (outcome < randoms) {
      if (outcome < dropout) {
        returned = false;
      } else if (outcome < shorts) {
        if (returned) range = cut_short(errors.short_rate, range, details.uniform(4 * (first + i) + 1)), hit = -1;
      } else {
        range = nearest + details.uniform(4 * (first + i) + 1) * (farthest - nearest), hit = -1, returned = true;
      }
    }
    if (blind) returned = returned && !is_blind(errors, s.mount.angle[i]);
    if (returned) range = rounded(errors, range);
    valid[i] = returned && range >= nearest && range <= farthest;
    ranges[i] = returned ? clip(range, nearest, farthest) : farthest;
    hits[i] = returned ? hit : -1;
  }
}

}  // namespace irsim
