// Opinions of how much others give way, and the shares of the avoidance that follow from them.
#include "behaviors/avocado.hpp"

#include <algorithm>

#include "orca/avoidance.hpp"
#include "orca/crowd.hpp"
#include "random.hpp"
#include "surroundings/closing.hpp"
#include "surroundings/ego.hpp"

namespace irsim {
namespace {

constexpr double kTieCare = 7.0;     // time after a tie in which gaps are kept [s]
constexpr double kMinChange = 1e-6;  // a smaller change of velocity is a rounding error and says nothing [m/s]

/// Time until two discs touch if they keep their velocities [s]: 0 if they overlap, infinite if they never touch.
double time_to_contact(const OrcaAgent& agent, const OrcaAgent& other) {
  const Vec2 offset = other.position - agent.position, velocity = agent.velocity - other.velocity;
  const double radius = agent.radius + other.radius, gap2 = squared(offset) - radius * radius;
  if (gap2 <= 0.0) return 0.0;
  const double closing = dot(offset, velocity), root2 = closing * closing - squared(velocity) * gap2;
  return closing > 0.0 && root2 >= 0.0 ? gap2 / (closing + std::sqrt(root2)) : kInfinity;
}

/// The reading of another object's last change of velocity: from -1, it did not give way, to 1, it did all that was
/// needed to avoid a collision. Nothing was needed: 0, or as without a reaction.
double evidence(const AvocadoOptions& options, const Opinion& before, Vec2 velocity) {
  const double needed2 = squared(before.change), gain = options.evidence_gain;
  if (needed2 < kMinChange * kMinChange) return options.evidence == NoNeed::neutral ? 0.0 : std::tanh(-0.5 * gain);
  return std::tanh(gain * (std::fabs(dot(velocity - before.velocity, before.change)) / needed2 - 0.5));
}

/// Advance attention and opinion by one period `dt` [s].
void observe(const AvocadoOptions& options, const OrcaAgent& agent, const OrcaAgent& other, double dt, Opinion& of) {
  const double time = time_to_contact(agent, other);
  of.attention += options.attention_step * (std::tanh(options.attention_time / time) - of.attention);
  const double seen = evidence(options, of, other.velocity);
  const double pull = std::tanh(options.own_weight * of.opinion + options.evidence_weight * seen);
  const double goal = of.attention * pull + options.bias / options.forgetting;
  of.opinion += std::min(1.0, dt * options.forgetting) * (goal - of.opinion);
}

/// Shares that follow from opinions, which are formed once in each step.
class LearnedShare final : public Reciprocity {
 public:
  LearnedShare(const AvocadoOptions& options, const Decision& decision)
      : options_(options), decision_(decision), all_(decision.work.orca), before_(decision.work.opinions) {}

  void begin(int k, int self) override {
    self_ = self;
    now_ = decision_.state.count[decision_.w()];
    opinions_ = &decision_.opinions[decision_.row(k)];
    formed_ = opinions_->step == now_;
    before_.clear();
    if (formed_) return;
    if (!options_.memory) {
      if (opinions_->step == now_ - 1) before_.swap(opinions_->of);  // after a break all are neutral
      opinions_->of.clear();
    }
    opinions_->step = now_;
  }

  double share(int m, OrcaAgent& other) override {
    const World& world = decision_.world;
    const OrcaAgent& agent = all_.movers[self_];
    const int number = world.number[world.moving[m]];
    Opinion& of = remembered(number);
    if (!formed_) {
      if (of.seen != now_ - 1) of.change = {};  // it was out of reach, so nothing was needed of it
      of.seen = now_;
      observe(options_, agent, other, world.step_time, of);
      of.velocity = other.velocity;
    }
    blur(of, agent, other);
    HalfPlane whole;
    avoid_agent(agent, other, 1.0, options_.timeHorizon, world.step_time, self_ < m, whole);
    of.change = whole.point - agent.velocity;
    return 1.0 - clip(0.5 * (of.opinion + 1.0), 0.0, 1.0);
  }

  void tied() override {
    if (opinions_->tied < now_) opinions_->tied_before = opinions_->tied;
    opinions_->tied = now_;
  }

 private:
  /// The opinion of the object with this number, old or new, as an entry of the present ones.
  Opinion& remembered(int number) {
    std::vector<Opinion>& present = opinions_->of;
    const bool in_place = formed_ || options_.memory;
    std::vector<Opinion>& known = in_place ? present : before_;
    const auto found = std::find_if(known.begin(), known.end(), [&](const Opinion& o) { return o.about == number; });
    if (in_place && found != known.end()) return *found;
    const Opinion neutral{number, options_.bias / options_.forgetting, 0.0, {}, {}};
    present.push_back(found != known.end() ? *found : neutral);
    return present.back();
  }

  /// Add noise to the velocity of another object, more without attention, which ends deadlocks. It is drawn along and
  /// across the line of sight, so that it turns with the world.
  void blur(const Opinion& of, const OrcaAgent& agent, OrcaAgent& other) const {
    const double most = options_.noise * (1.0 - of.attention);
    if (!(most > 0.0)) return;
    const World& world = decision_.world;
    const Draws draws(decision_.state.key(decision_.w()), Stream::behavior, world.number[world.moving[self_]]);
    const auto index = static_cast<std::uint64_t>(now_) << 32 | static_cast<std::uint32_t>(of.about);
    const auto u = draws.uniforms(index);
    const Vec2 offset = other.position - agent.position;
    const double distance = norm(offset);
    const Vec2 sight = distance > 0.0 ? offset * (1.0 / distance) : Vec2{1.0, 0.0};
    other.velocity = other.velocity + rotate(Vec2{2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0} * most, sight);
  }

  const AvocadoOptions& options_;
  const Decision& decision_;
  const OrcaCrowd& all_;
  std::vector<Opinion>& before_;
  Opinions* opinions_ = nullptr;
  std::int64_t now_ = 0;
  int self_ = 0;
  bool formed_ = false;  // whether the opinions of this step are known, because the object has decided before
};

/// Whether an object was lately, before this step, the mirror image of another one: what others see of it.
bool was_tied(const Decision& decision, int row) {
  const Opinions& its = decision.opinions[row];
  const std::int64_t now = decision.state.count[decision.w()], tied = its.tied < now ? its.tied : its.tied_before;
  return tied >= 0 && static_cast<double>(now - tied) * decision.world.step_time <= kTieCare;
}

/// Let object k keep gaps to the round bodies near it: to all of them if it is told to, or where one of both was in a
/// tie.
void keep_gaps_of(const AvocadoOptions& options, const Decision& decision, int k, Intent& intent) {
  const Ego ego = ego_of(decision, k);
  const Vec3& top = decision.state.vel_max[ego.row];
  const double body = ego.radius - kPadding, ahead = norm({top[0], top[1]}) * decision.world.step_time / kClosingShare;
  const bool all = options.keep_gap || was_tied(decision, ego.row);
  decision.work.nearby.clear();
  for_discs(decision, ego, options.neighborDist, [&](const Disc& disc) {
    if (may_close(disc.centre - ego.position, body + disc.radius, ahead) &&
        (all || was_tied(decision, decision.first_row + disc.object)))
      add_nearby(decision, ego, disc);
  });
  if (!decision.work.nearby.empty()) keep_gaps(decision, ego, false, intent);
}

}  // namespace

void avocado(const AvocadoOptions& options, const Decision& decision, Intent* intents) {
  LearnedShare shares(options, decision);
  avoid(options, decision, &shares, intents);
  const bool ties = std::any_of(decision.objects, decision.objects + decision.count,
                                [&](int object) { return was_tied(decision, decision.first_row + object); });
  for (int k = 0; k < decision.count; ++k) {
    const bool robot = decision.world.is_robot[decision.objects[k]] != 0;
    if (options.keep_gap.value_or(robot && ties)) keep_gaps_of(options, decision, k, intents[k]);
  }
}

}  // namespace irsim
