# Gives target unity::unity (C unit-test framework by ThrowTheSwitch, not the desktop).
# 1. UNITY_ROOT (cache or environment): a folder with src/unity.c; 2. <repo>/.deps/unity; 3. FetchContent if asked.
option(UNITY_FETCH "download Unity from its upstream repository" OFF)
set(UNITY_ROOT "$ENV{UNITY_ROOT}" CACHE PATH "folder that holds Unity's src/unity.c")
find_path(UNITY_SOURCE_DIR NAMES unity.c PATHS ${UNITY_ROOT} ${CMAKE_CURRENT_LIST_DIR}/../.deps/unity
          PATH_SUFFIXES src NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
if(NOT UNITY_SOURCE_DIR AND UNITY_FETCH)
  include(FetchContent)
  FetchContent_Declare(unity_src GIT_REPOSITORY https://github.com/ThrowTheSwitch/Unity.git
                       GIT_TAG cbcd08fa7de711053a3deec6339ee89cad5d2697   # v2.6.1 (v2.7.0 = b6763fbd9cedfacaa89e2ad9fd00d615a234e355)
                       SOURCE_SUBDIR no-cmake-here)                       # take the sources, not its -Werror build
  FetchContent_MakeAvailable(unity_src)
  set(UNITY_SOURCE_DIR ${unity_src_SOURCE_DIR}/src)
endif()
if(NOT UNITY_SOURCE_DIR)
  message(FATAL_ERROR "Unity not found: run tools/setup, set UNITY_ROOT, or pass -DUNITY_FETCH=ON")
endif()
file(STRINGS ${UNITY_SOURCE_DIR}/unity.h _v REGEX "^#define UNITY_VERSION_(MAJOR|MINOR|BUILD)")
string(REGEX REPLACE "[^0-9;]" "" _v "${_v}")
string(REPLACE ";" "." UNITY_VERSION "${_v}")
message(STATUS "Unity ${UNITY_VERSION} from ${UNITY_SOURCE_DIR}")
if(UNITY_VERSION VERSION_LESS 2.5)
  message(FATAL_ERROR "Unity >= 2.5 wanted")
endif()
add_library(unity STATIC ${UNITY_SOURCE_DIR}/unity.c)
add_library(unity::unity ALIAS unity)
target_include_directories(unity SYSTEM PUBLIC ${UNITY_SOURCE_DIR})
