# find_package(radiafit) gives radiafit::core: problems, optimizers, devices, datasets, the judge, synthetic datasets. Importers
# and the rivals (Ceres) are apart: they are the program's alone.
include(CMakePackageConfigHelpers)
get_target_property(core_layers radiafit_core INTERFACE_LINK_LIBRARIES)
list(TRANSFORM core_layers REPLACE "^radiafit_" "")
set(core_targets radiafit_core radiafit_headers)
foreach(layer IN LISTS core_layers)
  list(APPEND core_targets radiafit_${layer})
  set_target_properties(radiafit_${layer} PROPERTIES EXPORT_NAME ${layer})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/core/${layer} DESTINATION include/radiafit FILES_MATCHING PATTERN *.h
          PATTERN web EXCLUDE)
endforeach()
set_target_properties(radiafit_core PROPERTIES EXPORT_NAME core)
set_target_properties(radiafit_headers PROPERTIES EXPORT_NAME headers)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/model ${PROJECT_SOURCE_DIR}/shaders/optimize DESTINATION include/radiafit
        FILES_MATCHING PATTERN *.glsl)
install(DIRECTORY ${PROJECT_BINARY_DIR}/src/core/model/generated/model DESTINATION include/radiafit)
install(TARGETS ${core_targets} EXPORT radiafit ARCHIVE DESTINATION lib/radiafit)
install(EXPORT radiafit NAMESPACE radiafit:: FILE radiafit-targets.cmake DESTINATION lib/cmake/radiafit)
file(WRITE ${PROJECT_BINARY_DIR}/radiafit-config.cmake "include(CMakeFindDependencyMacro)
foreach(package fmt Threads Eigen3 OpenEXR PNG ZLIB)
  find_dependency(\${package})
endforeach()
include(\${CMAKE_CURRENT_LIST_DIR}/radiafit-targets.cmake)
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/radiafit-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/radiafit-config.cmake ${PROJECT_BINARY_DIR}/radiafit-config-version.cmake
        DESTINATION lib/cmake/radiafit)

# The program, and the modules that it loads when it reads photographs, or when mpirun starts it.
install(TARGETS radiafit RUNTIME DESTINATION bin)
foreach(module radiafit_oiio radiafit_heif radiafit_mpi)
  if(TARGET ${module})
    install(TARGETS ${module} LIBRARY DESTINATION lib/radiafit)
  endif()
endforeach()

# Its manual page and completions, which it prints itself.
set(pages ${PROJECT_BINARY_DIR}/pages)
add_custom_command(
  OUTPUT ${pages}/radiafit.1 ${pages}/radiafit ${pages}/_radiafit ${pages}/radiafit.fish
  COMMAND ${CMAKE_COMMAND} -E make_directory ${pages}
  COMMAND radiafit options --man > ${pages}/radiafit.1
  COMMAND radiafit completion bash > ${pages}/radiafit
  COMMAND radiafit completion zsh > ${pages}/_radiafit
  COMMAND radiafit completion fish > ${pages}/radiafit.fish
  DEPENDS radiafit VERBATIM)
add_custom_target(pages ALL DEPENDS ${pages}/radiafit.1)
# All that is installed, and nothing else: for `make build`.
add_custom_target(installed)
add_dependencies(installed radiafit radiafit-bench pages ${core_targets})
install(FILES ${pages}/radiafit.1 DESTINATION share/man/man1)
install(FILES ${pages}/radiafit DESTINATION share/bash-completion/completions)
install(FILES ${pages}/_radiafit DESTINATION share/zsh/site-functions)
install(FILES ${pages}/radiafit.fish DESTINATION share/fish/vendor_completions.d)
