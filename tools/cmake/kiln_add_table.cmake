# kiln_add_table(TARGET name MANIFEST file OUTPUT file
#                [HEADER file] [TARGETS name...] [SCENES file...] [CACHE folder] [OPTIONS option...])
#
# Adds the target `name`, part of `all`, which builds the variant table OUTPUT and OUTPUT.proof from MANIFEST. The table is
# built again when the manifest, a scene, any file that a shader includes, or kiln itself changes, and not otherwise.
#
#   HEADER   also writes a C++ header with the key's bit fields; linking to `name` puts its folder on the include path and
#            builds it first. Its time stamp changes only when its text does.
#   TARGETS  target languages instead of the manifest's, such as spirv essl300 msl21
#   SCENES   keeps only the variants that these scenes need
#   CACHE    a cache folder, or "none"; default is the user's
#   OPTIONS  further options of `kiln build`, such as -g
#
# MANIFEST and SCENES are relative to the source folder, OUTPUT and HEADER to the binary folder. The target has the
# property KILN_TABLE, the full path of OUTPUT. Needs CMake 3.20 with Ninja or Makefiles (depfiles).

cmake_policy(PUSH)
cmake_policy(VERSION 3.20...3.25)

function(kiln_add_table)
  cmake_parse_arguments(PARSE_ARGV 0 K "" "TARGET;MANIFEST;OUTPUT;HEADER;CACHE" "TARGETS;SCENES;OPTIONS")
  if(DEFINED K_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "kiln_add_table: unknown argument '${K_UNPARSED_ARGUMENTS}'")
  endif()
  if(DEFINED K_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "kiln_add_table: nothing follows '${K_KEYWORDS_MISSING_VALUES}'")
  endif()
  foreach(required IN ITEMS TARGET MANIFEST OUTPUT)
    if(NOT DEFINED K_${required})
      message(FATAL_ERROR "kiln_add_table: ${required} is missing")
    endif()
  endforeach()

  get_filename_component(manifest "${K_MANIFEST}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
  get_filename_component(output "${K_OUTPUT}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
  if(NOT EXISTS "${manifest}")
    get_source_file_property(generated "${manifest}" GENERATED)
    if(NOT generated)
      message(FATAL_ERROR "kiln_add_table: no manifest '${manifest}'")
    endif()
  endif()
  set(arguments "")
  set(sources "${manifest}")
  set(products "${output}.proof")
  foreach(scene IN LISTS K_SCENES)
    get_filename_component(scene "${scene}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
    list(APPEND arguments --scene "${scene}")
    list(APPEND sources "${scene}")
  endforeach()
  foreach(target IN LISTS K_TARGETS)
    list(APPEND arguments --target "${target}")
  endforeach()
  if(DEFINED K_HEADER)
    get_filename_component(header "${K_HEADER}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
    list(APPEND arguments --header "${header}")
    list(APPEND products "${header}")
  endif()
  if(DEFINED K_CACHE)
    list(APPEND arguments --cache "${K_CACHE}")
  endif()

  # Proof and header are by-products: an unchanged header keeps its old time stamp, which must not look out of date.
  get_filename_component(name "${output}" NAME)
  add_custom_command(
    OUTPUT "${output}"
    BYPRODUCTS ${products}
    COMMAND kiln::kiln build "${manifest}" -o "${output}" --depfile "${output}.d" ${arguments} ${K_OPTIONS}
    DEPENDS ${sources} kiln::kiln
    DEPFILE "${output}.d"
    COMMENT "Building variant table ${name}"
    VERBATIM)

  add_library("${K_TARGET}" INTERFACE)
  target_sources("${K_TARGET}" PRIVATE "${output}")
  set_target_properties("${K_TARGET}" PROPERTIES KILN_TABLE "${output}")
  if(DEFINED K_HEADER)
    get_filename_component(folder "${header}" DIRECTORY)
    target_include_directories("${K_TARGET}" INTERFACE "${folder}")
  endif()
endfunction()

cmake_policy(POP)
