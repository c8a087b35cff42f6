# What `cmake --install` puts in place, and the package that find_package(kiln) finds.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/kiln)
set(KILN_SHADERS ${CMAKE_INSTALL_DATADIR}/kiln)

set_target_properties(kiln_cli PROPERTIES EXPORT_NAME kiln)
set_target_properties(kiln_runtime PROPERTIES EXPORT_NAME runtime)
install(TARGETS kiln_cli kiln_runtime EXPORT kilnTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS kiln_worker kiln_cached RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${CMAKE_SOURCE_DIR}/tools/packaging/kiln-cached.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8)
install(FILES ${CMAKE_SOURCE_DIR}/tools/packaging/kiln-cached.service DESTINATION lib/systemd/system)
# Loaded from beside the program (cache/client/grpc_load.cpp), so not where the system keeps its libraries.
install(TARGETS kiln_grpc LIBRARY DESTINATION lib/kiln)
install(FILES ${CMAKE_SOURCE_DIR}/compiler/runtime/kiln.h ${CMAKE_SOURCE_DIR}/compiler/runtime/kiln.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kiln)
install(EXPORT kilnTargets NAMESPACE kiln:: DESTINATION ${package_folder})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/kilnConfig.cmake.in ${CMAKE_BINARY_DIR}/package/kilnConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS KILN_SHADERS)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/kilnConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/kilnConfig.cmake ${CMAKE_BINARY_DIR}/package/kilnConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/kiln_add_table.cmake DESTINATION ${package_folder})

# Manifests name their shaders as ../uber, and schemas stand beside the manifests: both keep their places.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/uber ${CMAKE_SOURCE_DIR}/manifests DESTINATION ${KILN_SHADERS}
  PATTERN reference EXCLUDE)
# The BC encoder of kiln report's lightmaps; `npm install` there fetches the package that it runs.
install(FILES ${CMAKE_SOURCE_DIR}/compiler/bake/encode_bc.mjs ${CMAKE_SOURCE_DIR}/compiler/bake/package.json
  DESTINATION ${KILN_SHADERS}/bake)
