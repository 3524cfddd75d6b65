// irsim._core: what Python sees of the engine (stub: irsim/_core.pyi).
#include "bindings/helpers.hpp"

NB_MODULE(_core, m) {
  irsim::nb::set_leak_warnings(false);  // options kept by Python modules outlive this one at exit
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
}
