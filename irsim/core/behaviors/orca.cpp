// Half of the avoidance, or all of it.
#include "behaviors/orca.hpp"

#include "orca/avoidance.hpp"

namespace irsim {
namespace {

/// Half for those that give way, all for others, unless the options say otherwise.
class FixedShare final : public Reciprocity {
 public:
  explicit FixedShare(std::optional<double> given) : given_(given) {}
  void begin(int, int) override {}
  double share(int, bool mutual, OrcaAgent&) override { return given_ ? *given_ : mutual ? 0.5 : 1.0; }

 private:
  std::optional<double> given_;
};

}  // namespace

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents) {
  FixedShare shares(options.responsibility);
  avoid(settings_of(options), decision, shares, intents);
}

}  // namespace irsim
