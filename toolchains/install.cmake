# cmake --install: archive, headers and the package file of find_package(cairn).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(cairn_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cairn)

set(cairn_c_libraries "")
foreach(config IN LISTS CAIRN_C_CONFIGS)
  if(config STREQUAL default)
    list(APPEND cairn_c_libraries cairn_c)
  elseif(config MATCHES "^(tiny|large)$")
    list(APPEND cairn_c_libraries cairn_c_${config})
  else()
    message(FATAL_ERROR "CAIRN_C_CONFIGS: expected default, tiny or large, found '${config}'")
  endif()
endforeach()
install(TARGETS cairn_core cairn_numerics ${cairn_c_libraries} EXPORT cairn COMPONENT cairn)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT cairn)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/cairn COMPONENT cairn)
install(EXPORT cairn NAMESPACE cairn:: FILE cairnTargets.cmake DESTINATION ${cairn_package_dir} COMPONENT cairn)

# Before 1.0 a minor version may change the interface.
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/cairnConfig.cmake.in
  ${PROJECT_BINARY_DIR}/package/cairnConfig.cmake INSTALL_DESTINATION ${cairn_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/cairnConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/cairnConfig.cmake ${PROJECT_BINARY_DIR}/package/cairnConfigVersion.cmake
  DESTINATION ${cairn_package_dir} COMPONENT cairn)
