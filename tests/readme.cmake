# Fails when the README's C++ example is not, to the letter, what src/example/renderer.cpp compiles.
file(READ README.md readme)
file(READ src/example/renderer.cpp source)
string(REGEX REPLACE ".*// \\[readme\\]\n(.*)// \\[/readme\\].*" "\\1" example "${source}")
string(FIND "${readme}" "```cpp\n${example}```" at)
if(at EQUAL -1)
    message(FATAL_ERROR "README.md does not hold the example of src/example/renderer.cpp")
endif()
