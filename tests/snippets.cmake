# Fails when the C++ of `page` is not, to the letter, what stands between // [`marker`] and // [/`marker`] of `source`,
# which is compiled.
file(READ ${page} text)
file(READ ${source} code)
string(REGEX REPLACE ".*// \\[${marker}\\]\n(.*)// \\[/${marker}\\].*" "\\1" code "${code}")
string(FIND "${text}" "```cpp\n${code}```" at)
if(at EQUAL -1)
    message(FATAL_ERROR "${page} does not hold the example of ${source}")
endif()
