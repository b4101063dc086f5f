# SPDX-License-Identifier: Apache-2.0
# Lets the CMake configurations inside the ROS wheels serve on this machine; given as -DCMAKE_PROJECT_INCLUDE=<this file>.
#
# The wheels' exported targets name include folders of the machine that built them, and CMake refuses a target whose
# include folder does not exist.  Once everything is found, drop those: the generators add the Python and NumPy headers
# of this machine themselves.  A workspace with an installed ROS does not need this file.

function(drop_missing_include_folders)
  get_property(targets DIRECTORY "${CMAKE_SOURCE_DIR}" PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(folders "${target}" INTERFACE_INCLUDE_DIRECTORIES)
    if(NOT folders)
      continue()
    endif()
    set(present "")
    foreach(folder IN LISTS folders)
      if(NOT IS_ABSOLUTE "${folder}" OR EXISTS "${folder}")
        list(APPEND present "${folder}")
      endif()
    endforeach()
    set_target_properties("${target}" PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${present}")
  endforeach()
endfunction()

cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL drop_missing_include_folders)
