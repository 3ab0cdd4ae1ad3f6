# Fails when the README's C++ example is not, to the letter, what tests/readme_example.cpp compiles.
file(READ README.md readme)
file(READ tests/readme_example.cpp source)
string(REGEX REPLACE ".*// \\[readme\\]\n(.*)// \\[/readme\\].*" "\\1" example "${source}")
string(FIND "${readme}" "```cpp\n${example}```" at)
if(at EQUAL -1)
    message(FATAL_ERROR "README.md does not hold the example of tests/readme_example.cpp")
endif()
