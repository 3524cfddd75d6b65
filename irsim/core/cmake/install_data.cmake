# Folders outside of the sources that belong in a wheel, and where the installed package looks for them. An editable
# install reads them from the checkout, so it never serves stale copies.
if(NOT SKBUILD_STATE STREQUAL "editable")
  get_filename_component(IRSIM_ROOT "${CMAKE_CURRENT_SOURCE_DIR}/../.." ABSOLUTE)
  foreach(folder templates schema)
    install(DIRECTORY "${IRSIM_ROOT}/${folder}/" DESTINATION "irsim/_bundled/${folder}" PATTERN "__pycache__" EXCLUDE)
  endforeach()
  if(EXISTS "${IRSIM_ROOT}/skills")
    install(DIRECTORY "${IRSIM_ROOT}/skills/" DESTINATION "irsim/.agents/skills" PATTERN "__pycache__" EXCLUDE)
  endif()
endif()
