# cmake -DFOLDER=... -P: lcm-gen's code in it keeps each type's fingerprint in RAM, computed on first use. Motes ask for it without (_hash_recursive), but its
# 10 bytes a type would stay; so they go.
file(GLOB sources ${FOLDER}/*.c)
foreach(source ${sources})
  file(READ ${source} code)
  string(REGEX REPLACE "static int (__[a-z0-9_]+)_hash_computed;\nstatic uint64_t __[a-z0-9_]+_hash;\n" "" less "${code}")
  string(REGEX REPLACE "    if \\(!(__[a-z0-9_]+)_hash_computed\\) {\n[^}]*}\n\n    return __[a-z0-9_]+_hash;" "    return (int64_t)\\1_hash_recursive(NULL);" less "${less}")
  if(NOT less STREQUAL code)
    file(WRITE ${source} "${less}")
  endif()
endforeach()
