# motehound::warnings: what every line of ours compiles clean with, on gcc and clang.
add_library(motehound_warnings INTERFACE)
target_compile_options(motehound_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wfloat-conversion -Wshadow -Werror)
add_library(motehound::warnings ALIAS motehound_warnings)
