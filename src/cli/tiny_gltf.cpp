// The one place that compiles tinygltf, a library of one header. CMakeLists.txt sets its options, which all
// who include it must share.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
