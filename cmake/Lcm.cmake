# lcm_generate(TARGET FILES... [NO_PUBSUB]): a static library of lcm-gen's C code for the message types in FILES.
#
# With NO_PUBSUB only the marshalling is generated and it needs one header of LCM, lcm/lcm_coretypes.h, which is copied so
# that a cross compiler never sees the host's include folder.
#
# LCM is the system's, or with MOTEHOUND_FETCH_LCM its release 1.5.0, built once by the host's compiler into .deps/lcm (needs GLib).
option(MOTEHOUND_FETCH_LCM "download LCM from its upstream repository instead of using the system's" OFF)
set(lcm_cmake ${CMAKE_CURRENT_LIST_DIR})
set(lcm_fetched ${CMAKE_CURRENT_LIST_DIR}/../.deps/lcm)
if(MOTEHOUND_FETCH_LCM AND NOT EXISTS ${lcm_fetched}/bin/lcm-gen)
  include(FetchContent)
  FetchContent_Declare(lcm URL https://github.com/lcm-proj/lcm/archive/refs/tags/v1.5.0.tar.gz
    URL_HASH SHA256=590a7d996daa3d33a7f3094e4054c35799a3d7a4780d732be78971323e730eeb
    SOURCE_SUBDIR no-cmake-here) # lcm-gen runs on the host, so it is not part of a build for a board
  FetchContent_MakeAvailable(lcm)
  set(languages -DLCM_ENABLE_JAVA=OFF -DLCM_ENABLE_LUA=OFF -DLCM_ENABLE_PYTHON=OFF -DLCM_ENABLE_GO=OFF)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${lcm_SOURCE_DIR} -B ${lcm_BINARY_DIR} -DCMAKE_BUILD_TYPE=Release ${languages}
    -DLCM_ENABLE_TESTS=OFF -DLCM_ENABLE_EXAMPLES=OFF -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_INSTALL_PREFIX=${lcm_fetched} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${lcm_BINARY_DIR} --target install COMMAND_ERROR_IS_FATAL ANY)
endif()
if(MOTEHOUND_FETCH_LCM)
  set(lcm_hints ${lcm_fetched})
  find_library(LCM_LIBRARY lcm PATHS ${lcm_fetched}/lib NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
endif()
find_program(LCM_GEN lcm-gen HINTS ${lcm_hints}/bin NO_CMAKE_FIND_ROOT_PATH)
find_file(LCM_CORETYPES lcm/lcm_coretypes.h PATHS ${lcm_hints}/include /usr/include /usr/local/include NO_DEFAULT_PATH
          NO_CMAKE_FIND_ROOT_PATH)
if(NOT LCM_GEN OR NOT LCM_CORETYPES)
  message(FATAL_ERROR "LCM not found: run tools/setup, install the packages liblcm-dev and liblcm-bin, or pass -DMOTEHOUND_FETCH_LCM=ON")
endif()

# lcm_sources(VARIABLE FOLDER FILES... [NO_PUBSUB]): the sources and headers themselves, made in FOLDER, for a target of another kind.
function(lcm_sources variable out)
  cmake_parse_arguments(ARG "NO_PUBSUB" "" "FILES" ${ARGN})
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
  set(then)
  if(ARG_NO_PUBSUB)
    set(mode --c-no-pubsub)
    set(then COMMAND ${CMAKE_COMMAND} -DFOLDER=${out} -P ${lcm_cmake}/LcmWithoutCaches.cmake)
  endif()
  add_custom_command(OUTPUT ${sources} ${headers} DEPENDS ${ARG_FILES} VERBATIM
    COMMAND ${LCM_GEN} -c ${mode} --c-cpath ${out} --c-hpath ${out} ${ARG_FILES}
    ${then})
  set(${variable} ${sources} ${headers} PARENT_SCOPE)
endfunction()

function(lcm_generate target)
  cmake_parse_arguments(ARG "NO_PUBSUB" "" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${target})
  lcm_sources(sources ${out} ${ARGN})
  add_library(${target} STATIC ${sources})
  target_include_directories(${target} SYSTEM PUBLIC ${out})
  if(MOTEHOUND_FETCH_LCM AND NOT ARG_NO_PUBSUB)
    target_include_directories(${target} SYSTEM PUBLIC ${lcm_fetched}/include)
  endif()
endfunction()
