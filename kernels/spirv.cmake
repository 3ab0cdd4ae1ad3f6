# From GLSL to SPIR-V in headers; included by CMakeLists.txt.

# Compiles `source` to <build>/<folder>/<name>.spv, and embeds it in the target as the uint32_t array k<Name> of
# "limn_<folder>/<name>.h". More arguments are options of the compiler.
function(limn_add_spirv target folder name source)
    find_program(LIMN_GLSLANG glslangValidator REQUIRED)
    set(spirv_dir ${CMAKE_CURRENT_BINARY_DIR}/${folder})
    set(header_dir ${CMAKE_CURRENT_BINARY_DIR}/generated/limn_${folder})
    file(MAKE_DIRECTORY ${spirv_dir} ${header_dir})
    string(REPLACE "_" ";" words ${name})
    set(array k)
    foreach(word IN LISTS words)
        string(SUBSTRING ${word} 0 1 first)
        string(SUBSTRING ${word} 1 -1 rest)
        string(TOUPPER ${first} first)
        string(APPEND array ${first}${rest})
    endforeach()
    set(glslang ${LIMN_GLSLANG} --quiet --target-env vulkan1.2 -I${CMAKE_CURRENT_SOURCE_DIR}/kernels ${ARGN})
    add_custom_command(
        OUTPUT ${spirv_dir}/${name}.spv ${header_dir}/${name}.h
        COMMAND ${glslang} --depfile ${spirv_dir}/${name}.d -o ${spirv_dir}/${name}.spv ${source}
        COMMAND ${glslang} --vn ${array} -o ${header_dir}/${name}.h ${source}
        DEPENDS ${source}
        DEPFILE ${spirv_dir}/${name}.d
        COMMENT "Compiling ${folder}/${name}"
        VERBATIM)
    target_sources(${target} PRIVATE ${source} ${header_dir}/${name}.h)
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
endfunction()

# kernels/<name>.comp; tess_<name>_texel is tess_<name> with LIMN_TEXEL, and so for tree_<name>, osd_<name>, skin and normals.
function(limn_add_kernels target)
    foreach(name IN LISTS ARGN)
        set(source ${CMAKE_CURRENT_SOURCE_DIR}/kernels/${name}.comp)
        set(options "")
        if(name MATCHES "^(skin|normals|tess_.*|tree_.*|osd_.*)_texel$")
            string(REGEX REPLACE "_texel\\.comp$" ".comp" source ${source})
            set(options -DLIMN_TEXEL)
        endif()
        if(name MATCHES "^tess_hardware_(vert|tesc|tese)(_triangles)?(_texel)?$")
            set(source ${CMAKE_CURRENT_SOURCE_DIR}/kernels/tess_hardware.${CMAKE_MATCH_1})
            set(options "")
            if(name MATCHES "_triangles")
                list(APPEND options -DLIMN_TRIANGLES)
            endif()
            if(name MATCHES "_texel$")
                list(APPEND options -DLIMN_TEXEL)
            endif()
        endif()
        limn_add_spirv(${target} kernels ${name} ${source} ${options})
    endforeach()
endfunction()

# shaders/<name>.<stage>, as <name>_<stage>; <name>_hardware is <name> with LIMN_HARDWARE.
function(limn_add_shaders target)
    foreach(file IN LISTS ARGN)
        string(REPLACE "." "_" name ${file})
        set(options "")
        if(file MATCHES "_hardware\\.")
            string(REPLACE "_hardware." "." file ${file})
            set(options -DLIMN_HARDWARE)
        endif()
        limn_add_spirv(${target} shaders ${name} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/${file} ${options})
    endforeach()
endfunction()
