# The benchmarks; included by CMakeLists.txt, whose folder paths are relative to.

set(bench_files
    bench/bench.cpp
    bench/host.cpp
    bench/report.cpp
    bench/compare.cpp
    bench/summary.cpp
    bench/report_json.cpp
    bench/report_page.cpp
    bench/report_html.cpp
    bench/models.cpp
    bench/machines.cpp
    bench/osd.cpp
    bench/osd_stencils.cpp
    bench/osd_patches.cpp
    bench/osd_bfr.cpp
    bench/timestamps.cpp
    bench/limn_stencils.cpp
    bench/limn_patches.cpp
    bench/patch_samples.cpp
    bench/osd_samples.cpp
    bench/limn_osd.cpp
    bench/plain_loops.cpp
    bench/level_bench.cpp
    bench/patch_bench.cpp
    bench/scenarios.cpp
)
file(GLOB scenario_files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS bench/*_bench.cpp)
list(APPEND bench_files ${scenario_files})
list(REMOVE_DUPLICATES bench_files)
set(bench_gl_files
    bench/osd_gl.cpp
    bench/osd_gl_patches.cpp
)

find_package(nlohmann_json REQUIRED)
find_package(OpenGL COMPONENTS OpenGL EGL)

add_library(limn_bench STATIC ${bench_files})
limn_set_compile_options(limn_bench)
target_include_directories(limn_bench INTERFACE bench)
target_link_libraries(limn_bench PUBLIC limn_opensubdiv limn_vulkan limn_osd PRIVATE nlohmann_json::nlohmann_json TBB::tbb)

if(TARGET limn_scheme_peers)
    target_link_libraries(limn_bench PRIVATE limn_scheme_peers)
endif()
if(OpenGL_OpenGL_FOUND AND OpenGL_EGL_FOUND AND LIMN_OPENSUBDIV_GPU)
    target_sources(limn_bench PRIVATE ${bench_gl_files})
    target_compile_definitions(limn_bench PUBLIC LIMN_HAVE_OPENSUBDIV_GL)
    target_link_libraries(limn_bench PUBLIC ${LIMN_OPENSUBDIV_GPU} OpenGL::OpenGL OpenGL::EGL)
else()
    message(WARNING "No OpenSubdiv with OpenGL and EGL: its GL evaluator is left out of the benchmarks.")
endif()

find_file(LIMN_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js NO_DEFAULT_PATH)
if(LIMN_CHART_JS)
    set_source_files_properties(bench/report_html.cpp PROPERTIES
        COMPILE_DEFINITIONS LIMN_CHART_JS="${LIMN_CHART_JS}")
else()
    message(WARNING "Chart.js is not here (Debian: libjs-chart.js): pages of `limn bench` have tables only.")
endif()

if(LIMN_BUILD_PROGRAM)
    target_sources(limn_program PRIVATE bench/bench_command.cpp)
    target_link_libraries(limn_program PRIVATE limn_bench)
endif()
