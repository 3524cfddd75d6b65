#include "planning/pose_search.hpp"

#include <optional>
#include <queue>
#include <unordered_map>

#include "planning/dubins.hpp"
#include "planning/lattice.hpp"

namespace irsim {
namespace {

constexpr int kHeadings = 24;           // number of headings that count as different
constexpr int kBodiesPerHeading = 4;    // number of rotated bodies for each of those headings
constexpr double kMargin = 0.02;        // margin of the body [m]
constexpr double kMinStep = 0.15;       // smallest length of a piece [m]
constexpr double kMaxStep = 0.4;        // largest length of a piece [m]
constexpr double kCellsPerStep = 2.0;   // cells of positions along a piece
constexpr double kBackwardCost = 1.5;   // cost of driving backward, per length
constexpr double kSwitchCost = 0.3;     // cost of changing between forward and backward [m]
constexpr double kSteeringCost = 0.02;  // cost of an arc [m]
constexpr double kHeuristicWeight =
    1.5;  // weight of the distance to the goal: few nodes, paths longer by this factor at most
constexpr std::size_t kBetterWays = 2000;  // poses that are tried after the first way to a heading, for a shorter one
constexpr double kFieldCell = 0.1;         // smallest cell of the field of distances to the goal [m]
constexpr double kMaxFieldCells = 250000;  // largest number of its cells

struct PoseNode {
  Pose pose;
  double cost;
  int parent, way;
};

class PoseSearch {
 public:
  explicit PoseSearch(const PoseProblem& problem)
      : p_(problem),
        step_(clip(0.3 * problem.reach, kMinStep, kMaxStep)),
        cell_(step_ / kCellsPerStep),
        margin_(kMargin + (problem.radius > 0.0 ? problem.reach * 0.5 * kTurn / (kHeadings * kBodiesPerHeading) : 0.0)),
        bodies_(kHeadings * kBodiesPerHeading) {}

  std::vector<Leg> run() {
    if (!measure()) return {};
    add(p_.start, 0.0, -1, 0);
    while (!open_.empty()) {
      const auto [bound, k] = open_.top();
      open_.pop();
      if (closed_[k]) continue;
      closed_[k] = 1;
      if (!std::isnan(p_.goal_heading)) {
        if (last_.cost <= -bound || nodes_.size() > last_.most) break;
        shoot(k);
      } else if (norm(nodes_[k].pose.position() - p_.goal) <= std::max(p_.near, step_)) {
        return legs(k);
      }
      if (nodes_.size() > static_cast<std::size_t>(p_.most)) break;
      if (p_.radius > 0.0) {
        arcs(k);
      } else {
        turns(k);
      }
    }
    return last_.node < 0 ? std::vector<Leg>{} : legs_to_heading();
  }

 private:
  /// Compute distances to the goal for the disc within the body. Returns false if the goal cannot be reached.
  bool measure() {
    const double area = (p_.bounds.x1 - p_.bounds.x0) * (p_.bounds.y1 - p_.bounds.y0);
    lattice_ = Lattice::over(p_.bounds, std::max(kFieldCell, std::sqrt(area / kMaxFieldCells)));
    distance_.assign(static_cast<std::size_t>(lattice_.nodes()), kInfinity);
    Body disc = Body::disc(std::max(0.0, 0.9 * p_.room - 0.5 * norm(lattice_.cell)));
    const Space space{p_.blockers, disc, p_.bounds, false, p_.region};
    using Item = std::pair<double, int>;
    std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
    const int goal = lattice_.nearest(p_.goal);
    distance_[goal] = 0.0;
    queue.push({0.0, goal});
    const double diagonal = norm(lattice_.cell);
    while (!queue.empty()) {
      const auto [d, n] = queue.top();
      queue.pop();
      if (d > distance_[n]) continue;
      const int i = n % lattice_.nx, j = n / lattice_.nx;
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          if ((di == 0 && dj == 0) || !lattice_.holds(i + di, j + dj)) continue;
          const int m = lattice_.node(i + di, j + dj);
          const double next = d + (di != 0 && dj != 0 ? diagonal : di != 0 ? lattice_.cell.x : lattice_.cell.y);
          if (!(next < distance_[m]) || !space.free(lattice_.at(m))) continue;
          distance_[m] = next;
          queue.push({next, m});
        }
      }
    }
    return std::isfinite(distance_[lattice_.nearest(p_.start.position())]);
  }

  Body& body(double heading) {
    const double count = kHeadings * kBodiesPerHeading;
    const int k =
        static_cast<int>(std::lround((wrap(heading) + kPi) / kTurn * count)) % (kHeadings * kBodiesPerHeading);
    if (!bodies_[k]) bodies_[k] = Body::of(p_.shapes, p_.object, k * kTurn / count - kPi, margin_);
    return *bodies_[k];
  }
  bool clear(double heading, Vec2 a, Vec2 b) {
    Body& at = body(heading);
    const Space space{p_.blockers, at, p_.bounds, false, p_.region};
    return space.clear(a, b) && !p_.blockers.meet(at.at(b));
  }

  void add(const Pose& pose, double cost, int parent, int way) {
    const std::int64_t i = static_cast<std::int64_t>(std::floor((pose.x - p_.bounds.x0) / cell_));
    const std::int64_t j = static_cast<std::int64_t>(std::floor((pose.y - p_.bounds.y0) / cell_));
    const std::int64_t turn = std::lround((wrap(pose.theta) + kPi) / kTurn * kHeadings) % kHeadings;
    // The last direction of a car belongs to the key, because changing it has a cost.
    const std::int64_t key = ((i * 1000003 + j) * kHeadings + turn) * 2 + (p_.radius > 0.0 && way < 0 ? 1 : 0);
    const auto [found, fresh] = best_.try_emplace(key, cost);
    if (!fresh) {
      if (cost >= found->second) return;
      found->second = cost;
    }
    const double left = distance_[lattice_.nearest(pose.position())];
    if (!std::isfinite(left)) return;
    nodes_.push_back({pose, cost, parent, way});
    closed_.push_back(0);
    open_.push({-(cost + kHeuristicWeight * left), static_cast<int>(nodes_.size()) - 1});
  }

  double price(const PoseNode& from, double length, int way) const {
    const bool turned = from.way != 0 && way != 0 && from.way != way;
    return from.cost + length * (way < 0 ? kBackwardCost : 1.0) + (turned ? kSwitchCost : 0.0);
  }

  void arcs(int k) {
    const PoseNode from = nodes_[k];
    const int pieces =
        std::max(2, static_cast<int>(std::ceil(step_ / p_.radius * kHeadings * kBodiesPerHeading / kTurn)));
    for (const int way : {1, -1}) {
      if (way < 0 && !p_.backs) continue;
      for (const double bend : {0.0, 1.0, -1.0}) {
        Pose pose = from.pose;
        bool free = true;
        const double length = way * step_ / pieces, turn = bend * length / p_.radius;
        for (int piece = 0; piece < pieces && free; ++piece) {
          const double middle = pose.theta + 0.5 * turn;
          const Vec2 next = pose.position() + unit(middle) * length;
          free = clear(middle, pose.position(), next);
          pose = {next.x, next.y, wrap(pose.theta + turn)};
        }
        if (free) add(pose, price(from, step_, way) + (bend != 0.0 ? kSteeringCost : 0.0), k, way);
      }
    }
  }

  /// Try the ways from a node to the goal that change neither between forward and backward nor leave free space, and
  /// keep the cheapest of all.
  void shoot(int k) {
    const PoseNode from = nodes_[k];
    const Pose goal{p_.goal.x, p_.goal.y, p_.goal_heading};
    for (const int way : {1, -1}) {
      if (way < 0 && !p_.backs) continue;
      const auto turned = [&](const Pose& pose) { return way > 0 ? pose : Pose{pose.x, pose.y, pose.theta + kPi}; };
      for_dubins_ways(turned(from.pose), turned(goal), p_.radius, [&](DubinsWay found) {
        const double cost = price(from, found.total(), way);
        if (!(cost < last_.cost)) return;
        for (int part = 0; part < 3; ++part) found.bend[part] *= way, found.length[part] *= way;
        if (walk(from.pose, found, [&](const Pose& a, const Pose& b, double middle) {
              return clear(middle, a.position(), b.position());
            })) {
          if (last_.node < 0) last_.most = nodes_.size() + kBetterWays;
          last_.node = k, last_.way = way, last_.cost = cost, last_.ways = found;
        }
      });
    }
  }

  /// Call `visit(from, to, heading between)` for pieces of a way. Stops and returns false where it returns false.
  template <class Visit>
  bool walk(Pose pose, const DubinsWay& found, Visit&& visit) const {
    for (int part = 0; part < 3; ++part) {
      const double length = found.length[part];
      if (length == 0.0) continue;
      const double turn = std::fabs(found.bend[part] * length / p_.radius) * kHeadings * kBodiesPerHeading / kTurn;
      const int pieces = std::max(1, static_cast<int>(std::ceil(std::max(std::fabs(length) / step_, turn))));
      for (int piece = 0; piece < pieces; ++piece) {
        const Pose next = along_bend(pose, found.bend[part], length / pieces, p_.radius);
        const double middle = along_bend(pose, found.bend[part], 0.5 * length / pieces, p_.radius).theta;
        if (!visit(pose, next, middle)) return false;
        pose = next;
      }
    }
    return true;
  }

  std::vector<Leg> legs_to_heading() const {
    std::vector<Leg> found = legs(last_.node);
    walk(nodes_[last_.node].pose, last_.ways, [&](const Pose&, const Pose& to, double) {
      found.push_back({to, last_.way});
      return true;
    });
    return found;
  }

  bool turn_is_free(Vec2 at, double from, double by) {
    const int parts = std::max(1, static_cast<int>(std::ceil(std::fabs(by) / kTurn * kHeadings * kBodiesPerHeading)));
    for (int part = 1; part <= parts; ++part) {
      if (p_.blockers.meet(body(from + by * part / parts).at(at))) return false;
    }
    return true;
  }

  void turns(int k) {
    const PoseNode from = nodes_[k];
    const Vec2 at = from.pose.position();
    const double slot = kTurn / kHeadings, here = from.pose.theta / slot;
    for (const double to : {std::floor(here - 1e-6) * slot, std::ceil(here + 1e-6) * slot}) {
      const double by = to - from.pose.theta;
      if (!turn_is_free(at, from.pose.theta, by)) continue;
      add({at.x, at.y, wrap(to)}, from.cost + std::fabs(by) * 0.3 * (p_.reach + kMinStep), k, 0);
    }
    if (from.parent < 0 && std::fabs(here - std::round(here)) > 1e-6)
      return;  // go straight only at one of the headings
    for (const int way : {1, -1}) {
      if (way < 0 && !p_.backs) continue;
      const Vec2 next = at + unit(from.pose.theta) * (way * step_);
      if (clear(from.pose.theta, at, next)) add({next.x, next.y, from.pose.theta}, price(from, step_, way), k, way);
    }
  }

  std::vector<Leg> legs(int k) const {
    std::vector<Leg> found;
    for (; k >= 0; k = nodes_[k].parent) found.push_back({nodes_[k].pose, nodes_[k].way});
    std::reverse(found.begin(), found.end());
    if (p_.radius > 0.0) return found;
    std::vector<Leg> merged = {found.front()};  // pieces of the same straight line are merged
    for (std::size_t n = 1; n < found.size(); ++n) {
      const bool same = merged.size() > 1 && found[n].way == merged.back().way;
      const Leg& last = merged.back();
      const bool onward =
          same && (found[n].way != 0 || wrap(found[n].pose.theta - last.pose.theta) *
                                                wrap(last.pose.theta - merged[merged.size() - 2].pose.theta) >
                                            0.0);
      if (onward && found[n].way != 0) {
        merged.back() = found[n];
      } else {
        merged.push_back(found[n]);
      }
    }
    return merged;
  }

  /// The cheapest way to the heading of the goal, and the node from which it leads there.
  struct LastWay {
    int node = -1, way = 1;
    double cost = kInfinity;
    DubinsWay ways;
    std::size_t most = static_cast<std::size_t>(-1);  // number of nodes with which the search ends
  };

  const PoseProblem& p_;
  LastWay last_;
  double step_, cell_, margin_;
  std::vector<std::optional<Body>> bodies_;
  Lattice lattice_{};
  std::vector<double> distance_;
  std::vector<PoseNode> nodes_;
  std::vector<std::uint8_t> closed_;
  std::priority_queue<std::pair<double, int>> open_;
  std::unordered_map<std::int64_t, double> best_;
};

}  // namespace

std::vector<Leg> search_poses(const PoseProblem& problem) { return PoseSearch(problem).run(); }

}  // namespace irsim
