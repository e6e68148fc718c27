# cmake --install: the library for find_package(motehound) and pkg-config, its component `library`; the simulator is the component `simulator`.
# The definitions that the library was built with (capacities, arithmetic) come with both: its structures have the same size in a user's code.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(headers ${CMAKE_INSTALL_INCLUDEDIR})
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/motehound)

target_include_directories(motehound INTERFACE $<INSTALL_INTERFACE:${headers}> $<INSTALL_INTERFACE:${headers}/motehound/wire>)
install(TARGETS motehound EXPORT motehound ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY firmware/include/motehound DESTINATION ${headers} COMPONENT library FILES_MATCHING PATTERN "*.h")
# what messages are declared with: lcm-gen's headers, and the one of LCM that they include, with its licence
install(DIRECTORY ${PROJECT_BINARY_DIR}/firmware/mh_radio/ DESTINATION ${headers}/motehound/wire COMPONENT library FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE lcm_types/LGPL-2.1.txt DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/motehound COMPONENT library)

install(EXPORT motehound NAMESPACE motehound:: FILE motehound-targets.cmake DESTINATION ${package} COMPONENT library)
configure_package_config_file(cmake/motehound-config.cmake.in ${PROJECT_BINARY_DIR}/motehound-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/motehound-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/motehound-config.cmake ${PROJECT_BINARY_DIR}/motehound-config-version.cmake
        DESTINATION ${package} COMPONENT library)

get_target_property(definitions motehound INTERFACE_COMPILE_DEFINITIONS)
if(NOT definitions)
  set(definitions)
endif()
list(TRANSFORM definitions PREPEND -D)
list(JOIN definitions " " definitions)
file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" up ${up})
configure_file(cmake/motehound.pc.in ${PROJECT_BINARY_DIR}/motehound.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/motehound.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
