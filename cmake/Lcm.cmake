# lcm_generate(TARGET FILES... [NO_PUBSUB]): a static library of lcm-gen's C code for the message types in FILES.
#
# With NO_PUBSUB only the marshalling is generated and it needs one header of LCM, lcm/lcm_coretypes.h, which is copied so
# that a cross compiler never sees the host's include folder.
find_program(LCM_GEN lcm-gen NO_CMAKE_FIND_ROOT_PATH)
find_file(LCM_CORETYPES lcm/lcm_coretypes.h PATHS /usr/include /usr/local/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
if(NOT LCM_GEN OR NOT LCM_CORETYPES)
  message(FATAL_ERROR "LCM not found: run tools/setup, or install the packages liblcm-dev and liblcm-bin")
endif()

function(lcm_generate target)
  cmake_parse_arguments(ARG "NO_PUBSUB" "" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${target})
  file(COPY ${LCM_CORETYPES} DESTINATION ${out}/lcm)
  set(sources)
  foreach(file ${ARG_FILES})
    file(STRINGS ${file} package REGEX "^package ")
    string(REGEX REPLACE "package +([a-z_0-9]+).*" "\\1" package "${package}")
    file(STRINGS ${file} structs REGEX "^struct ")
    foreach(struct ${structs})
      string(REGEX REPLACE "struct +([a-z_0-9]+).*" "\\1" struct "${struct}")
      list(APPEND sources ${out}/${package}_${struct}.c)
    endforeach()
  endforeach()
  string(REPLACE ".c" ".h" headers "${sources}")
  set(mode)
  if(ARG_NO_PUBSUB)
    set(mode --c-no-pubsub)
  endif()
  add_custom_command(OUTPUT ${sources} ${headers} DEPENDS ${ARG_FILES} VERBATIM
    COMMAND ${LCM_GEN} -c ${mode} --c-cpath ${out} --c-hpath ${out} ${ARG_FILES})
  add_library(${target} STATIC ${sources} ${headers})
  target_include_directories(${target} SYSTEM PUBLIC ${out})
endfunction()
