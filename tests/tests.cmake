# The tests; included by CMakeLists.txt, whose folder paths are relative to.

set(shape_files
    tests/shapes/shapes.cpp
    tests/shapes/generators.cpp
    tests/shapes/catmull_clark_shapes.cpp
    tests/shapes/odd_shapes.cpp
    tests/shapes/loop_shapes.cpp
    tests/shapes/face_varying_shapes.cpp
    tests/shapes/random_mesh.cpp
    tests/shapes/tessellation_checks.cpp
)
set(test_files
    tests/control_mesh_test.cpp
    tests/topology_test.cpp
    tests/build_control_test.cpp
    tests/refined_grid_test.cpp
    tests/refinement_test.cpp
    tests/stencil_table_test.cpp
    tests/quad_star_test.cpp
    tests/patch_table_test.cpp
    tests/curvature_test.cpp
    tests/schemes/curve_test.cpp
    tests/schemes/b_spline_test.cpp
    tests/schemes/spline_mesh_test.cpp
    tests/schemes/obj_surfaces_test.cpp
    tests/schemes/stam.cpp
    tests/schemes/exact_evaluation_test.cpp
    tests/batch_test.cpp
    tests/batch_list_test.cpp
    tests/mesh_edit_test.cpp
    tests/slot_ranges_test.cpp
    tests/crowd_test.cpp
    tests/skinning_test.cpp
    tests/tess_pattern_test.cpp
    tests/tessellate_test.cpp
    tests/obj_test.cpp
    tests/packed_normal_test.cpp
    tests/c/c_parity_test.cpp
    tests/c/c_changes_test.cpp
    tests/c/c_schemes_test.cpp
    tests/c/c_pins.cpp
    tests/baked_file_test.cpp
)
set(scheme_test_files
    tests/schemes/scheme_meshes.cpp
    tests/schemes/scheme_invariants_test.cpp
    tests/schemes/scheme_goldens_test.cpp
    tests/schemes/quad_schemes_test.cpp
    tests/schemes/scheme_masks_test.cpp
    tests/schemes/nurss_test.cpp
    tests/schemes/scheme_limit_test.cpp
    tests/schemes/scheme_samples_test.cpp
    tests/schemes/doo_sabin_patches_test.cpp
    tests/schemes/adaptive_test.cpp
    tests/schemes/t_mesh_test.cpp
    tests/schemes/scheme_analysis_test.cpp
)
set(vulkan_test_files
    tests/vulkan/context_test.cpp
    tests/vulkan/synchronization_test.cpp
    tests/vulkan/engine.cpp
    tests/vulkan/engine_scene.cpp
    tests/vulkan/engine_test.cpp
    tests/vulkan/frames_test.cpp
    tests/vulkan/layout_test.cpp
    tests/vulkan/stencil_eval_test.cpp
    tests/vulkan/curve_eval_test.cpp
    tests/vulkan/refine_on_device_test.cpp
    tests/vulkan/scheme_test.cpp
    tests/vulkan/scheme_evaluator_test.cpp
    tests/vulkan/surface_eval_test.cpp
    tests/vulkan/curvature_eval_test.cpp
    tests/vulkan/tree_eval_test.cpp
    tests/vulkan/device_tessellation.cpp
    tests/vulkan/tessellation_parity.cpp
    tests/vulkan/tessellator_test.cpp
    tests/vulkan/displacement_test.cpp
    tests/vulkan/batch_test.cpp
    tests/vulkan/crowd_test.cpp
    tests/vulkan/table_update_test.cpp
    tests/vulkan/instances_test.cpp
    tests/vulkan/skinning_test.cpp
    tests/vulkan/baked_test.cpp
)
set(viewer_test_files
    tests/viewer/test_mesh.cpp
    tests/viewer/leaks.cpp
    tests/viewer/camera_test.cpp
    tests/viewer/picture_test.cpp
    tests/viewer/renderer_test.cpp
    tests/viewer/hardware_test.cpp
)
set(conformance_test_files
    tests/conformance/osd_refiner.cpp
    tests/conformance/osd_oracle.cpp
    tests/conformance/osd_patch_oracle.cpp
    tests/conformance/neighbourhood.cpp
    tests/conformance/refinement_checks.cpp
    tests/conformance/refinement_conformance_test.cpp
    tests/conformance/deep_refinement_test.cpp
    tests/conformance/random_conformance_test.cpp
    tests/conformance/patch_checks.cpp
    tests/conformance/patch_checks_test.cpp
    tests/conformance/patch_conformance_test.cpp
    tests/conformance/patch_deep_test.cpp
    tests/conformance/osd_patches.cpp
    tests/conformance/gregory_conformance_test.cpp
    tests/conformance/end_cap_conformance_test.cpp
    tests/conformance/tessellation_conformance_test.cpp
    tests/osd/osd_patch_test.cpp
)

enable_testing()
find_package(GTest REQUIRED)

add_library(limn_shapes STATIC ${shape_files})
limn_set_compile_options(limn_shapes)
target_include_directories(limn_shapes PUBLIC tests)
target_link_libraries(limn_shapes PUBLIC limn)

function(limn_add_test target label)
    add_executable(${target} ${ARGN})
    limn_set_compile_options(${target})
    target_link_libraries(${target} PRIVATE limn_shapes GTest::gtest_main)
    # A test's own code takes the compiler longer than it runs.
    target_compile_options(${target} PRIVATE $<$<AND:$<CXX_COMPILER_ID:GNU,Clang>,$<CONFIG:Release>>:-O1>)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES LABELS ${label} TIMEOUT 900)
endfunction()

if(LIMN_BUILD_FUZZERS)
    add_executable(limn_baked_file_fuzz tests/fuzz/baked_file_fuzz.cpp)
    target_link_options(limn_baked_file_fuzz PRIVATE -fsanitize=fuzzer)
    add_executable(limn_baked_file_seeds tests/fuzz/baked_file_seeds.cpp)
    foreach(target limn_baked_file_fuzz limn_baked_file_seeds)
        limn_set_compile_options(${target})
        target_link_libraries(${target} PRIVATE limn_shapes TBB::tbb)
    endforeach()
endif()

find_package(Eigen3 REQUIRED NO_MODULE)
limn_add_test(limn_test cpu ${test_files})
target_link_libraries(limn_test PRIVATE Eigen3::Eigen)
target_compile_definitions(limn_test PRIVATE
    LIMN_EXACT_EVALUATION="${CMAKE_CURRENT_SOURCE_DIR}/tests/schemes/exact_evaluation.txt")

find_package(nlohmann_json REQUIRED)
find_package(Eigen3 REQUIRED)
limn_add_test(limn_scheme_test cpu ${scheme_test_files})
target_link_libraries(limn_scheme_test PRIVATE nlohmann_json::nlohmann_json Eigen3::Eigen)
target_compile_definitions(limn_scheme_test PRIVATE
    LIMN_SCHEME_CHECKS="${CMAKE_CURRENT_SOURCE_DIR}/tests/schemes/scheme_checks.json")
if(TARGET limn_scheme_peers)
    limn_add_test(limn_scheme_peers_test cpu
        tests/schemes/scheme_meshes.cpp tests/schemes/scheme_peers_test.cpp)
    target_link_libraries(limn_scheme_peers_test PRIVATE limn_scheme_peers nlohmann_json::nlohmann_json)
    target_compile_definitions(limn_scheme_peers_test PRIVATE
        LIMN_SCHEME_CHECKS="${CMAKE_CURRENT_SOURCE_DIR}/tests/schemes/scheme_checks.json")
endif()

enable_language(C)
function(limn_add_c_test target label)
    add_executable(${target} ${ARGN})
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
    target_compile_options(${target} PRIVATE $<$<C_COMPILER_ID:GNU,Clang>:-Wall -Wextra -Wpedantic -Werror>)
    target_link_libraries(${target} PRIVATE limn $<$<PLATFORM_ID:Linux>:m>)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES LABELS ${label})
endfunction()
limn_add_c_test(limn_c_test cpu tests/c/c_api_test.c)
if(LIMN_BUILD_VULKAN)
    limn_add_test(limn_vulkan_test vulkan ${vulkan_test_files})
    target_link_libraries(limn_vulkan_test PRIVATE limn_vulkan Vulkan::Vulkan)
    target_compile_definitions(limn_vulkan_test PRIVATE
        LIMN_SPIRV_DIR="${CMAKE_CURRENT_BINARY_DIR}/kernels"
        LIMN_LAYER_DIR="${CMAKE_CURRENT_BINARY_DIR}/layers")

    # A layer for tests: two queue families where the device has one.
    add_library(limn_two_queues MODULE tests/vulkan/two_queues.cpp)
    limn_set_compile_options(limn_two_queues)
    target_link_libraries(limn_two_queues PRIVATE Vulkan::Headers)
    file(READ tests/vulkan/two_queues.json manifest)
    string(REPLACE "two_queues_library" "$<TARGET_FILE:limn_two_queues>" manifest "${manifest}")
    file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/layers/two_queues.json CONTENT "${manifest}")
    add_dependencies(limn_vulkan_test limn_two_queues)
    limn_add_c_test(limn_c_vulkan_test vulkan tests/c/c_vulkan_test.c)
    target_link_libraries(limn_c_vulkan_test PRIVATE limn_vulkan Vulkan::Vulkan)
    limn_add_test(limn_c_parity_test vulkan
        tests/c/c_vulkan_parity_test.cpp tests/c/c_vulkan_tessellation_test.cpp tests/c/c_vulkan_changes_test.cpp
        tests/c/c_vulkan_pins.cpp)
    target_link_libraries(limn_c_parity_test PRIVATE limn_vulkan Vulkan::Vulkan)

    if(LIMN_SANITIZE)  # drivers leak
        set_tests_properties(limn_vulkan_test limn_c_vulkan_test limn_c_parity_test PROPERTIES ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
    endif()

    find_program(LIMN_SPIRV_VAL spirv-val REQUIRED)
    foreach(kernel IN LISTS kernels)
        add_test(NAME spirv_val.${kernel}
                 COMMAND ${LIMN_SPIRV_VAL} --target-env vulkan1.2 ${CMAKE_CURRENT_BINARY_DIR}/kernels/${kernel}.spv)
        set_tests_properties(spirv_val.${kernel} PROPERTIES LABELS vulkan)
    endforeach()
endif()
if(LIMN_BUILD_PROGRAM)
    limn_add_test(limn_program_test program
        tests/program_test.cpp tests/scheme_program_test.cpp tests/tessellate_program_test.cpp tests/bake_program_test.cpp tests/gltf_test.cpp)
    target_link_libraries(limn_program_test PRIVATE limn_gltf nlohmann_json::nlohmann_json)
    target_compile_definitions(limn_program_test PRIVATE
        LIMN_PROGRAM="$<TARGET_FILE:limn_program>"
        LIMN_DEMO_MODEL="${CMAKE_CURRENT_SOURCE_DIR}/tests/shapes/demo.obj")
    add_dependencies(limn_program_test limn_program)
    if(TARGET limn_viewer)
        target_compile_definitions(limn_program_test PRIVATE
            $<TARGET_PROPERTY:limn_viewer,INTERFACE_COMPILE_DEFINITIONS>)
    endif()
endif()
if(TARGET limn_bench)
    limn_add_test(limn_bench_test bench tests/bench_test.cpp tests/osd_samples_test.cpp)
    target_link_libraries(limn_bench_test PRIVATE limn_bench nlohmann_json::nlohmann_json)
    if(LIMN_BUILD_PROGRAM)
        target_sources(limn_bench_test PRIVATE tests/bench_program_test.cpp)
        target_compile_definitions(limn_bench_test PRIVATE
            LIMN_PROGRAM="$<TARGET_FILE:limn_program>"
            LIMN_DEMO_MODEL="${CMAKE_CURRENT_SOURCE_DIR}/tests/shapes/demo.obj")
        add_dependencies(limn_bench_test limn_program)
    endif()
endif()
if(TARGET limn_viewer)
    limn_add_test(limn_viewer_test viewer ${viewer_test_files})
    target_link_libraries(limn_viewer_test PRIVATE limn_viewer PNG::PNG)
    if(LIMN_SANITIZE)  # drivers leak
        set_tests_properties(limn_viewer_test PROPERTIES ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
    endif()
    if(TARGET glfw)
        list(APPEND shaders ${window_shaders})
    endif()
    foreach(shader IN LISTS shaders)
        string(REPLACE "." "_" name ${shader})
        add_test(NAME spirv_val.${name}
                 COMMAND ${LIMN_SPIRV_VAL} --target-env vulkan1.2 ${CMAKE_CURRENT_BINARY_DIR}/shaders/${name}.spv)
        set_tests_properties(spirv_val.${name} PROPERTIES LABELS viewer)
    endforeach()
endif()
if(TARGET limn_opensubdiv)
    limn_add_test(limn_conformance_test conformance ${conformance_test_files})
    target_link_libraries(limn_conformance_test PRIVATE limn_opensubdiv)
endif()

if(TARGET limn_osd)
    limn_add_test(limn_osd_test osd tests/osd/osd_evaluator_test.cpp tests/osd/osd_docs_test.cpp tests/conformance/osd_refiner.cpp)
    target_link_libraries(limn_osd_test PRIVATE limn_osd limn_opensubdiv Vulkan::Vulkan)
    if(LIMN_SANITIZE)  # drivers leak
        set_tests_properties(limn_osd_test PROPERTIES ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
    endif()
    foreach(kernel IN LISTS osd_kernels)
        add_test(NAME spirv_val.${kernel}
                 COMMAND ${LIMN_SPIRV_VAL} --target-env vulkan1.2 ${CMAKE_CURRENT_BINARY_DIR}/kernels/${kernel}.spv)
        set_tests_properties(spirv_val.${kernel} PROPERTIES LABELS osd)
    endforeach()
elseif(LIMN_BUILD_VULKAN)
    message(WARNING "limn::osd is not built: its tests are left out.")
endif()

add_test(NAME layering COMMAND ${CMAKE_COMMAND}
    "-Dflow=${shared_headers};${limn_files};${vulkan_files};${osd_files}" -P tests/layering.cmake
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
function(limn_add_snippet name page source marker)
    add_test(NAME snippet.${name} COMMAND ${CMAKE_COMMAND} -Dpage=${page} -Dsource=${source} -Dmarker=${marker}
        -P tests/snippets.cmake WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set_tests_properties(snippet.${name} PROPERTIES LABELS packaging)
endfunction()
limn_add_snippet(readme README.md src/example/renderer.cpp readme)
limn_add_snippet(integrating docs/integrating.md tests/docs/vma_allocator.cpp docs)
limn_add_snippet(crowd docs/integrating.md tests/docs/crowd_frame.cpp docs)
limn_add_snippet(migrating docs/migrating_from_opensubdiv.md tests/osd/osd_docs_test.cpp docs)
set_tests_properties(layering PROPERTIES LABELS packaging)
if(LIMN_BUILD_VULKAN)
    add_library(docs_code OBJECT tests/docs/vma_allocator.cpp tests/docs/crowd_frame.cpp)
    limn_set_compile_options(docs_code)
    target_link_libraries(docs_code PRIVATE limn_vulkan)
endif()
if(TARGET docs)
    add_test(NAME docs COMMAND ${CMAKE_COMMAND} --build ${CMAKE_CURRENT_BINARY_DIR} --target docs)
    set_tests_properties(docs PROPERTIES LABELS packaging)
else()
    message(WARNING "doxygen is not here (Debian: doxygen): the reference is not built, nor tested.")
endif()
add_test(NAME symbols COMMAND ${CMAKE_COMMAND}
    "-Dlibraries=$<TARGET_FILE:limn>$<$<BOOL:${LIMN_BUILD_VULKAN}>:;$<TARGET_FILE:limn_vulkan>>" -Dnm=${CMAKE_NM}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/tests/symbols.cmake)
set_tests_properties(symbols PROPERTIES LABELS packaging)
# Compiles each public header alone (CMake 3.24 or later).
if(NOT CMAKE_VERSION VERSION_LESS 3.24)
    add_test(NAME public_headers COMMAND ${CMAKE_COMMAND}
        --build ${CMAKE_CURRENT_BINARY_DIR} --target all_verify_interface_header_sets)
    set_tests_properties(public_headers PROPERTIES LABELS packaging)
endif()

if(LIMN_INSTALL AND LIMN_BUILD_VULKAN AND NOT LIMN_SANITIZE)
    set(consumer ${CMAKE_CURRENT_BINARY_DIR}/consumer)
    add_test(NAME consumer.clean COMMAND ${CMAKE_COMMAND} -E rm -rf ${consumer}/prefix)
    add_test(NAME consumer.install COMMAND ${CMAKE_COMMAND}
        --install ${CMAKE_CURRENT_BINARY_DIR} --config $<CONFIG> --prefix ${consumer}/prefix)
    # On the installed package, whose headers a program without exceptions and RTTI includes, as all of the library is
    # built; then with the sources as a part of the project: shared, in Debug, and with Clang where it is.
    set(bare_flags -DCMAKE_CXX_FLAGS=-fno-exceptions\ -fno-rtti)
    find_program(LIMN_CLANG NAMES clang++-14 clang++)
    set(other_compiler ${LIMN_CLANG})
    if(NOT LIMN_CLANG)
        set(other_compiler ${CMAKE_CXX_COMPILER})
    endif()
    add_test(NAME consumer.find_package COMMAND ${CMAKE_CTEST_COMMAND}
        --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/tests/consumer ${consumer}/find_package
        --build-generator ${CMAKE_GENERATOR} --build-noclean
        --build-options -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_PREFIX_PATH=${consumer}/prefix
            ${bare_flags}
        --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure)
    add_test(NAME consumer.add_subdirectory COMMAND ${CMAKE_CTEST_COMMAND}
        --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/tests/consumer ${consumer}/add_subdirectory_shared
        --build-generator ${CMAKE_GENERATOR} --build-noclean
        --build-options -DCMAKE_CXX_COMPILER=${other_compiler} -DLIMN_SOURCE_DIR=${CMAKE_CURRENT_SOURCE_DIR}
            -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=ON ${bare_flags}
        --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure)
    set_tests_properties(consumer.clean PROPERTIES FIXTURES_SETUP consumer_clean)
    set_tests_properties(consumer.install PROPERTIES
        FIXTURES_REQUIRED consumer_clean FIXTURES_SETUP consumer_prefix)
    set_tests_properties(consumer.find_package PROPERTIES FIXTURES_REQUIRED consumer_prefix)
    set_tests_properties(consumer.add_subdirectory PROPERTIES TIMEOUT 900)
    set_tests_properties(consumer.clean consumer.install consumer.find_package consumer.add_subdirectory
        PROPERTIES LABELS packaging)

    # Without CMake: what pkg-config says is all that a compiler is told, in C++ and in C.
    find_program(LIMN_PKG_CONFIG NAMES pkg-config pkgconf)
    function(limn_add_pkg_config_test name package compiler flags source)
        add_test(NAME consumer.${name} COMMAND ${CMAKE_COMMAND} -Dpackage=${package} -Dprefix=${consumer}/prefix
            -Dpkg_config=${LIMN_PKG_CONFIG} -Dcompiler=${compiler} -Dflags=${flags}
            -Dsource=${CMAKE_CURRENT_SOURCE_DIR}/tests/${source} -Doutput=${consumer}/pkg_config/${name}
            -P ${CMAKE_CURRENT_SOURCE_DIR}/tests/consumer/pkg_config.cmake)
        set_tests_properties(consumer.${name} PROPERTIES FIXTURES_REQUIRED consumer_prefix LABELS packaging
            ENVIRONMENT LD_LIBRARY_PATH=${consumer}/prefix/${CMAKE_INSTALL_LIBDIR})
    endfunction()
    if(LIMN_PKG_CONFIG)
        limn_add_pkg_config_test(pkg_config limn ${CMAKE_CXX_COMPILER} -std=c++20 consumer/consumer.cpp)
        limn_add_pkg_config_test(pkg_config_vulkan limn-vulkan ${CMAKE_CXX_COMPILER} -std=c++20 consumer/vulkan_consumer.cpp)
        limn_add_pkg_config_test(pkg_config_c limn ${CMAKE_C_COMPILER} -std=c99 c/c_api_test.c)
        if(TARGET limn_osd)
            limn_add_pkg_config_test(pkg_config_osd limn-osd ${CMAKE_CXX_COMPILER} -std=c++20 consumer/osd_consumer.cpp)
        endif()
    else()
        message(WARNING "pkg-config is not here (Debian: pkgconf): its files are not tested.")
    endif()

    # The example, as whoever copies it builds it; two runs must draw the same closed surface.
    find_package(PNG)
    if(PNG_FOUND)
        set(example ${CMAKE_CURRENT_BINARY_DIR}/example)
        set(run_example ${example}/example --validation --frames 12 --size 360x480 -o)
        add_executable(example_picture tests/example_picture.cpp)
        limn_set_compile_options(example_picture)
        target_link_libraries(example_picture PRIVATE PNG::PNG)
        add_test(NAME example.build COMMAND ${CMAKE_CTEST_COMMAND}
            --build-and-test ${CMAKE_CURRENT_SOURCE_DIR}/src/example ${example}
            --build-generator ${CMAKE_GENERATOR} --build-noclean
            --build-options -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_PREFIX_PATH=${consumer}/prefix
                -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wconversion -Wno-missing-field-initializers -Werror")
        add_test(NAME example.run COMMAND ${run_example} ${example}/first.png)
        add_test(NAME example.run_again COMMAND ${run_example} ${example}/second.png)
        add_test(NAME example.picture COMMAND example_picture ${example}/first.png ${example}/second.png)
        set_tests_properties(example.build PROPERTIES
            FIXTURES_REQUIRED consumer_prefix FIXTURES_SETUP example)
        set_tests_properties(example.run example.run_again PROPERTIES
            FIXTURES_REQUIRED "consumer_prefix;example" FIXTURES_SETUP example_pictures)
        set_tests_properties(example.picture PROPERTIES FIXTURES_REQUIRED example_pictures)
        set_tests_properties(example.build example.run example.run_again example.picture
            PROPERTIES LABELS packaging)
    else()
        message(WARNING "libpng is not here (Debian: libpng-dev): the example is not tested.")
    endif()
endif()
