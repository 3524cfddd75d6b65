# Writes a header with the SHA-256 of the sources of this folder, by which results name the engine that made them.
# Run as `cmake -D SOURCE=folder -D HEADER=file -P digest.cmake`; line ends do not count.
file(GLOB_RECURSE names RELATIVE "${SOURCE}" "${SOURCE}/*.cpp" "${SOURCE}/*.hpp")
list(APPEND names CMakeLists.txt)
list(SORT names)
set(lines "")
foreach(name IN LISTS names)
  file(READ "${SOURCE}/${name}" text)
  string(REPLACE "\r\n" "\n" text "${text}")
  string(SHA256 hash "${text}")
  string(APPEND lines "${name} ${hash}\n")
endforeach()
string(SHA256 hash "${lines}")
file(WRITE "${HEADER}" "#define IRSIM_SOURCES \"${hash}\"\n")
