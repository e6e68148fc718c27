# cmake -D COMMAND=... -D STATUS=n -D OUTPUT=text -P expect.cmake: passes if COMMAND ends with exactly that status and says OUTPUT.
# ctest's WILL_FAIL takes any failure for the expected one, a crash included.
execute_process(COMMAND ${COMMAND} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
if(NOT status STREQUAL "${STATUS}" OR NOT "${out}${err}" MATCHES "${OUTPUT}")
  message(FATAL_ERROR "wanted status ${STATUS} and '${OUTPUT}', got status ${status}:\n${out}${err}")
endif()
