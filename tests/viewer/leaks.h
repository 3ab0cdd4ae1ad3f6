// Cracks, seen in pictures.
#pragma once

#include "viewer/picture.h"

namespace limn::viewer::test {

/// Pixels of a picture in ColorMode::sides that show the inside of a closed surface, through a crack or a
/// missing triangle. Those at the silhouette do not count: there, back faces are as near as front faces.
size_t count_leaks(const Picture& picture);

/// Pixels that are not background, of a picture in ColorMode::sides.
size_t count_covered(const Picture& picture);

}  // namespace limn::viewer::test
