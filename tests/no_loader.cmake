# limn_vulkan calls Vulkan through the functions that it is given alone: no symbol of the loader is left open.
# Arguments: nm, library.
execute_process(COMMAND ${nm} -u ${library} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
if(NOT symbols MATCHES "dlopen|dlsym")
    message(FATAL_ERROR "${nm} shows no symbols of ${library}")
endif()
string(REGEX MATCHALL "[ \t]vk[A-Z][A-Za-z0-9]*" open_symbols "${symbols}")
if(open_symbols)
    message(FATAL_ERROR "${library} needs ${open_symbols}")
endif()
