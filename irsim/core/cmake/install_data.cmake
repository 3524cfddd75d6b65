# The folders beside the sources that belong into a wheel, and where the package looks for them once installed.
# An editable install reads them from the checkout, so it never serves stale copies. irsim-stubs shows type checkers the
# module paths of IR-SIM 2.12 (irsim/compat).
if(NOT SKBUILD_STATE STREQUAL "editable")
  get_filename_component(IRSIM_ROOT "${CMAKE_CURRENT_SOURCE_DIR}/../.." ABSOLUTE)
  foreach(folder templates schema)
    install(DIRECTORY "${IRSIM_ROOT}/${folder}/" DESTINATION "irsim/_bundled/${folder}" PATTERN "__pycache__" EXCLUDE)
  endforeach()
  if(EXISTS "${IRSIM_ROOT}/skills")
    install(DIRECTORY "${IRSIM_ROOT}/skills/" DESTINATION "irsim/.agents/skills" PATTERN "__pycache__" EXCLUDE)
  endif()
  foreach(folder cases golds)
    if(EXISTS "${IRSIM_ROOT}/evals/${folder}")
      install(DIRECTORY "${IRSIM_ROOT}/evals/${folder}/" DESTINATION "irsim_evals/data/${folder}")
    endif()
  endforeach()
  execute_process(
    COMMAND "${Python_EXECUTABLE}" "${IRSIM_ROOT}/irsim/compat/paths.py" "${CMAKE_CURRENT_BINARY_DIR}/irsim-stubs"
    RESULT_VARIABLE IRSIM_STUBS)
  if(NOT IRSIM_STUBS EQUAL 0)
    message(FATAL_ERROR "irsim/compat/paths.py failed")
  endif()
  install(DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/irsim-stubs/" DESTINATION "irsim-stubs")
endif()
