// Steps of learners.
#include "learning/learners.hpp"

#include "bindings/observing.hpp"
#include "parallel.hpp"
#include "runs/batch.hpp"
#include "runs/fetch_ahead.hpp"

namespace irsim {
namespace {

using Wanted = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Seen32 = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Learners as Python holds them, with the arrays that view their flags.
struct BoundLearners {
  BoundLearners(World& world, BoundState& bound, std::vector<int> indices, const Mask& codes,
                std::vector<WeightedTerm> terms, bool arrival, bool collision, const std::string& ends)
      : state(&bound),
        learners(bound.of(world), std::move(indices), kinds_of(world, codes), std::move(terms),
                 {arrival, collision, ends_of(ends)}) {
    for (const int index : learners.indices) expect_fit(index >= 0 && index < world.objects, "no such object");
    worlds = bound.state.worlds;
    const std::size_t a = learners.each();
    taking_part = view<bool>(learners.taking_part.memory, {worlds, a});
    ended = view<bool>(learners.ended.memory, {worlds, a});
    arrived = view<bool>(learners.arrived.memory, {worlds, a});
    collided = view<bool>(learners.collided.memory, {worlds, a});
    over = view<bool>(learners.over.memory, {worlds});
    horizon = view<std::int64_t>(learners.horizon.memory, {worlds});
  }

  static WorldEnds ends_of(const std::string& word) {
    expect_fit(word == "all" || word == "any" || word == "collision", "a world ends with all, any or collision");
    return word == "all" ? WorldEnds::all : word == "any" ? WorldEnds::any : WorldEnds::collision;
  }

  State& of(World& world, BoundState& bound) const {
    expect_fit(&bound == state, "the learners belong to another state");
    return bound.of(world);
  }

  BoundState* state;
  Learners learners;
  std::size_t worlds;
  nb::object taking_part, ended, arrived, collided, over, horizon;
};

/// Arrays of an outcome that Python will own.
struct Results {
  explicit Results(const BoundLearners& bound)
      : worlds(bound.worlds),
        each(bound.learners.each()),
        count(bound.learners.terms.size()),
        terms(count * worlds * each),
        reward(worlds * each),
        over(worlds) {
    for (auto* flags : {&terminated, &truncated, &active, &arrived, &collided})
      *flags = Array<std::uint8_t>(worlds * each);
  }

  Outcome outcome() {
    return {terms.data,  reward.data,  terminated.data, truncated.data,
            active.data, arrived.data, collided.data,   over.data};
  }

  nb::object arrays() const {
    const auto flags = [&](const Array<std::uint8_t>& array) { return view<bool>(array.memory, {worlds, each}); };
    return nb::make_tuple(view<double>(reward.memory, {worlds, each}), flags(terminated), flags(truncated),
                          flags(active), view<bool>(over.memory, {worlds}), flags(arrived), flags(collided),
                          view<double>(terms.memory, {count, worlds, each}));
  }

  std::size_t worlds, each, count;
  Array<double> terms, reward;
  Array<std::uint8_t> terminated, truncated, active, arrived, collided, over;
};

/// The commands that arrays of Python hold.
std::optional<Commands> commands_of(const BoundLearners& bound, const std::optional<Wanted>& wanted, bool velocities) {
  if (!wanted) return std::nullopt;
  expect_fit(wanted->shape(0) == bound.learners.ended.size, "there must be one command for each learner");
  expect_fit(velocities ? wanted->shape(1) == 2 : wanted->shape(1) <= 3, "a command has another number of numbers");
  return Commands{wanted->data(), wanted->shape(1), velocities};
}

void begin(BoundLearners& self, World& world, BoundState& bound, const std::optional<Wanted>& wanted, bool velocities) {
  State& state = self.of(world, bound);
  const std::optional<Commands> commands = commands_of(self, wanted, velocities);
  const Claim claim(bound);
  nb::gil_scoped_release free;
  for (int w = 0; w < state.worlds; ++w) begin_step(world, state, self.learners, w, commands ? &*commands : nullptr);
}

nb::object end(BoundLearners& self, World& world, BoundState& bound, int threads) {
  State& state = self.of(world, bound);
  Results results(self);
  const Outcome out = results.outcome();
  {
    const Claim claim(bound);
    nb::gil_scoped_release free;
    in_shares(state.crew, state.worlds, hire(state, threads), [&](std::size_t first, std::size_t last, int) {
      for (std::size_t w = first; w < last; ++w) end_step(world, state, self.learners, static_cast<int>(w), out);
    });
  }
  return results.arrays();
}

nb::object step_learners(BoundLearners& self, World& world, BoundState& bound, const std::optional<Wanted>& wanted,
                         bool velocities, const Looking& looking, const std::vector<PartAtColumn>& parts,
                         const Seen32& seen, int threads) {
  State& state = self.of(world, bound);
  Learners& learners = self.learners;
  const std::optional<Commands> commands = commands_of(self, wanted, velocities);
  expect_fit(seen.shape(0) == learners.ended.size, "there must be one row of numbers for each learner");
  check_looking(world, looking);
  check_parts(parts, seen.shape(1));
  Results results(self);
  const Outcome out = results.outcome();
  {
    const Claim claim(bound);
    nb::gil_scoped_release free;
    in_shares(state.crew, state.worlds, hire(state, threads), [&](std::size_t first, std::size_t last, int t) {
      PartWriter writer(world, state, looking, parts);
      for (int w = static_cast<int>(first); w < static_cast<int>(last); ++w) {
        fetch_ahead(state, w, static_cast<int>(last));
        begin_step(world, state, learners, w, commands ? &*commands : nullptr);
        step_and_log(world, state, w, state.workspaces[t], false);
        end_step(world, state, learners, w, out);
        for (std::size_t a = 0; a < learners.each(); ++a)
          writer.write(w * world.objects + learners.indices[a],
                       seen.data() + (w * learners.each() + a) * seen.shape(1));
      }
    });
  }
  return results.arrays();
}

}  // namespace

void bind_learners(nb::module_& m) {
  nb::class_<BoundLearners>(m, "Learners")
      .def(nb::init<World&, BoundState&, std::vector<int>, const Mask&, std::vector<WeightedTerm>, bool, bool,
                    const std::string&>(),
           nb::keep_alive<1, 3>(), nb::arg("world"), nb::arg("state"), nb::kw_only(), nb::arg("indices"),
           nb::arg("kinds"), nb::arg("terms"), nb::arg("arrival"), nb::arg("collision"), nb::arg("ends"))
      .def_ro("taking_part", &BoundLearners::taking_part)
      .def_ro("ended", &BoundLearners::ended)
      .def_ro("arrived", &BoundLearners::arrived)
      .def_ro("collided", &BoundLearners::collided)
      .def_ro("over", &BoundLearners::over)
      .def_ro("horizon", &BoundLearners::horizon)
      .def("begin", &begin, nb::arg("world"), nb::arg("state"), nb::arg("wanted").none(), nb::arg("velocities"))
      .def("end", &end, nb::arg("world"), nb::arg("state"), nb::arg("threads"))
      .def("step", &step_learners, nb::arg("world"), nb::arg("state"), nb::arg("wanted").none(), nb::arg("velocities"),
           nb::arg("looking"), nb::arg("parts"), nb::arg("seen"), nb::arg("threads"));
}

}  // namespace irsim
