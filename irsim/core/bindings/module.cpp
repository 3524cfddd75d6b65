// The Python module irsim._core; irsim/_core.pyi declares its types.
#include "bindings/helpers.hpp"
#include "sources.hpp"

NB_MODULE(_core, m) {
  irsim::nb::set_leak_warnings(false);  // at exit, options that Python modules hold outlive this module
  irsim::bind_log(m);
  irsim::bind_maps(m);
  irsim::bind_features(m);
  irsim::bind_planning(m);
  irsim::bind_world(m);
  irsim::bind_state(m);
  irsim::bind_steps(m);
  irsim::bind_object(m);
  irsim::bind_tools(m);
  irsim::bind_clearance(m);
  irsim::bind_networks(m);
  irsim::bind_policies(m);
  irsim::bind_observing(m);
  irsim::bind_learners(m);
  irsim::bind_pictures(m);
  m.attr("sources") = irsim::sources();
}
