# Files for pkg-config, beside the CMake package; included by CMakeLists.txt.

# limn_install_pkg_config(NAME LIBRARY DESCRIPTION [REQUIRES PACKAGES] [LIBS FLAGS] [CFLAGS FLAGS]): what a program that
# links LIBRARY needs. Paths are relative to the file where those of the installation are, so that it may be moved.
function(limn_install_pkg_config name library description)
    cmake_parse_arguments(PARSE_ARGV 3 arg "" "REQUIRES;LIBS;CFLAGS" "")
    set(prefix ${CMAKE_INSTALL_PREFIX})
    set(libdir ${CMAKE_INSTALL_FULL_LIBDIR})
    set(includedir ${CMAKE_INSTALL_FULL_INCLUDEDIR})
    if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
        file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
        string(REGEX REPLACE "/$" "" prefix "\${pcfiledir}/${up}")
        set(libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
        set(includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
    endif()
    file(CONFIGURE OUTPUT ${name}.pc @ONLY CONTENT [[
prefix=@prefix@
libdir=@libdir@
includedir=@includedir@

Name: @name@
Description: @description@
Version: @PROJECT_VERSION@
Requires: @arg_REQUIRES@
Libs: -L${libdir} -l@library@ @arg_LIBS@
Cflags: -I${includedir} @arg_CFLAGS@
]])
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

# Static libraries leave to the program what they are linked with, a C++ library for programs in C among it.
set(limn_requires "")
set(limn_libs "")
set(vulkan_libs "")
if(NOT BUILD_SHARED_LIBS)
    set(limn_requires tbb)
    set(cxx_library ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
    list(FILTER cxx_library INCLUDE REGEX "^(std)?c\\+\\+$")
    list(TRANSFORM cxx_library PREPEND -l OUTPUT_VARIABLE limn_libs)
    string(JOIN " " limn_libs ${limn_libs} -lm)
    list(TRANSFORM CMAKE_DL_LIBS PREPEND -l OUTPUT_VARIABLE vulkan_libs)
endif()
limn_install_pkg_config(limn limn "${PROJECT_DESCRIPTION}: tables and the CPU" REQUIRES "${limn_requires}" LIBS "${limn_libs}")
if(TARGET limn_vulkan)
    # Vulkan's headers; nothing links to its loader.
    limn_install_pkg_config(limn-vulkan limn_vulkan "${PROJECT_DESCRIPTION}"
        REQUIRES "limn = ${PROJECT_VERSION}" LIBS "${vulkan_libs}" CFLAGS "-I${Vulkan_INCLUDE_DIR}")
endif()
if(TARGET limn_osd)
    get_filename_component(osd_dir ${LIMN_OPENSUBDIV_CPU} DIRECTORY)
    limn_install_pkg_config(limn-osd limn_osd "OpenSubdiv's tables on any Vulkan device"
        REQUIRES "limn-vulkan = ${PROJECT_VERSION}" LIBS "-L${osd_dir} -losdCPU" CFLAGS "-I${LIMN_OPENSUBDIV_INCLUDE_DIR}")
endif()
